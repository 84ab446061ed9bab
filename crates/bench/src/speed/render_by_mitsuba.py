"""Renders one scene by Mitsuba on one thread, for `bilux bench speed`.

The argument is a JSON file that holds a scene as mitsuba.load_dict takes it, with three additions: {"look_at": [origin,
target, up]} and {"rotate_y": degrees} are transforms, and {"texels": file, "shape": [rows, columns, channels]} is a bitmap
of 32-bit floats, little-endian.

Each line on standard input asks for a picture: {"samples": n, "seed": n, "output": file}. The pixels go into the file, as
32-bit floats in rows, and what they took is printed as a line of JSON: {"cpu_seconds": s, "seconds": s}. The first line
that is printed says {"ready": version} or {"error": why}.
"""
import json
import sys
import time


def built(value, mi, np):
    """The value with the additions replaced by what they stand for."""
    if isinstance(value, list):
        return [built(item, mi, np) for item in value]
    if not isinstance(value, dict):
        return value
    if "look_at" in value:
        origin, target, up = value["look_at"]
        return mi.ScalarTransform4f().look_at(origin=origin, target=target, up=up)
    if "rotate_y" in value:
        return mi.ScalarTransform4f().rotate([0, 1, 0], value["rotate_y"])
    if "texels" in value:
        texels = np.fromfile(value["texels"], dtype="<f4").reshape(value["shape"])
        return mi.Bitmap(np.ascontiguousarray(texels))
    return {key: built(item, mi, np) for key, item in value.items()}


def say(line):
    print(json.dumps(line), flush=True)


def main():
    try:
        import drjit as dr
        import mitsuba as mi
        import numpy as np

        mi.set_variant("llvm_ad_rgb")
        dr.set_thread_count(1)
        with open(sys.argv[1], encoding="utf-8") as file:
            scene = mi.load_dict(built(json.load(file), mi, np))
    except Exception as error:  # whatever is missing, the table has its other half
        say({"error": f"{type(error).__name__}: {error}"})
        return
    say({"ready": mi.__version__})
    for line in sys.stdin:
        task = json.loads(line)
        cpu, clock = time.process_time(), time.perf_counter()
        pixels = np.array(mi.render(scene, spp=task["samples"], seed=task["seed"]))
        took = {"cpu_seconds": time.process_time() - cpu, "seconds": time.perf_counter() - clock}
        pixels[:, :, :3].astype("<f4").tofile(task["output"])
        say(took)


main()
