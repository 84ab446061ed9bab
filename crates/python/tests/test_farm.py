"""Jobs that `bilux farm` writes, checked and run by OpenJD's own tools."""

import pathlib
import shutil
import subprocess
import sys

import pytest

pytest.importorskip("openjd.cli", reason="openjd-cli is not installed")


@pytest.fixture
def openjd():
    """Runs OpenJD's command line."""
    program = shutil.which("openjd", path=pathlib.Path(sys.executable).parent) or "openjd"

    def run(*words):
        done = subprocess.run([program, *map(str, words)], capture_output=True, text=True, timeout=120)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    return run


def test_a_picture_from_a_farm_has_the_bytes_of_a_local_one(folder, command_line, openjd):
    options = ["--size", "64x48", "--spp", "6", "--background", "transparent", "--exposure", "0.5"]
    command_line("farm", "model.glb", "--chunks", 3, "-o", "job", "--", *options)
    assert "passes validation" in openjd("check", "job/template.yaml")
    program = f"Bilux={command_line.program}"
    done = openjd("run", "job/template.yaml", "--step", "Merge", "--run-dependencies", "-p", program)
    assert "Chunks run: 4" in done
    assert "openjd_progress: 100.0" in done
    command_line("render", "model.glb", "-o", "local.png", *options)
    assert (folder / "job/pictures/model.png").read_bytes() == (folder / "local.png").read_bytes()


def test_frames_from_a_farm_have_the_bytes_of_local_ones(folder, command_line, openjd):
    command_line("generate", "teapots", "--count", 2, "--set", "moving=true", "--set", "tessellation=3", "-o", "move.toml")
    options = ["--size", "32x24", "--spp", "2", "--set", "fps=1"]
    command_line("farm", "move.toml", "--frames", "0-3", "--chunks", 2, "-o", "job", "--", *options)
    openjd("check", "job/template.yaml")
    # One task by itself, as a farm gives it to a node, and then all of them.
    openjd("run", "job/template.yaml", "--step", "Render", "-tp", "Frames=2-3", "-p", f"Bilux={command_line.program}")
    assert sorted(path.name for path in (folder / "job/pictures").iterdir()) == ["move-0002.png", "move-0003.png"]
    openjd("run", "job/template.yaml", "--step", "Render", "-p", f"Bilux={command_line.program}")
    command_line("render", "move.toml", "--frames", "0-3", "-o", "move-{frame}.png", *options)
    frames = [folder / f"move-{number:04}.png" for number in range(4)]
    for frame in frames:
        assert (folder / "job/pictures" / frame.name).read_bytes() == frame.read_bytes()
    assert frames[0].read_bytes() != frames[3].read_bytes()
