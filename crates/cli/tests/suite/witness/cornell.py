"""An independent witness: the same Cornell boxes in Mitsuba 3 and in Bilux agree in the mean of every block.

usage: cornell.py BILUX [--seeds N] [--spp N] [--integrators path,bdpt,vcm,auto] [--boxes gold,...]

Needs `pip install mitsuba numpy`. The boxes contain a ball that is diffuse, glass, frosted (rough) glass, a mirror, rough metal or `principled` gold.
The two renderers use different masking functions for rough microfacets, and only Bilux compensates for multiple scattering between them; with little
roughness no block reveals the difference. The meshes are written once and read by both renderers; all triangles are flat. Blocks of 8 x 8 pixels of
64 x 64 are compared by Welch's t-test over seeds, corrected for their number [Sidak 1967]. Prints a line for each box and integrator; exits with 1 if
any result is less likely than one in ten thousand. Each line ends with the ratio of Bilux's variance to Mitsuba's, over the ball's pixels and over all
pixels: for the variance of single samples use `--spp 1 --seeds 100 --integrators path`.
"""

import argparse
import math
import os
import subprocess
import sys
import tempfile

import numpy as np

SIZE, BLOCK = 64, 8
WALL, RED, GREEN, LAMP = 0.725, [0.63, 0.065, 0.05], [0.14, 0.45, 0.091], 12.0
EYE, AT, FOV = [0.0, 1.0, 3.9], [0.0, 1.0, 0.0], 38.0
UNLIKELY = 1e-4
# The rows and columns that the ball covers.
BALL = np.s_[34:53, 15:34]

