"""What the tests share."""

import os
import pathlib
import shutil
import subprocess

import numpy as np
import pytest

import bilux

ROOT = pathlib.Path(__file__).resolve().parents[3]


@pytest.fixture(scope="session")
def command_line():
    """Runs the command line program; skips where it is not built."""
    binary = os.environ.get("BILUX_BINARY", "")
    candidates = [binary, ROOT / "target/debug/bilux", ROOT / "target/release/bilux"]
    found = next((path for path in candidates if path and pathlib.Path(path).is_file()), None)
    if found is None:
        pytest.skip("the command line program is not built")
    found = pathlib.Path(found).resolve()

    def run(*words):
        return subprocess.run([found, *map(str, words)], check=True, capture_output=True, text=True)

    run.program = found
    return run


@pytest.fixture(scope="session")
def model(tmp_path_factory):
    """A file of a model, which is made once."""
    path = tmp_path_factory.mktemp("model") / "model.glb"
    bilux.generate("trio").save(path)
    return path


@pytest.fixture
def folder(tmp_path, monkeypatch, model):
    """An empty working directory with a model in it."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(model, "model.glb")
    return tmp_path


@pytest.fixture(scope="session")
def wall():
    """The beginning of a scene file: a camera, and a wall of clay that fills its picture."""
    return """
[camera]
position = [0, 0, 6]
look_at = [0, 0, 0]
fov = 30

[[material]]
name = "clay"
kind = "diffuse"
reflectance = [0.6, 0.4, 0.2]

[[model]]
shape = "quad"
name = "wall"
material = "clay"
scale = 20
translate = [0, 0, -2]
"""


@pytest.fixture
def square():
    """Vertices and triangles of the unit square at z = 0, which faces up."""
    return np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32), np.array([[0, 1, 2], [0, 2, 3]])
