"""How well a Ray cluster is used: two nodes of one core each, on this machine, against one core without Ray.

    python benchmarks/cluster.py [--spp 256] [--frames 200]

Other work on the machine slows two cores more than one: only ratios of one run mean something.
"""

import argparse
import os
import time

# Ray makes its workers nice; here they have to be as important as the one core that they are compared with.
os.environ["RAY_worker_niceness"] = "0"

import numpy as np
import ray
from ray.cluster_utils import Cluster

import bilux


def seconds(work):
    begun = time.monotonic()
    result = work()
    return result, time.monotonic() - begun


def picture(scene, spp):
    """One picture, by one core and by two nodes."""
    settings = {"size": 512, "spp": spp, "integrator": "path"}
    begun = time.process_time()
    here, alone = seconds(lambda: scene.render(threads=1, **settings))
    cpu_seconds = time.process_time() - begun
    there, together = seconds(lambda: bilux.cluster.render(scene, **settings))
    again, second = seconds(lambda: scene.render(threads=1, **settings))
    assert np.array_equal(here.pixels, there.pixels) and np.array_equal(again.pixels, there.pixels)
    print(f"one core {alone:.1f} s and {second:.1f} s, two nodes {together:.1f} s: {(alone + second) / 2 / together:.2f} times")
    print(f"of a CPU: one core {cpu_seconds:.1f} s, the parts {there.info['cpu_seconds']:.1f} s")
    print({name: there.info[name] for name in ("workers", "parts", "given_again", "scene_bytes")})


def frames(count):
    """Tiny pictures, whose time is overhead."""
    scene = bilux.generate("cornell")
    settings = {"size": 32, "spp": 1, "integrator": "path"}
    times = [number / count for number in range(count)]
    _, alone = seconds(lambda: [scene.render(threads=1, time=time, **settings) for time in times])
    pictures = bilux.cluster.animation(scene, times, **settings)
    next(pictures)
    _, together = seconds(lambda: sum(1 for _ in pictures))
    each = 1e3 / count
    print(f"{count} frames: {alone * each:.1f} ms each on one core, {together * each:.1f} ms on two nodes")


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--spp", type=int, default=256)
    arguments.add_argument("--frames", type=int, default=200)
    given = arguments.parse_args()
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 0})
    for _ in range(2):
        cluster.add_node(num_cpus=1)
    ray.init(address=cluster.address, log_to_driver=False)
    frames(given.frames)
    picture(bilux.generate("interior"), given.spp)
    ray.shutdown()
    cluster.shutdown()


if __name__ == "__main__":
    main()
