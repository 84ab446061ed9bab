"""Renders public scenes of Radiance with `bilux` and with `rpict`, and compares their means.

    radiance.py BILUX FOLDER

FOLDER holds copies of the repositories that `SCENES` names, as OWNER/NAME; scenes that are not there are skipped. `oconv`, `rpict`
and `pvalue` come with the package `pyradiance`. Exits with 1 if a mean is off by more than 2% and three standard errors.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pyradiance

# A room with a ball of glass, one with lamps along its walls, and halls with mirrors, lamps and a window in the roof.
SCENES = [
    ("NREL/Radiance/resources/cornell_box", ["cornell.rad"], "-vp .49 0 0 -vd -1 0 0 -vu 0 0 1 -vh 80 -vv 80"),
    (
        "luminousphotonics/radiance_simuls",
        ["room.rad", "ies_sources/emitters_manual.rad"],
        "-vp 0 0 2.9 -vd 0 0 -1 -vu 0 1 0 -vh 90 -vv 90",
    ),
    (
        "markstock/Radiance-Benchmark4",
        ["materials.rad", "skybetter.rad", "unit.rad"],
        "-vp 5 0 1.2 -vd 1 .3 .25 -vu 0 0 1 -vh 60 -vv 60",
    ),
]
SIZE = 48
# No interpolation, no thresholds, and paths that end by chance: what Radiance calls Russian roulette.
EXACT = "-ps 1 -pj .9 -aa 0 -as 0 -ad 64 -ab 40 -lr -40 -lw 2e-3 -dj .9 -ds .1 -dt 0 -dc 1 -dr 4 -st 0 -ss 1"
LUMENS = 683 / 179


def pfm(file):
    with open(file, "rb") as opened:
        assert opened.readline().strip() == b"PF"
        width, height = map(int, opened.readline().split())
        order = "<f4" if float(opened.readline()) < 0 else ">f4"
        return np.frombuffer(opened.read(), order).reshape(height, width, 3)[::-1].astype(float)


def theirs(folder, files, view, out):
    programs = Path(pyradiance.__file__).parent
    path = {**os.environ, "RAYPATH": f".:{programs / 'lib'}", "PATH": f"{programs / 'bin'}:{os.environ['PATH']}"}
    run = lambda words, **more: subprocess.run(words, cwd=folder, env=path, check=True, **more)  # noqa: E731
    octree = out / "scene.oct"
    octree.write_bytes(run(["oconv", *files], stdout=subprocess.PIPE).stdout)
    words = f"rpict -vtv {view} {EXACT} -x {SIZE} -y {SIZE}".split()
    (out / "theirs.hdr").write_bytes(run([*words, octree], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout)
    values = run(["pvalue", "-h", "-H", "-o", "-d", out / "theirs.hdr"], stdout=subprocess.PIPE).stdout
    return np.array(values.split(), float).reshape(SIZE, SIZE, 3)


def ours(bilux, folder, files, view, out):
    # A scene beside those that it names, which lie outside of its own folder otherwise.
    scene = out / "scene.rif"
    names = " ".join(str(folder / file) for file in files)
    scene.write_text(f"scene= {names}\nview= a -vtv {view}\n")
    words = f"{bilux} render {scene} -i path --spp 256 --max-depth 60 --allow-outside -q --size {SIZE}x{SIZE} -o"
    subprocess.run([*words.split(), out / "ours.pfm"], check=True)
    return pfm(out / "ours.pfm") * LUMENS


def compare(bilux, folder, files, view):
    with tempfile.TemporaryDirectory() as out:
        a, b = ours(bilux, folder, files, view, Path(out)), theirs(folder, files, view, Path(out))
    ratio = a.mean((0, 1)) / b.mean((0, 1))
    # The noise of both, by the differences of neighbours.
    error = np.hypot(*(np.diff(x, axis=1).std() / np.sqrt(2) / SIZE / x.mean() for x in (a, b)))
    print(f"{folder.name}: {ratio.round(3)} ± {error:.3f}", flush=True)
    return bool(np.all(np.abs(ratio - 1) < max(0.02, 3 * error)))


def main():
    bilux, folder = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    found = [(folder / name, files, view) for name, files, view in SCENES if (folder / name).is_dir()]
    results = [compare(bilux, *scene) for scene in found]
    sys.exit(0 if found and all(results) else 1)


main()
