"""An independent witness for a picture that Bilux cannot reproduce: Veach's plates in Mitsuba 3, once as their pbrt file describes them and once as
they appear in the picture that comes with the file.

usage: veach.py BILUX FOLDER [--spp N]        FOLDER holds scene-v4.pbrt and TungstenRender.exr

Needs `pip install mitsuba numpy`. Prints FLIP and the differences in the channels' means between (1) Bilux and Mitsuba, both following the file, with
Trowbridge-Reitz (GGX) microfacets; (2) Mitsuba and the picture, with Beckmann microfacets that reflect 0.30 of what the file says; (3) Bilux and the
picture, which differ by exactly that. Exits with 1 if FLIP of the first is 0.05 or more, or one of its channels is off by 2%.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")

NUMBERS = re.compile(r"[-+.0-9e]+")
rgb = lambda value: {"type": "rgb", "value": value}


def directives(text):
    """Each directive of a pbrt file: its keyword, its unnamed texts and numbers, and its parameters by name."""
    tokens = re.findall(r'"[^"]*"|\[[^\]]*\]|[^\s"\[\]]+', re.sub(r"#.*", "", text))
    found = []
    for token in tokens:
        if token[0] not in '"[' and not NUMBERS.fullmatch(token):
            found.append([token])
        else:
            found[-1].append(token)
    for word, *rest in found:
        bare, said = [], {}
        while rest and (rest[0][0] != '"' or " " not in rest[0]):
            bare.append(value(rest.pop(0)))
        for declared, given in zip(rest[::2], rest[1::2]):
            said[declared.strip('"').split()[1]] = value(given)
        yield word, bare, said


def value(token):
    if token[0] == '"':
        return token.strip('"')
    if '"' in token or "true" in token or "false" in token:
        return token.strip("[] ").strip('" ')
    return [float(x) for x in token.strip("[]").split()]


def matrix(numbers):
    return np.array(numbers).reshape(4, 4).T


def scene(path, facets, part, spp):
    """The file as a Mitsuba scene."""
    found, film, materials, light, material, place = {}, {}, {}, None, None, np.eye(4)
    for word, bare, said in directives(open(path).read()):
        if word == "Transform":
            place = matrix(bare[0])
        elif word == "Film":
            film = {axis: int(said[f"{axis}resolution"][0]) for axis in "xy"}
        elif word == "Camera":
            # pbrt's x axis points to the left.
            to_world = np.linalg.inv(place) @ np.diag([-1.0, 1.0, 1.0, 1.0])
            camera = {"fov": said["fov"][0], "to_world": mi.ScalarTransform4f(to_world)}
        elif word == "MakeNamedMaterial" and said["type"] == "diffuse":
            materials[bare[0]] = {"type": "diffuse", "reflectance": rgb(said["reflectance"])}
        elif word == "MakeNamedMaterial":
            materials[bare[0]] = {
                "type": "roughconductor", "distribution": facets, "alpha": said["uroughness"][0],
                "eta": rgb(said["eta"]), "k": rgb(said["k"]), "specular_reflectance": rgb(part),
            }
        elif word == "NamedMaterial":
            material = materials[bare[0]]
        elif word == "AreaLightSource":
            light = {"type": "area", "radiance": rgb(said["L"])}
        elif word == "AttributeEnd":
            light = None
        elif word == "Shape" and bare[0] == "sphere":
            centre = [float(x) for x in place[:3, 3]]
            found[f"s{len(found)}"] = {
                "type": "sphere", "center": centre, "radius": said["radius"][0], "bsdf": material, "emitter": light,
            }
        elif word == "Shape":
            points, faces = np.array(said["P"]).reshape(-1, 3), np.array(said["indices"], np.uint32)
            properties = mi.Properties()
            properties["bsdf"] = mi.load_dict(material if "rough" in material["type"] else {"type": "twosided", "m": material})
            mesh = mi.Mesh(f"m{len(found)}", len(points), len(faces) // 3, props=properties)
            parameters = mi.traverse(mesh)
            parameters["vertex_positions"], parameters["faces"] = points.astype(np.float32).ravel(), faces
            parameters.update()
            found[f"m{len(found)}"] = mesh
    film = {"type": "hdrfilm", "width": film["x"], "height": film["y"], "rfilter": {"type": "tent"}, "pixel_format": "rgb"}
    sampler = {"type": "independent", "sample_count": spp}
    sensor = {"type": "perspective", "fov_axis": "smaller", "film": film, "sampler": sampler, **camera}
    return mi.load_dict({"type": "scene", "integrator": {"type": "direct"}, "sensor": sensor, **found})


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("bilux")
    parser.add_argument("folder")
    parser.add_argument("--spp", type=int, default=256)
    a = parser.parse_args()
    pbrt, picture = (os.path.join(a.folder, name) for name in ("scene-v4.pbrt", "TungstenRender.exr"))
    with tempfile.TemporaryDirectory() as folder:
        at = lambda name: os.path.join(folder, name + ".exr")
        for name, facets, part in (("said", "ggx", 1.0), ("pictured", "beckmann", 0.30)):
            rendered = mi.render(scene(pbrt, facets, part, a.spp))
            mi.Bitmap(rendered).write(at(name))
        options = ["-i", "path", "--max-depth", "1", "--set", "filter=tent", "--spp", str(a.spp), "-q"]
        subprocess.run([a.bilux, "render", pbrt, "-o", at("ours"), *options], check=True)
        mean = lambda path: np.array(mi.Bitmap(path).convert(mi.Bitmap.PixelFormat.RGB)).mean(axis=(0, 1))
        bad = False
        for one, other in (("ours", "said"), ("pictured", "picture"), ("ours", "picture")):
            paths = [picture if name == "picture" else at(name) for name in (one, other)]
            # A picture above the bound is not an error here.
            told = subprocess.run([a.bilux, "compare", *paths, "--json"], capture_output=True, text=True)
            flip = json.loads(told.stdout)["flip"]
            off = mean(paths[0]) / mean(paths[1]) - 1
            print(f"{one} and {other}: FLIP {flip:.4f}, means off by", *(f"{100 * c:+.2f}%" for c in off))
            bad |= other == "said" and np.abs(off).max() > 0.02
    sys.exit(int(bad))


main()