ETA, K, GOLD, ROUGHNESS = [0.2, 0.9, 1.1], [3.9, 2.4, 2.2], [0.9, 0.7, 0.3], 0.3
rgb = lambda value: {"type": "rgb", "value": value}
# Mitsuba's parameters, and Bilux's. Mitsuba's alpha is the square of Bilux's roughness.
SURFACES = {
    "glass": ({"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0}, 'kind = "dielectric"\neta = 1.5'),
    "mirror": (
        {"type": "conductor", "material": "none", "specular_reflectance": rgb(0.9)},
        'kind = "mirror"\nreflectance = 0.9',
    ),
    "frosted": (
        {"type": "roughdielectric", "distribution": "ggx", "alpha": ROUGHNESS**2, "int_ior": 1.5, "ext_ior": 1.0},
        f'kind = "dielectric"\neta = 1.5\nroughness = {ROUGHNESS}',
    ),
    "metal": (
        {"type": "roughconductor", "distribution": "ggx", "alpha": ROUGHNESS**2, "eta": rgb(ETA), "k": rgb(K)},
        f'kind = "conductor"\neta = {ETA}\nk = {K}\nroughness = {ROUGHNESS}',
    ),
    "gold": (
        {"type": "principled", "base_color": rgb(GOLD), "metallic": 1.0, "roughness": ROUGHNESS},
        f'kind = "principled"\nbase_color = {GOLD}\nbase_metalness = 1.0\nspecular_roughness = {ROUGHNESS}',
    ),
}


def quad(corner, u, v):
    corner, u, v = (np.array(x, float) for x in (corner, u, v))
    return np.array([corner, corner + u, corner + u + v, corner + v]), [[0, 1, 2], [0, 2, 3]]


def ball(centre, radius, rings=16):
    points, faces, around = [], [], 2 * rings
    for i in range(rings + 1):
        for j in range(around):
            theta, phi = math.pi * i / rings, 2 * math.pi * j / around
            points.append([math.sin(theta) * math.cos(phi), math.cos(theta), math.sin(theta) * math.sin(phi)])
    for i in range(rings):
        for j in range(around):
            a, b = i * around + j, i * around + (j + 1) % around
            c, d = a + around, b + around
            if i > 0:
                faces.append([a, b, c])
            if i + 1 < rings:
                faces.append([b, d, c])
    return np.array(points) * radius + np.array(centre, float), faces


def boxes():
    walls = {
        "floor": (*quad([-1, 0, -1], [0, 0, 2], [2, 0, 0]), WALL),
        "ceiling": (*quad([-1, 2, -1], [2, 0, 0], [0, 0, 2]), WALL),
        "back": (*quad([-1, 0, -1], [2, 0, 0], [0, 2, 0]), WALL),
        "left": (*quad([-1, 0, -1], [0, 2, 0], [0, 0, 2]), RED),
        "right": (*quad([1, 0, -1], [0, 0, 2], [0, 2, 0]), GREEN),
        # The light emits on both sides in one renderer and on one side in the other, so its back is covered.
        "housing": (*quad([-0.4, 1.97, -0.4], [0.8, 0, 0], [0, 0, 0.8]), 0.0),
    }
    lamp = quad([-0.3, 1.96, -0.3], [0.6, 0, 0], [0, 0, 0.6])
    matte = {**walls, "ball": (*ball([-0.35, 0.5, -0.2], 0.45), 0.6)}
    of = lambda surface: {**walls, "ball": (*ball([-0.35, 0.5, -0.2], 0.45), surface)}
    return lamp, {"matte": matte, **{surface: of(surface) for surface in SURFACES}}


def write_ply(path, points, faces):
    with open(path, "w", encoding="ascii") as f:
        # Otherwise Bilux would smooth the normals.
        f.write(f"ply\nformat ascii 1.0\ncomment shading flat\nelement vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\n")
        f.write(f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
        f.writelines("%.9g %.9g %.9g\n" % tuple(p) for p in points)
        f.writelines("3 %d %d %d\n" % tuple(face) for face in faces)


def by_mitsuba(folder, parts, seeds, spp):
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    scene = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 17},
        "sensor": {
            "type": "perspective",
            "fov": FOV,
            "to_world": mi.ScalarTransform4f().look_at(origin=EYE, target=AT, up=[0, 1, 0]),
            "film": {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}, "pixel_format": "rgb"},
            "sampler": {"type": "independent", "sample_count": spp},
        },
    }
    for name, (_, _, surface) in parts.items():
        shape = {"type": "ply", "filename": os.path.join(folder, f"{name}.ply"), "face_normals": True}
        if isinstance(surface, str):
            shape["bsdf"] = SURFACES[surface][0]
        else:
            shape["bsdf"] = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": rgb(surface)}}
        if name == "lamp":
            shape["emitter"] = {"type": "area", "radiance": rgb(LAMP)}
            shape["bsdf"] = {"type": "diffuse", "reflectance": rgb(0.0)}
        scene[name] = shape
    loaded = mi.load_dict(scene)
    return [np.array(mi.render(loaded, spp=spp, seed=seed)) for seed in range(1, seeds + 1)]


def by_bilux(bilux, folder, parts, integrator, seeds, spp):
    lines = [f'[render]\nsize = "{SIZE}x{SIZE}"\n[camera]\nposition = {EYE}\nlook_at = {AT}\nfov = {FOV}']
    for name, (_, _, surface) in parts.items():
        kind = SURFACES[surface][1] if isinstance(surface, str) else f'kind = "diffuse"\nreflectance = {surface}'
        light = f"\nemission = {LAMP}" if name == "lamp" else ""
        lines.append(f'[[material]]\nname = "{name}"\n{kind}{light}')
        lines.append(f'[[model]]\nfile = "{name}.ply"\nmaterial = "{name}"')
    scene = os.path.join(folder, "box.toml")
    with open(scene, "w", encoding="utf-8") as f:
        f.write("\n".join(lines))
    pictures = []
    for seed in range(1, seeds + 1):
        out = os.path.join(folder, "box.pfm")
        call = [bilux, "render", scene, "-i", integrator, "--spp", str(spp), "--seed", str(seed), "--max-depth", "16"]
        subprocess.run(call + ["-o", out, "--quiet"], check=True)
        pictures.append(read_pfm(out))
    return pictures


