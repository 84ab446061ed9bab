"""Pictures by a Ray cluster: two nodes of one core each, in processes of this machine. `cargo xtask python-cluster` runs this.

Nodes are killed, and so is a driver; whatever happens, pictures have the bytes of one machine.
"""

import os
import pathlib
import re
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import bilux

ray = pytest.importorskip("ray", reason="Ray is missing: cargo xtask python-cluster installs it")
cluster_utils = pytest.importorskip("ray.cluster_utils")


@pytest.fixture(scope="module")
def cluster():
    """A head without CPUs, and two nodes with one each."""
    cluster = cluster_utils.Cluster(initialize_head=True, head_node_args={"num_cpus": 0})
    for _ in range(2):
        cluster.add_node(num_cpus=1)
    ray.init(address=cluster.address, log_to_driver=False)
    yield cluster
    ray.shutdown()
    cluster.shutdown()


@pytest.fixture
def scene():
    return bilux.generate("cornell")


def saved(picture, name):
    picture.save(name)
    return pathlib.Path(name).read_bytes()


@pytest.mark.parametrize("integrator", ["auto", "path", "whitted", "sppm"])
def test_the_picture_is_that_of_one_machine(cluster, scene, tmp_path, monkeypatch, integrator):
    monkeypatch.chdir(tmp_path)
    settings = {"size": (48, 64), "spp": 5, "integrator": integrator, "aov": ["depth", "ids"]}
    here, there = scene.render(**settings), bilux.cluster.render(scene, **settings)
    assert saved(here, "here.exr") == saved(there, "there.exr")
    assert there.info["workers"] in (1, 2) and there.info["parts"] > 1 and there.info["scene_bytes"] > 1000
    assert (here.info["spp"], here.info["choice"]) == (there.info["spp"], there.info["choice"])


