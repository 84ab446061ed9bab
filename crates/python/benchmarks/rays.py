"""Ray queries against embreex: through trimesh, with the adapter in place of trimesh's own, and called directly.

    pip install trimesh embreex
    python benchmarks/rays.py [--triangles 1000,50000,500000] [--rays 10000,1000000] [--rounds 5]

The two take turns, and the best time of each counts. The ratios say how many times as long embreex takes: by the clock, and of
the processor. embreex works on one core, so the second is what one core would give. The last column says how many of the results
both have.
"""

import argparse
import os
import time
import warnings

import numpy as np
import trimesh
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh
from trimesh.ray.ray_pyembree import RayMeshIntersector

import bilux


def rough_torus(triangles):
    """A closed mesh of about so many triangles, in which a ray can cross the surface many times."""
    rows = max(4, round((triangles / 4) ** 0.5))
    around, across = np.meshgrid(np.arange(2 * rows) / (2 * rows), np.arange(rows) / rows, indexing="ij")
    around, across = 2 * np.pi * around.ravel(), 2 * np.pi * across.ravel()
    thick = 0.45 + 0.05 * np.sin(9 * around) * np.sin(7 * across)
    ring = 1 + thick * np.cos(across)
    vertices = np.stack([ring * np.cos(around), ring * np.sin(around), thick * np.sin(across)], axis=1)
    i, j = (index.ravel() for index in np.meshgrid(np.arange(2 * rows), np.arange(rows), indexing="ij"))
    corner = lambda i, j: i % (2 * rows) * rows + j % rows
    a, b, c, d = corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    return trimesh.Trimesh(vertices, faces, process=False)


def rays_of(kind, count, random):
    """Rays at the torus: those of a camera, or between random points."""
    if kind == "coherent":
        side = round(count**0.5)
        x, y = np.meshgrid(np.linspace(-0.7, 0.7, side), np.linspace(0.7, -0.7, side))
        directions = np.stack([x.ravel(), y.ravel(), np.full(side * side, -1.0)], axis=1)
        return np.tile([0.0, 0.2, 2.6], (side * side, 1)), directions
    origins = random.normal(size=(count, 3))
    origins *= 2 / np.linalg.norm(origins, axis=1)[:, None]
    return origins, random.uniform(-1, 1, (count, 3)) * [1.4, 1.4, 0.5] - origins


def queries_of(mesh, origins, directions, points):
    """The queries through trimesh, by name: what to call, and what of its results both have to give."""
    rays = origins, directions
    return {
        "intersects_first": lambda ray: ray.intersects_first(*rays),
        "intersects_any": lambda ray: ray.intersects_any(*rays),
        "intersects_id, first": lambda ray: ray.intersects_id(*rays, multiple_hits=False),
        "intersects_id, all": lambda ray: ray.intersects_id(*rays),
        "intersects_location, first": lambda ray: ray.intersects_location(*rays, multiple_hits=False),
        "intersects_location, all": lambda ray: ray.intersects_location(*rays),
        "contains_points": lambda ray: ray.contains_points(points),
    }


def in_turn(ours, theirs, rounds):
    """The best seconds of both, which take turns, by the clock and of the processor; and their last results."""
    best, results = np.full((2, 2), np.inf), [None, None]
    for _ in range(rounds + 1):
        for which, work in enumerate((ours, theirs)):
            begun = np.array([time.perf_counter(), time.process_time()])
            results[which] = work()
            best[which] = np.minimum(best[which], np.array([time.perf_counter(), time.process_time()]) - begun)
    return best, results


def agreement(ours, theirs):
    """The part of the results that both have, whatever their order."""
    if isinstance(ours, tuple):
        ours, theirs = (
            {*zip(*(column.tolist() for column in result if column.ndim == 1))} for result in (ours, theirs)
        )
        return len(ours & theirs) / max(len(ours | theirs), 1)
    return float(np.mean(ours == theirs))


def row(name, count, best, results):
    (ours, own_processor), (theirs, their_processor) = 1e9 * best / count
    ratios = f"{theirs / ours:6.2f} {their_processor / own_processor:6.2f}"
    print(f"  {name:28} {ours:8.0f} {theirs:8.0f} {ratios} {100 * agreement(*results):9.3f}%", flush=True)


def directly(mesh, origins, directions, rounds):
    """Both without trimesh: the same arrays of 32-bit floats."""
    accel = bilux.Accel(mesh.vertices, mesh.faces)
    scene = rtcore_scene.EmbreeScene()
    TriangleMesh(scene, mesh.vertices.astype(np.float32), mesh.faces.astype(np.int32))
    rays = origins.astype(np.float32), directions.astype(np.float32)
    for name, ours in {
        "directly: which triangle": lambda: accel.closest(*rays).primitive,
        "directly: any": lambda: np.where(accel.any(*rays), 0, -1),
    }.items():
        of_both = in_turn(ours, lambda: scene.run(*rays), rounds)
        if name.endswith("any"):
            of_both = of_both[0], [result >= 0 for result in of_both[1]]
        row(name, len(origins), *of_both)


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    numbers = lambda text: [int(number) for number in text.split(",")]
    arguments.add_argument("--triangles", type=numbers, default=[1_000, 50_000, 500_000])
    arguments.add_argument("--rays", type=numbers, default=[10_000, 1_000_000])
    arguments.add_argument("--rounds", type=int, default=5)
    given = arguments.parse_args()
    warnings.simplefilter("ignore")
    random = np.random.default_rng(1)
    print(f"threads of bilux: {os.environ.get('RAYON_NUM_THREADS', os.cpu_count())}, of embreex: 1")
    for triangles in given.triangles:
        mesh = rough_torus(triangles)
        ours, theirs = bilux.trimesh.RayMeshIntersector(mesh), RayMeshIntersector(mesh)
        for count in given.rays:
            points = random.uniform(-1, 1, (count, 3)) * [1.4, 1.4, 0.5]
            for kind in ["coherent", "random"]:
                origins, directions = rays_of(kind, count, random)
                print(f"{len(mesh.faces)} triangles, {len(origins)} {kind} rays: ns a ray, ours and embreex's; ratios; same")
                for name, query in queries_of(mesh, origins, directions, points).items():
                    if name != "contains_points" or kind == "random":
                        row(name, len(origins), *in_turn(lambda: query(ours), lambda: query(theirs), given.rounds))
                directly(mesh, origins, directions, given.rounds)


if __name__ == "__main__":
    main()
