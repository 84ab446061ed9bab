"""Bilux against SmallVCM, the small renderer of the authors of vertex connection and merging, in its four boxes: do the means of blocks agree, and
whose error is smaller after the same CPU time?

usage: smallvcm.py BILUX SMALLVCM [--boxes 0,1,2,3] [--seconds 10] [--seeds 3] [--integrators vcm,auto] [--reference 60] [--size 256] [--native]

SMALLVCM is a checkout of https://github.com/SmallVCM/SmallVCM. It is compiled here in a temporary folder by g++ with its makefile's options (`--native`
adds those for this processor), with the size, the seed and the format of its picture set to ours. Needs numpy. One thread, one program at a time. Each
side's error is relMSE against a long render of its own, the mean of two of so many seconds and of other seeds; in brackets it is without the worst 0.1% of
pixels. SmallVCM's spheres are exact and ours are meshes of 36,000 triangles, so errors against the other's reference would measure that. Prints a line for each
side of each box, with seconds per million samples and errors over SmallVCM's, and the mean difference of blocks of 8 x 8 pixels of the references. Exits
with 1 if the means of a box differ by 1% or more.
"""

import argparse
import os
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile

import numpy as np

from cornell import read_pfm

BLOCK = 8
WITHIN = 0.01
# A path has at most ten segments in SmallVCM, hence nine scattering events.
DEPTH = 9
LOW, HIGH, BACK, FRONT, LEFT, RIGHT = -1.28002, 1.28002, 1.30455, -1.25549, -1.27029, 1.28975
# The lamp hangs below the ceiling.
LAMP, LAMP_LOW = 0.25, 1.26002
WHITE, GREEN, RED, BLUE = [0.803922] * 3, [0.156863, 0.803922, 0.172549], [0.803922, 0.152941, 0.152941], [0.156863, 0.172549, 0.803922]
LIGHTS = {
    0: 'kind = "directional"\ndirection = [-1, 1.5, -1]\nirradiance = [10, 4, 0]',
    2: f'kind = "point"\nposition = [0, -0.5, 1]\nintensity = {70 / (4 * np.pi)}',
    3: f'kind = "environment"\nradiance = {[c / 255 for c in (135, 206, 250)]}',
}


def surfaces(box):
    """The rectangles of a box, as four points counter-clockwise seen from where they are lit, and their materials."""
    p = lambda x, y, z: [x, y, z]
    yield [p(LEFT, FRONT, LOW), p(RIGHT, FRONT, LOW), p(RIGHT, BACK, LOW), p(LEFT, BACK, LOW)], "floor"
    yield [p(LEFT, BACK, LOW), p(RIGHT, BACK, LOW), p(RIGHT, BACK, HIGH), p(LEFT, BACK, HIGH)], "blue"
    yield [p(LEFT, BACK, HIGH), p(RIGHT, BACK, HIGH), p(RIGHT, FRONT, HIGH), p(LEFT, FRONT, HIGH)], "white"
    yield [p(LEFT, FRONT, LOW), p(LEFT, BACK, LOW), p(LEFT, BACK, HIGH), p(LEFT, FRONT, HIGH)], "green"
    yield [p(RIGHT, BACK, LOW), p(RIGHT, FRONT, LOW), p(RIGHT, FRONT, HIGH), p(RIGHT, BACK, HIGH)], "red"
    # The box around the lamp is there without it too, but not in the box with a point light.
    if box != 2:
        for (x, y), (to_x, to_y) in zip(((-1, 1), (-1, -1), (1, -1), (1, 1)), ((-1, -1), (1, -1), (1, 1), (-1, 1))):
            a, b = (LAMP * x, LAMP * y), (LAMP * to_x, LAMP * to_y)
            yield [p(*a, LAMP_LOW), p(*b, LAMP_LOW), p(*b, HIGH), p(*a, HIGH)], "white"
        below = [p(-LAMP, LAMP, LAMP_LOW), p(LAMP, LAMP, LAMP_LOW), p(LAMP, -LAMP, LAMP_LOW), p(-LAMP, -LAMP, LAMP_LOW)]
        yield below, "lamp" if box == 1 else "white"


