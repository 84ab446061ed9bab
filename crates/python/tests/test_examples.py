"""The examples run, as scripts and as notebooks, and what they write is right."""

import importlib.util
import json
import pathlib
import re
import shutil
import subprocess
import sys

import numpy as np
import pytest

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


CELLS = [path for path in sorted(EXAMPLES.glob("*.py")) if path.read_text("utf-8").startswith("# %%")]


@pytest.mark.parametrize("script", CELLS, ids=lambda path: path.stem)
def test_the_notebook_is_that_of_the_script_and_runs(script, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(EXAMPLES)
    text = importlib.import_module("notebooks").notebook_of(script.read_text("utf-8"))
    notebook = script.with_suffix(".ipynb")
    assert notebook.read_text("utf-8") == text, f"{notebook.name} is old: run {EXAMPLES / 'notebooks.py'}"
    if importlib.util.find_spec("nbclient") and importlib.util.find_spec("ipykernel"):
        shutil.copy(EXAMPLES / "labelled_pictures.py", tmp_path)
        shown = run_notebook(text, tmp_path)
        assert "image/png" in shown, "the last cell shows no picture"
    else:
        print("SKIPPED: nbclient is not installed, so this runs as a script")
        subprocess.run([sys.executable, script], check=True, timeout=120)
    for name in re.findall(r'save(?:fig)?\("(\w+\.png)"', text.replace('\\"', '"')):
        if importlib.util.find_spec("matplotlib") or name != "integrators.png":
            assert bilux.read_picture(tmp_path / name).to_uint8()[..., :3].std() > 8, f"{name} shows nothing"


def run_notebook(text, folder):
    """Runs a notebook in a folder, and returns what its last cell shows."""
    nbformat, nbclient = importlib.import_module("nbformat"), importlib.import_module("nbclient")
    notebook = nbformat.reads(text, as_version=4)
    nbclient.NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(folder)}}).execute()
    return notebook.cells[-1].outputs[-1].data
