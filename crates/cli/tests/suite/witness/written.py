"""An independent witness of what Bilux writes: scenes converted to Mitsuba's XML have the same mean in Mitsuba 3.

usage: written.py BILUX [--spp N] [--brighten FACTOR]

Needs `pip install mitsuba numpy`. Prints a line for each scene with the ratios of the means of red, green and blue, and exits with 1 if one of them is off
by more than 2%. With --brighten, the radiances in the files are multiplied first, as if the writer had a bug.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile

import numpy as np

SIZE, OFF = 64, 0.02
SURFACES = """
[camera]
position = [0, 2, 6]
look_at = [0, 0.5, 0]
fov = 35
[[light]]
kind = "rect"
position = [0, 4, 2]
edge_u = [2, 0, 0]
edge_v = [0, 0, 2]
radiance = [6, 5, 4]
[[light]]
kind = "environment"
zenith = [0.2, 0.3, 0.6]
horizon = [0.5, 0.5, 0.5]
ground = [0.1, 0.1, 0.1]
[[material]]
name = "matte"
kind = "diffuse"
reflectance = [0.6, 0.5, 0.4]
[[material]]
name = "plastic"
kind = "principled"
base_color = [0.2, 0.4, 0.7]
specular_roughness = 0.4
[[material]]
name = "copper"
kind = "conductor"
metal = "copper"
roughness = 0.3
[[material]]
name = "glass"
kind = "dielectric"
eta = 1.5
absorption = [0.5, 0.2, 0.1]
[[model]]
shape = "quad"
u = [8, 0, 0]
v = [0, 0, -8]
material = "matte"
[[model]]
shape = "box"
translate = [1.5, 0.5, -0.5]
material = "plastic"
[[model]]
shape = "sphere"
radius = 0.75
translate = [0, 0.75, -1]
material = "copper"
[[model]]
shape = "sphere"
radius = 0.6
translate = [-1.3, 0.6, 0.5]
material = "glass"
"""


def run(*words):
    done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(words)}: {done.stderr}")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("bilux")
    parser.add_argument("--spp", type=int, default=128)
    parser.add_argument("--brighten", type=float, default=1.0)
    options = parser.parse_args()
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    bad = False
    with tempfile.TemporaryDirectory() as folder:
        at = lambda name: os.path.join(folder, name)
        with open(at("surfaces.toml"), "w") as file:
            file.write(SURFACES)
        run(options.bilux, "generate", "cornell", "-o", at("box.toml"))
        for name in ["surfaces", "box"]:
            run(options.bilux, "convert", at(f"{name}.toml"), "-o", at(f"{name}.xml"))
            with open(at(f"{name}.xml")) as file:
                text = file.read()
            for side in ["width", "height"]:
                text = re.sub(rf'(name="{side}" value=")\d+', rf"\g<1>{SIZE}", text)
            scaled = lambda m: m[1] + " ".join(str(float(x) * options.brighten) for x in m[2].split()) + '"'
            text = re.sub(r'(name="radiance" value=")([^"]*)"', scaled, text)
            with open(at(f"{name}.xml"), "w") as file:
                file.write(text)
            theirs = np.array(mi.render(mi.load_file(at(f"{name}.xml")), spp=options.spp))[:, :, :3].mean((0, 1))
            picture = at(f"{name}.exr")
            run(options.bilux, "render", at(f"{name}.toml"), "-o", picture, "--size", f"{SIZE}x{SIZE}",
                "--spp", str(options.spp), "-i", "path", "--env", "none", "--quiet")  # fmt: skip
            rgb = mi.Bitmap(picture).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False)
            ratios = np.array(rgb).mean((0, 1)) / theirs
            print(f"{name:10} {ratios.round(4)}")
            bad |= bool(np.abs(ratios - 1.0).max() > OFF)
    sys.exit(1 if bad else 0)


main()