def write_scene(folder, box, size):
    """Writes a box as a scene of Bilux, and returns its path."""
    aim = [-0.0439815 + 0.00688625, -4.12529 + 0.998505, 0.222539 - 0.0542161]
    text = [f'[render]\nsize = "{size}x{size}"\nmax_depth = {DEPTH}']
    text.append(f"[camera]\nposition = [-0.0439815, -4.12529, 0.222539]\nlook_at = {aim}\nup = [3.73896e-4, 0.0542148, 0.998529]\nfov = 45")
    for name, colour in {"white": WHITE, "green": GREEN, "red": RED, "blue": BLUE}.items():
        text.append(f'[[material]]\nname = "{name}"\nkind = "diffuse"\nreflectance = {colour}')
    text.append('[[material]]\nname = "floor"\nkind = "phong"\nkd = 0.1\nks = 0.7\nexponent = 90\nreflectivity = 0')
    text.append('[[material]]\nname = "lamp"\nkind = "diffuse"\nreflectance = 0\nemission = 25.03329895614464\nemission_sides = "front"')
    text.append('[[material]]\nname = "mirror"\nkind = "mirror"\nreflectance = 1')
    text.append('[[material]]\nname = "glass"\nkind = "dielectric"\neta = 1.6')
    for k, (corners, material) in enumerate(surfaces(box)):
        with open(os.path.join(folder, f"{k}.obj"), "w", encoding="ascii") as f:
            f.writelines("v %.9g %.9g %.9g\n" % tuple(c) for c in corners)
            f.write("f 1 2 3\nf 1 3 4\n")
        text.append(f'[[model]]\nfile = "{k}.obj"\nmaterial = "{material}"')
    middle, width = (LEFT + RIGHT) / 2, RIGHT - LEFT
    y = (BACK + FRONT) / 2
    balls = [("mirror", middle, 0.8)] if box == 1 else [("mirror", LEFT + 2 / 7 * width, 0.5), ("glass", RIGHT - 2 / 7 * width, 0.5)]
    for material, x, radius in balls:
        text.append(f'[[model]]\nshape = "sphere"\nradius = {radius}\naround = 192\nalong = 96\nmaterial = "{material}"\ntranslate = {[x, y, LOW + radius]}')
    if box in LIGHTS:
        text.append(f"[[light]]\n{LIGHTS[box]}")
    path = os.path.join(folder, f"box{box}.toml")
    with open(path, "w", encoding="utf-8") as f:
        f.write("\n".join(text))
    return path


def compile_smallvcm(source, folder, size, native):
    """Compiles SmallVCM for one thread, a seed from the environment and a picture of floats of this size."""
    code = os.path.join(folder, "src")
    shutil.copytree(os.path.join(source, "src"), code)
    for file, before, after in (
        ("config.hxx", "Vec2i(512, 512)", f"Vec2i({size}, {size})"),
        ("config.hxx", "= 1234", '= atoi(getenv("SEED"))'),
        ("smallvcm.cxx", "fbuffer.SaveHDR", "fbuffer.SavePFM"),
    ):
        path = os.path.join(code, file)
        with open(path, encoding="utf-8") as f:
            text = f.read()
        if before not in text:
            sys.exit(f"{file} has no '{before}': another version of SmallVCM?")
        with open(path, "w", encoding="utf-8") as f:
            f.write(text.replace(before, after))
    out = os.path.join(folder, "smallvcm")
    options = ["-O3", "-std=c++11", "-DNO_OMP"] + (["-march=native"] if native else [])
    subprocess.run(["g++", "-o", out, os.path.join(code, "smallvcm.cxx"), *options, "-w"], check=True)
    return out


def timed(call, **options):
    """Runs a program, and returns its CPU seconds."""
    used = lambda: sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])
    before = used()
    subprocess.run(call, check=True, stdout=subprocess.DEVNULL, **options)
    return used() - before


