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


def run_script(name, *words):
    """Runs an example as a script."""
    command = [sys.executable, EXAMPLES / name, *map(str, words)]
    subprocess.run(command, check=True, timeout=300)


def test_stereo_rig(tmp_path):
    run_script("stereo_rig.py", tmp_path, "--size", 160, 120, "--spp", 16)
    depth, disparity = np.load(tmp_path / "depth.npy"), np.load(tmp_path / "disparity.npy")
    assert depth.shape == (120, 160) and np.isfinite(depth).mean() > 0.95
    # Focal length times base over depth.
    focal = 80 / np.tan(np.radians(35))
    assert np.nanmax(np.abs(disparity - focal * 0.04 / depth)) < 1e-3
    # What the left camera sees is where its disparity says in the picture of the right one.
    left, right = (bilux.read_picture(tmp_path / f"{name}.png").pixels.mean(axis=2) for name in ("left", "right"))
    rows, columns = np.mgrid[0:120, 0:160]

    def apart(disparity):
        there = np.clip(np.rint(columns - np.nan_to_num(disparity)), 0, 159).astype(int)
        return np.median(np.abs(left - right[rows, there])[:, 40:])

    assert apart(disparity) < 0.7 * apart(-disparity) and apart(disparity) < 0.8 * apart(0 * disparity)
    # The pair in one picture is the same two.
    pair = bilux.read_picture(tmp_path / "pair.png").pixels.mean(axis=2)
    assert pair.shape == (120, 320) and abs(np.median(pair) - np.median(left)) < 0.1
    cameras = bilux.read_cameras(tmp_path / "calibration.yml")
    assert [camera.name for camera in cameras] == ["1", "2"] and np.isclose(cameras[0].parameters["fx"], focal)
    for name in ("left", "right", "pair", "disparity"):
        assert bilux.read_picture(tmp_path / f"{name}.png").to_uint8().std() > 8, f"{name} shows nothing"


def test_room_360(tmp_path):
    run_script("room_360.py", tmp_path, "--width", 128, "--spp", 2)
    room = bilux.read_picture(tmp_path / "room.png").pixels
    both = bilux.read_picture(tmp_path / "room-3d.png").pixels
    assert room.shape == (64, 128, 3) and both.shape == (128, 128, 3)
    # Each eye sees about what one in the middle sees.
    for eye in (both[:64], both[64:]):
        assert np.abs(eye - room).mean() < 0.3 * room.mean()
    # The panorama closes: its left edge continues at the right one.
    assert np.abs(room[:, 0] - room[:, -1]).mean() < 0.3 * room.mean()
    # Its middle is that of the front face.
    front = bilux.read_picture(tmp_path / "front.png").pixels
    assert front.shape == (32, 32, 3)
    assert np.abs(front[14:18, 14:18].mean() - room[30:34, 62:66].mean()) < 0.15


def test_bop_dataset(tmp_path):
    words = [tmp_path / "data", "--count", 2, "--spp", 4]
    subprocess.run([sys.executable, EXAMPLES / "bop_dataset.py", *map(str, words)], check=True, timeout=120)
    folder = tmp_path / "data/train_pbr/000000"
    poses, info = (json.loads((folder / f"scene_{name}.json").read_text()) for name in ("gt", "gt_info"))
    models = json.loads((tmp_path / "data/models/models_info.json").read_text())
    for number in ("0", "1"):
        assert len(poses[number]) == len(info[number]) >= 6
        # All lie in the heap before the camera, in millimetres; some hide others.
        assert all(300 < pose["cam_t_m2c"][2] < 1500 and str(pose["obj_id"]) in models for pose in poses[number])
        assert min(one["visib_fract"] for one in info[number]) < 0.95 and max(one["visib_fract"] for one in info[number]) > 0.7
        assert bilux.read_picture(folder / f"rgb/{int(number):06}.png").to_uint8()[..., :3].std() > 8
    model = bilux.load(tmp_path / "data/models/obj_000001.ply")
    assert np.ptp(np.array(model.bounds)[:, 1]) == pytest.approx(models["1"]["size_y"], rel=1e-5)


# What a notebook need not wait for while it is tested.
SHORTER = {
    "integrators": [("(0.15, 0.3, 0.6)", "(0.05, 0.1, 0.2)"), ("time_limit=3", "time_limit=0.6")],
    "lidar": [("size=(640, 480), spp=16", "size=(320, 240), spp=4")],
    "office_lux": [("points, spp=256", "points, spp=32")],
}

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
        for long, short in SHORTER.get(script.stem, []):
            assert long in text, f"{script.stem} no longer says {long}"
            text = text.replace(long, short)
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
