"""Pictures from Python: against the command line, in a long loop whose objects move, and what `import bilux` costs.

    python benchmarks/pictures.py --binary target/release/bilux [--pictures 2000] [--spp 1] [--pairs 7]

The binary has to be of the same build profile as the package. Times of the two take turns; medians count. Where other
work goes on, seconds of the processor say more than those of the clock.
"""

import argparse
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np

import bilux


def clocks(of=resource.RUSAGE_SELF):
    """Seconds of the clock and of the processor so far."""
    used = resource.getrusage(of)
    return np.array([time.perf_counter(), used.ru_utime + used.ru_stime])


def seconds(work, of=resource.RUSAGE_SELF):
    begun = clocks(of)
    work()
    return clocks(of) - begun


def against_the_command_line(binary, pairs):
    """Loading, rendering and saving a picture here, and in a process of the command line: the ratios of their times."""
    settings = {"size": (320, 240), "integrator": "path", "spp": 32, "denoise": False}
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        subprocess.run([binary, "generate", "interior", "-o", folder / "scene.glb", "--quiet"], check=True)
        here, there = folder / "here.png", folder / "there.png"
        command = [binary, "render", folder / "scene.glb", "-o", there, "--size", "320x240", "-i", "path", "--spp", "32", "--denoise=off", "--quiet"]

        def own():
            bilux.load(folder / "scene.glb").render(**settings).save(here)

        def other():
            subprocess.run(command, check=True)

        times = []
        for _ in range(pairs + 1):
            times.append((seconds(own), seconds(other, resource.RUSAGE_CHILDREN)))
        assert here.read_bytes() == there.read_bytes()
    times = np.array(times[1:])
    (clock, processor), (their_clock, their_processor) = np.median(times, axis=0)
    ratios = np.median(times[:, 0] / times[:, 1], axis=0)
    print(f"a picture: {clock:.2f} s and {processor:.2f} s of the processor; by the command line {their_clock:.2f} and {their_processor:.2f}")
    print(f"  medians of {pairs} pairs, here against there: {ratios[0]:.3f} by the clock, {ratios[1]:.3f} of the processor; the same bytes")


def memory():
    """Megabytes that the process holds now."""
    pages = int(pathlib.Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def ball(rings):
    """The vertices and triangles of a sphere of radius 1."""
    theta, phi = np.meshgrid(np.linspace(0, np.pi, rings + 1), np.linspace(0, 2 * np.pi, 2 * rings + 1), indexing="ij")
    vertices = np.stack([np.sin(theta) * np.sin(phi), np.cos(theta), np.sin(theta) * np.cos(phi)], axis=-1).reshape(-1, 3)
    row, column = (grid.ravel() for grid in np.meshgrid(np.arange(rings), np.arange(2 * rings), indexing="ij"))
    above, below = row * (2 * rings + 1) + column, (row + 1) * (2 * rings + 1) + column
    return vertices, np.concatenate([np.stack([above, below, above + 1], 1), np.stack([above + 1, below, below + 1], 1)])


def data_set(pictures, spp):
    """Pictures of 50,000 triangles in ten objects, all of which move before each; prints memory on the way."""
    vertices, triangles = ball(36)
    scene = bilux.Scene()
    objects = []
    for number in range(10):
        place = np.eye(4)
        place[0, 3] = 2.2 * number - 10
        material = bilux.materials.diffuse(reflectance=np.random.default_rng(number).uniform(0.2, 0.8, 3))
        objects.append((scene.add_mesh(vertices, triangles, normals=vertices, material=material, transform=place), place))
    scene.add_light(bilux.lights.environment(radiance=1.0))
    scene.add_camera(bilux.cameras.perspective(position=(0, 5, 20), look_at=(0, 0, 0), fov=50))
    random = np.random.default_rng(0)
    rendering = building = 0.0
    begun = time.perf_counter()
    for number in range(1, pictures + 1):
        for index, place in objects:
            moved = place.copy()
            moved[:3, 3] += random.uniform(-1, 1, 3)
            scene.set_transform(index, moved)
        before = time.perf_counter()
        picture = scene.render(size=256, spp=spp, seed=number, integrator="path", aov=["ids", "depth"])
        rendering += time.perf_counter() - before
        building += picture.info["build_seconds"]
        labels = picture["id"][..., 0], picture["depth"]
        assert np.isfinite(labels[1]).any() and picture.info["trees_built"] >= 0
        if number in (50, 200, 500, 1000, 1500, 2000) or number == pictures:
            print(f"  after {number} pictures: {memory():.0f} MB", flush=True)
    whole = time.perf_counter() - begun
    print(f"{pictures} pictures of {len(triangles) * 10} triangles, {spp} samples: {1e3 * whole / pictures:.1f} ms each,")
    print(f"  {100 * rendering / whole:.1f}% in render(); trees and the rest of building {100 * building / whole:.1f}%")


def imports(runs):
    """What `import bilux` takes beyond numpy's own, in processes of their own."""
    took = {"numpy": [], "bilux": []}
    for _ in range(runs):
        for name, times in took.items():
            code = f"import time; begun = time.perf_counter(); import {name}; print(time.perf_counter() - begun)"
            times.append(float(subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout))
    numpy, own = (1e3 * statistics.median(times) for times in took.values())
    print(f"import bilux: {own:.0f} ms, numpy alone {numpy:.0f} ms: {own - numpy:.0f} ms more, medians of {runs}")


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--binary", help="bilux, of the same profile; without it the command line is left out")
    arguments.add_argument("--pictures", type=int, default=2000)
    arguments.add_argument("--spp", type=int, default=1)
    arguments.add_argument("--pairs", type=int, default=7)
    given = arguments.parse_args()
    imports(11)
    if given.binary:
        against_the_command_line(given.binary, given.pairs)
    data_set(given.pictures, given.spp)


if __name__ == "__main__":
    main()
