"""The scenes of a folder in Mitsuba 3 and in Bilux: which open, and whether they are as bright.

usage: scenes.py BILUX FOLDER [--only PART] [--side 64] [--spp 64] [--limit 60] [--sheet FILE.png]

Needs `pip install mitsuba numpy`, and Pillow for a sheet, which has Bilux's picture below Mitsuba's. Every scene is rendered with its longer side of so
many pixels, by each program in four parts with seeds of their own, and within a time limit in seconds. `direct` with its numbers of samples, and the integrators
that trace from lights, are replaced by `path` of the same depth in Mitsuba. A line has the ratio of Bilux's mean to Mitsuba's in each channel, the
standard error of that ratio, and the mean difference of blocks of 8 x 8 pixels over the mean, which shows what is in another place.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile

import numpy as np

PARTS, BLOCK = 4, 8
WITHIN = 0.02


def scenes(folder, only):
    """The scenes of a folder that no other of its scenes includes."""
    paths, included = [], set()
    for place, _, names in os.walk(folder):
        for name in names:
            if name.endswith(".xml"):
                path = os.path.join(place, name)
                with open(path, encoding="utf-8", errors="replace") as f:
                    text = f.read()
                for inner in re.findall(r'<include[^>]*filename="([^"]+)"', text):
                    included.add(os.path.basename(inner))
                if "<scene" in text:
                    paths.append(path)
    return sorted(p for p in paths if os.path.basename(p) not in included and only in p)


def by_mitsuba(path, out, side, spp):
    """Renders a scene in this process."""
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    scene = mi.load_file(path)
    integrator, text = scene.integrator(), str(scene.integrator())
    replaced = next((d for name, d in {"DirectIntegrator": 2, "ParticleTracer": -1}.items() if name in text), None)
    if replaced is not None:
        integrator = mi.load_dict({"type": "path", "max_depth": replaced})
    sensor = scene.sensors()[0]
    width, height = sensor.film().size()
    scale = side / max(width, height)
    size = [max(1, round(width * scale)), max(1, round(height * scale))]
    film = mi.traverse(sensor.film())
    film["size"], film["crop_size"], film["crop_offset"] = size, size, [0, 0]
    film.update()
    mi.traverse(sensor).update()
    parts = [np.array(mi.render(scene, integrator=integrator, spp=spp, seed=seed)) for seed in range(1, PARTS + 1)]
    np.save(out, np.array([p[:, :, :3] if p.shape[2] >= 3 else np.repeat(p[:, :, :1], 3, 2) for p in parts]))


def by_bilux(bilux, path, size, spp, limit):
    """The pictures, and what was said about the scene."""
    parts, said = [], ""
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "scene.pfm")
        for seed in range(1, PARTS + 1):
            call = [bilux, "render", path, "-i", "path", "--spp", str(spp), "--seed", str(seed), "--size", size, "-o", out]
            done = subprocess.run(call + ["--allow-outside", "--quiet"], capture_output=True, text=True, timeout=limit)
            said = done.stderr.strip().replace("\n", " / ")
            if done.returncode:
                return None, said
            parts.append(read_pfm(out))
    return np.array(parts), said


def read_pfm(path):
    with open(path, "rb") as f:
        f.readline()
        width, height = map(int, f.readline().split())
        scale = float(f.readline())
        data = np.frombuffer(f.read(), "<f4" if scale < 0 else ">f4")
    return data.reshape(height, width, 3)[::-1]


def compared(theirs, ours):
    """The ratio of the means and its standard error in each channel, and the mean difference of blocks."""
    a, b = theirs.astype(float).mean((1, 2)), ours.astype(float).mean((1, 2))
    mean_a, mean_b = np.maximum(a.mean(0), 1e-12), b.mean(0)
    ratio = mean_b / mean_a
    error = np.sqrt((a.var(0, ddof=1) / mean_a**2 * ratio**2 + b.var(0, ddof=1) / mean_a**2) / PARTS)
    height, width = (n // BLOCK * BLOCK for n in theirs.shape[1:3])
    both = [p.astype(float).mean(0)[:height, :width] for p in (theirs, ours)]
    blocks = [p.reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK, 3).mean((1, 3)) for p in both]
    return ratio, error, np.abs(blocks[1] - blocks[0]).mean() / max(both[0].mean(), 1e-12)


def tile(theirs, ours, side):
    """Both pictures, one above the other, as bytes of sRGB."""
    pictures = [p.mean(0) for p in (theirs, ours)]
    scale = 0.6 / max(float(np.percentile(pictures[0], 98)), 1e-6)
    sheet = np.zeros((2 * side, side, 3))
    for i, p in enumerate(pictures):
        c = np.clip(np.nan_to_num(p) * scale, 0, 1)
        sheet[i * side : i * side + p.shape[0], : p.shape[1]] = np.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1 / 2.4) - 0.055)
    return (sheet * 255).astype(np.uint8)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("bilux")
    parser.add_argument("folder")
    parser.add_argument("--only", default="")
    parser.add_argument("--side", type=int, default=64)
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--limit", type=float, default=60.0)
    parser.add_argument("--sheet")
    # The script calls itself with this: a plugin of Mitsuba may end the process.
    parser.add_argument("--one", help=argparse.SUPPRESS)
    options = parser.parse_args()
    spp = max(1, options.spp // PARTS)
    if options.one:
        return by_mitsuba(options.folder, options.one, options.side, spp)
    counts, tiles = {}, []
    for path in scenes(options.folder, options.only):
        name = os.path.relpath(path, options.folder)
        verdict, line, theirs, ours = "", "", None, None
        with tempfile.TemporaryDirectory() as folder:
            out = os.path.join(folder, "scene.npy")
            try:
                call = [sys.executable, __file__, options.bilux, path, "--one", out]
                call += ["--side", str(options.side), "--spp", str(options.spp)]
                done = subprocess.run(call, capture_output=True, text=True, timeout=4 * options.limit)
                theirs = np.load(out) if done.returncode == 0 else None
                why = done.stderr.strip().splitlines()[-1:]
            except subprocess.TimeoutExpired:
                why = ["takes too long"]
        size = "64x64" if theirs is None else f"{theirs.shape[2]}x{theirs.shape[1]}"
        try:
            ours, said = by_bilux(options.bilux, path, size, spp, options.limit)
        except subprocess.TimeoutExpired:
            said = "takes too long"
        if ours is None:
            verdict, line = "refused" if theirs is not None else "refused by both", said
        elif theirs is None:
            verdict, line = "Mitsuba cannot", "".join(why)
        else:
            ratio, error, blocks = compared(theirs, ours)
            within = np.all(np.abs(ratio - 1) < WITHIN + 3 * error)
            # A mean that is right is not enough where things are in other places.
            verdict = "within" if within and blocks < 0.1 else "off"
            line = "{:.3f} {:.3f} {:.3f}  ±{:.3f}  blocks {:.3f}  ".format(*ratio, error.max(), blocks) + said
            tiles.append(tile(theirs, ours, options.side))
        counts[verdict] = counts.get(verdict, 0) + 1
        print(f"{verdict:15} {len(tiles) if theirs is not None and ours is not None else '-':>3} {name}: {line[:400]}", flush=True)
    print(", ".join(f"{verdict}: {count}" for verdict, count in sorted(counts.items())))
    if options.sheet and tiles:
        from PIL import Image

        blank = [np.zeros_like(tiles[0])] * (-len(tiles) % 12)
        rows = [np.concatenate((tiles + blank)[i : i + 12], 1) for i in range(0, len(tiles), 12)]
        Image.fromarray(np.concatenate(rows)).save(options.sheet)
    return 0


if __name__ == "__main__":
    sys.exit(main())