def test_noise_ends_the_picture_at_the_same_sample(cluster, scene, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    settings = {"size": (64, 48), "noise": 0.15, "integrator": "path", "denoise": "builtin"}
    here, there = scene.render(**settings), bilux.cluster.render(scene, **settings)
    assert saved(here, "here.png") == saved(there, "there.png")
    assert here.info["spp"] == there.info["spp"] and here.info["noise"] == there.info["noise"]
    assert there.info["denoiser"] and np.array_equal(here["noisy"], there["noisy"])


def test_a_node_that_is_killed_costs_only_its_parts(cluster, scene, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    settings = {"size": (320, 240), "spp": 96, "integrator": "path"}
    doomed = cluster.add_node(num_cpus=1)
    killed = []

    def kill(picture):
        if not killed:
            killed.append(time.monotonic())
            cluster.remove_node(doomed, allow_graceful=False)

    there = bilux.cluster.render(scene, preview=kill, **settings)
    assert killed and there.info["given_again"] > 0 and there.info["workers"] == 2
    assert saved(scene.render(**settings), "here.exr") == saved(there, "there.exr")


def workers():
    """The processes that render, on nodes that this process has started."""

    def stat(path):
        name, parent = path.read_text().rsplit(") ", 1)
        return int(path.parent.name), name.split("(", 1)[1], int(parent.split()[1])

    processes = []
    for path in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            processes.append(stat(path))
        except OSError:
            pass
    raylets = {process for process, _, parent in processes if parent == os.getpid()}
    return [process for process, name, parent in processes if parent in raylets and name.startswith("ray::Worker")]


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="processes are found in /proc")
def test_what_a_slow_worker_has_is_given_to_another(cluster, scene, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    # Long enough for a preview before it is done.
    settings = {"size": (320, 240), "spp": 96, "integrator": "path"}
    stopped = []

    def stop(picture):
        if not stopped:
            stopped.append(workers()[0])
            os.kill(stopped[0], signal.SIGSTOP)

    there = bilux.cluster.render(scene, preview=stop, **settings)
    assert stopped and there.info["given_again"] > 0
    assert saved(scene.render(**settings), "here.exr") == saved(there, "there.exr")


DRIVER = """
import sys, ray, bilux
ray.init(address=sys.argv[1], log_to_driver=False)
scene = bilux.generate("cornell")
bilux.cluster.render(scene, size=(320, 240), spp=96, integrator="path", resume="job", preview=lambda _: print("seen", flush=True))
"""


def test_a_driver_that_is_killed_goes_on(cluster, scene, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    driver = subprocess.Popen([sys.executable, "-c", DRIVER, cluster.address], stdout=subprocess.PIPE, text=True)
    assert driver.stdout.readline() == "seen\n"
    driver.kill()
    driver.wait()
    films = list(pathlib.Path("job").glob("*.film"))
    assert films
    films[0].write_bytes(films[0].read_bytes()[:-1])
    settings = {"size": (320, 240), "spp": 96, "integrator": "path"}
    there = bilux.cluster.render(scene, resume="job", **settings)
    assert there.info["parts_here"] == len(films) - 1 and there.info["parts"] > 0
    assert saved(scene.render(**settings), "here.exr") == saved(there, "there.exr")
    again = bilux.cluster.render(scene, resume="job", **settings)
    assert again.info["parts"] == 0 and np.array_equal(again.pixels, there.pixels)
    with pytest.raises(bilux.Error, match="parts of another picture"):
        bilux.cluster.render(scene, resume="job", **settings | {"seed": 1})


def test_animations_and_data_sets_come_in_order_and_resume(cluster, square, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scene = bilux.Scene()
    ball = scene.add_mesh(*square, material=bilux.materials.diffuse(emission=1.0))
    scene.add_camera(bilux.cameras.orthographic(position=(0.5, 0.5, 2), look_at=(0.5, 0.5, 0), height=4))
    taken = []

    def scenes():
        for number in range(12):
            place = np.eye(4)
            place[0, 3] = number / 10
            scene.set_transform(ball, place)
            taken.append(number)
            yield scene, {"seed": number}

    settings = {"size": 16, "spp": 2, "aov": ["ids"], "resume": "set"}
    pictures = list(bilux.cluster.dataset(scenes(), **settings))
    for number, picture in enumerate(pictures):
        place = np.eye(4)
        place[0, 3] = number / 10
        scene.set_transform(ball, place)
        here = scene.render(size=16, spp=2, seed=number, aov="ids")
        assert np.array_equal(picture.pixels, here.pixels) and np.array_equal(picture["id"], here["id"])
    kept = sorted(os.listdir("set"))
    assert len(kept) == 12
    os.remove(f"set/{kept[3]}")
    begun = time.monotonic()
    again = list(bilux.cluster.dataset(scenes(), **settings))
    assert all(saved(one, "one.png") == saved(other, "other.png") for one, other in zip(again, pictures))
    assert sum(os.stat(f"set/{name}").st_mtime > time.time() - (time.monotonic() - begun) for name in kept) == 1
    moving = list(bilux.cluster.animation(scene, [0, 0.5], size=16, spp=1))
    assert np.array_equal(moving[1].pixels, scene.render(size=16, spp=1, time=0.5).pixels)


def test_ctrl_c_leaves_what_there_is(cluster, scene):
    def interrupt(_):
        threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)).start()

    with pytest.raises(bilux.Interrupted) as interrupted:
        bilux.cluster.render(scene, size=(320, 240), spp=100_000, integrator="path", preview=interrupt)
    assert interrupted.value.picture.pixels.shape == (240, 320, 3)
    stopped = bilux.cluster.render(scene, size=64, spp=100_000, preview=lambda _: False)
    assert not stopped.info["complete"] and stopped.info["spp"] > 0


def test_errors_say_what_is_wrong(cluster, scene, monkeypatch):
    with pytest.raises(bilux.SceneError, match="did you mean 'path'"):
        bilux.cluster.render(scene, integrator="pth")
    with pytest.raises(bilux.SceneError, match="time"):
        list(bilux.cluster.animation(scene, [float("nan")], size=8))
    with pytest.raises(TypeError, match="crop: a cluster renders whole pictures"):
        bilux.cluster.render(scene, crop=(0, 0, 1, 1))
    with pytest.raises(bilux.RenderError, match="'interval'"):
        bilux.cluster.render(scene, size=8, spp=4, aov=["interval"])
    with pytest.raises(bilux.Error, match="resume: cannot make the folder"):
        bilux.cluster.render(scene, size=8, spp=4, resume="/dev/null/folder")
    with pytest.raises(ValueError, match="is connected to the cluster"):
        bilux.cluster.render(scene, address="192.0.2.1:6379")
    with monkeypatch.context() as newer, pytest.raises(bilux.Error, match="has bilux .*, but this process has 99"):
        newer.setattr("bilux._workers.__version__", "99")
        bilux.cluster.render(scene, size=8, spp=1)
    monkeypatch.setattr(ray, "__version__", "2.1.0")
    with pytest.raises(bilux.Error, match="Ray 2.1.0 is too old"):
        bilux.cluster.render(scene)
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(bilux.Error, match="needs Ray: pip install bilux.ray."):
        list(bilux.cluster.dataset([scene]))


def test_every_example_of_the_page_runs(cluster, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = pathlib.Path(__file__).resolve().parents[3] / "docs/tutorials/cluster.md"
    space = {}
    for block in re.findall(r"```python\n(.*?)```", page.read_text("utf-8"), re.DOTALL):
        exec(block, space)
    assert pathlib.Path("objects-3.npy").exists() and pathlib.Path("frame-0002.png").exists()
