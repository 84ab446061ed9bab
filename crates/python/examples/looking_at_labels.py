# %% [markdown]
# # Labelled pictures
# `labelled_pictures.py`, beside this file, writes a data set in parallel: pictures under random light, with masks, depth and bounding
# boxes in COCO's form. This looks at one.

# %%
import json
import pathlib
import subprocess
import sys

import numpy as np

import bilux

COUNT, SIZE, SPP = 4, 128, 16

# %% [markdown]
# The script starts processes, so it runs as a program of its own.

# %%
beside = pathlib.Path(globals().get("__file__", "labelled_pictures.py")).resolve().parent
script = beside / "labelled_pictures.py"
words = ["data", "--count", COUNT, "--size", SIZE, "--spp", SPP, "--processes", 2]
subprocess.run([sys.executable, script, *map(str, words)], check=True)
instances = json.loads(pathlib.Path("data/instances.json").read_text())
print(len(instances["images"]), "pictures,", len(instances["annotations"]), "objects")

# %% [markdown]
# Each mask in a colour of its own over its picture, with its box, and the depth below.


# %%
def mask_of(label):
    """The mask from its runs of 0 and 1 by columns."""
    counts = label["segmentation"]["counts"]
    return np.repeat(np.arange(len(counts)) % 2, counts).reshape(label["segmentation"]["size"], order="F").astype(bool)


columns = []
colours = np.random.default_rng(3).uniform(0.1, 1, (len(instances["annotations"]), 3))
for image in instances["images"]:
    pixels = bilux.read_picture(f"data/{image['file_name']}").pixels.copy()
    for label in instances["annotations"]:
        if label["image_id"] == image["id"]:
            mask, colour = mask_of(label), colours[label["id"]]
            pixels[mask] = 0.5 * pixels[mask] + 0.5 * colour
            x, y, width, height = label["bbox"]
            pixels[[y, y + height - 1], x : x + width] = colour
            pixels[y : y + height, [x, x + width - 1]] = colour
    depth = np.load(f"data/{image['id']:05}.depth.npy")
    near, far = np.nanpercentile(np.where(np.isfinite(depth), depth, np.nan), [1, 95])
    grey = np.clip((far - depth) / (far - near), 0, 1)
    columns.append(np.concatenate([pixels, np.repeat(grey[..., None], 3, axis=2)]))
picture = bilux.Picture(np.concatenate(columns, axis=1).astype(np.float32))
picture.save("labels.png")
picture