class SmallVcm:
    name = "SmallVCM"

    def __init__(self, program, folder, box):
        self.program, self.out, self.box = program, os.path.join(folder, "theirs.hdr"), str(box)

    def render(self, samples, seed):
        call = [self.program, "-s", self.box, "-a", "vcm", "-i", str(samples), "-o", self.out]
        seconds = timed(call, env={**os.environ, "SEED": str(1000 * seed)})
        # Its rows run from top to bottom, unlike those of other PFM files.
        return seconds, read_pfm(self.out)[::-1].astype(float)


class Bilux:
    def __init__(self, program, folder, scene, integrator):
        self.program, self.out, self.scene, self.name = program, os.path.join(folder, "ours.pfm"), scene, integrator

    def render(self, samples, seed):
        call = [self.program, "render", self.scene, "-i", self.name, "--spp", str(samples), "--seed", str(seed), "--threads", "1"]
        return timed(call + ["-o", self.out, "--quiet"]), read_pfm(self.out).astype(float)


def samples_in(side, seconds):
    """How many samples per pixel take about so long."""
    samples, took = 2, 0.0
    while took < seconds / 3:
        took = side.render(samples, 99)[0]
        samples = max(1, round(samples * min(seconds / took, 10)))
    return samples


def errors(picture, reference):
    """relMSE, and without the worst 0.1% of pixels."""
    each = np.sort(((picture - reference) ** 2 / (reference**2 + 0.01)).mean(2).ravel())
    return each.mean(), each[: int(len(each) * 0.999)].mean()


def blocks(picture):
    n = len(picture) // BLOCK
    return picture.reshape(n, BLOCK, n, BLOCK, 3).mean((1, 3))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("bilux")
    parser.add_argument("smallvcm")
    parser.add_argument("--boxes", default="0,1,2,3")
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--integrators", default="vcm,auto")
    parser.add_argument("--reference", type=float, default=60)
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--native", action="store_true")
    options = parser.parse_args()
    good = True
    with tempfile.TemporaryDirectory() as folder:
        program = compile_smallvcm(options.smallvcm, folder, options.size, options.native)
        for box in map(int, options.boxes.split(",")):
            scene = write_scene(folder, box, options.size)
            theirs = SmallVcm(program, folder, box)
            sides = [theirs] + [Bilux(options.bilux, folder, scene, i) for i in options.integrators.split(",")]
            budgets = [samples_in(side, options.seconds) for side in sides]
            # Ours share one reference, of the first integrator.
            long = [[side.render(round(n * options.reference / options.seconds), seed)[1] for seed in (11, 12)]
                    for side, n in zip(sides[:2], budgets)]
            references = [np.mean(pair, 0) for pair in long]
            a, b = (blocks(r) for r in references)
            noise = [blocks(x) - blocks(y) for x, y in long]
            scale = np.maximum((a + b) / 2, 0.02 * a.mean())
            off, expected = (np.sqrt(np.mean((d / scale) ** 2)) for d in (a - b, np.sqrt((noise[0] ** 2 + noise[1] ** 2) / 4)))
            ratio = b.mean() / a.mean()
            print(f"box {box}: our mean over theirs {ratio:.4f}, blocks differ by {100 * off:.2f}%, by noise alone {100 * expected:.2f}%", flush=True)
            good &= bool(abs(ratio - 1) < WITHIN)
            found = [[] for _ in sides]
            for seed in range(1, options.seeds + 1):
                for k, side in enumerate(sides):
                    seconds, picture = side.render(budgets[k], seed)
                    share = seconds / options.seconds
                    found[k].append([seconds, *(share * e for e in errors(picture, references[min(k, 1)]))])
            base = [statistics.median(x) for x in zip(*found[0])]
            for k, side in enumerate(sides):
                seconds, whole, rest = (statistics.median(x) for x in zip(*found[k]))
                millions = budgets[k] * options.size**2 / 1e6
                print(f"  {side.name:9} {budgets[k]:5} samples, {seconds:6.2f} s, {seconds / millions:.3f} s per million; relMSE {whole:.5f} ({rest:.5f}), "
                      f"over theirs {whole / base[1]:.3f} ({rest / base[2]:.3f})", flush=True)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