def read_pfm(path):
    with open(path, "rb") as f:
        f.readline()
        width, height = map(int, f.readline().split())
        scale = float(f.readline())
        data = np.frombuffer(f.read(), "<f4" if scale < 0 else ">f4")
    return data.reshape(height, width, 3)[::-1]


def blocks(pictures):
    n = SIZE // BLOCK
    return np.array([p.astype(float).reshape(n, BLOCK, n, BLOCK, 3).mean((1, 3)).ravel() for p in pictures])


def variance(pictures, where=np.s_[:, :]):
    """The variance over seeds, averaged over pixels and channels."""
    return float(np.array([p[where] for p in pictures], float).var(0, ddof=1).mean())


def tail(t, freedom):
    """P(|T| > t), by Simpson's rule over the density of Student's distribution."""
    log_c = math.lgamma((freedom + 1) / 2) - math.lgamma(freedom / 2) - 0.5 * math.log(freedom * math.pi)
    density = lambda x: math.exp(log_c - (freedom + 1) / 2 * math.log1p(x * x / freedom))
    n, end = 400, math.atan(t)
    # x = tan(a) maps the whole line to a finite interval.
    y = [density(math.tan(end + (math.pi / 2 - 1e-9 - end) * i / n)) / math.cos(end + (math.pi / 2 - 1e-9 - end) * i / n) ** 2
         for i in range(n + 1)]
    h = (math.pi / 2 - 1e-9 - end) / n
    return min(1.0, 2 * h / 3 * (y[0] + y[-1] + 4 * sum(y[1:-1:2]) + 2 * sum(y[2:-1:2])))


def agreement(a, b):
    """The minimum p-value of Welch's test over all blocks and channels, corrected for their number."""
    va, vb = a.var(0, ddof=1) / len(a), b.var(0, ddof=1) / len(b)
    least = 1.0
    for d, x, y in zip(np.abs(a.mean(0) - b.mean(0)), va, vb):
        if x + y == 0.0:
            least = min(least, float(d == 0.0))
            continue
        freedom = (x + y) ** 2 / (x * x / (len(a) - 1) + y * y / (len(b) - 1))
        least = min(least, tail(d / math.sqrt(x + y), freedom))
    return 1.0 - (1.0 - least) ** a.shape[1]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("bilux")
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--integrators", default="path,bdpt,vcm,auto")
    parser.add_argument("--boxes", default=",".join(["matte", *SURFACES]))
    # A planted bug: an error of this size must be detected.
    parser.add_argument("--brighten", type=float, default=1.0)
    options = parser.parse_args()
    lamp, all_boxes = boxes()
    worst = 1.0
    for box in options.boxes.split(","):
        parts = all_boxes[box]
        parts = {**parts, "lamp": (*lamp, 0.0)}
        with tempfile.TemporaryDirectory() as folder:
            for name, (points, faces, _) in parts.items():
                write_ply(os.path.join(folder, f"{name}.ply"), points, faces)
            theirs = by_mitsuba(folder, parts, options.seeds, options.spp)
            witness = blocks(theirs)
            for integrator in options.integrators.split(","):
                pictures = by_bilux(options.bilux, folder, parts, integrator, options.seeds, options.spp)
                ours = blocks(pictures) * options.brighten
                noise = [variance(pictures, part) / variance(theirs, part) for part in (BALL, np.s_[:, :])]
                p = agreement(witness, ours)
                worst = min(worst, p)
                print(f"{box:7} {integrator:5} mean {ours.mean():.5f}, Mitsuba's {witness.mean():.5f}, p = {p:.4f}, variance {noise[0]:.2f} and {noise[1]:.2f}", flush=True)
    return 0 if worst > UNLIKELY else 1


if __name__ == "__main__":
    sys.exit(main())
