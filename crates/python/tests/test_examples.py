"""The example scripts run, and what they write is right."""

import json
import pathlib
import subprocess
import sys

import numpy as np

import bilux

EXAMPLES = pathlib.Path(__file__).resolve().parents[1] / "examples"


def test_labelled_pictures(tmp_path):
    words = [tmp_path / "data", "--count", 3, "--size", 64, "--spp", 4, "--processes", 2]
    subprocess.run([sys.executable, EXAMPLES / "labelled_pictures.py", *map(str, words)], check=True, timeout=120)
    instances = json.loads((tmp_path / "data/instances.json").read_text())
    assert len(instances["images"]) == 3 and len(instances["annotations"]) >= 5
    for label in instances["annotations"]:
        counts = label["segmentation"]["counts"]
        mask = np.repeat(np.arange(len(counts)) % 2, counts).reshape(64, 64, order="F")
        rows, columns = np.nonzero(mask)
        x, y, width, height = label["bbox"]
        assert (x, y) == (columns.min(), rows.min())
        assert (width, height) == (columns.max() - x + 1, rows.max() - y + 1) and label["area"] == mask.sum()
        depth = np.load(tmp_path / f"data/{label['image_id']:05}.depth.npy")
        assert np.isfinite(depth[mask == 1]).all()
        objects = np.load(tmp_path / f"data/{label['image_id']:05}.objects.npy")
        [number] = set(objects[mask == 1])
        assert np.array_equal(objects == number, mask == 1)
    picture = bilux.read_picture(tmp_path / "data/00000.png").pixels
    assert 0.05 < picture.mean() < 0.8
