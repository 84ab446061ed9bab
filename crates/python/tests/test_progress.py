"""Renders are followed, stopped and interrupted, and leave the GIL and memory alone."""

import gc
import subprocess
import sys
import textwrap
import threading
import time
import weakref

import numpy as np
import pytest

import bilux


def long_render(scene, **keywords):
    # If nothing stops it, the time limit does, so that the test fails instead of hanging.
    return scene.render(size=400, spp=100_000, integrator="path", time_limit=20, denoise=False, **keywords)


def test_a_callback_follows_the_render():
    seen = []
    picture = bilux.generate("cornell").render(size=80, spp=60, integrator="path", progress=seen.append)
    assert picture.info["complete"] and seen
    assert all(0 <= a.fraction <= b.fraction <= 1 for a, b in zip(seen, seen[1:]))
    assert seen[-1].total == 80 * 80 * 60 and seen[-1].rays > 0 and seen[-1].seconds > 0


def test_a_callback_stops_the_render_and_keeps_the_picture():
    begun = time.monotonic()
    picture = long_render(bilux.generate("cornell"), progress=lambda progress: progress.seconds < 0.5)
    assert time.monotonic() - begun < 3
    assert not picture.info["complete"] and picture.pixels.max() > 0
    assert 0 < picture.info["spp"] < 100_000 and picture.info["spp_asked"] == 100_000


def test_what_a_callback_raises_comes_out():
    def broken(progress):
        raise LookupError("mine")

    begun = time.monotonic()
    with pytest.raises(LookupError, match="mine"):
        long_render(bilux.generate("cornell"), progress=broken)
    assert time.monotonic() - begun < 3


def test_other_threads_run_during_a_render():
    ticks = 0
    done = threading.Event()

    def tick():
        nonlocal ticks
        while not done.is_set():
            ticks += 1
            time.sleep(0.005)

    thread = threading.Thread(target=tick)
    thread.start()
    bilux.generate("cornell").render(size=128, spp=8, threads=1)
    done.set()
    thread.join()
    assert ticks > 10


@pytest.mark.skipif(sys.platform == "win32", reason="sends a signal")
def test_ctrl_c_leaves_what_there_is():
    script = """
        import os, signal, threading, time
        import bilux
        scene = bilux.generate("cornell")
        sent = []
        def send():
            time.sleep(1)
            sent.append(time.monotonic())
            os.kill(os.getpid(), signal.SIGINT)
        threading.Thread(target=send).start()
        try:
            scene.render(size=400, spp=100_000, integrator="path", time_limit=20, denoise=False)
            print(20)
        except KeyboardInterrupt as stopped:
            seconds = time.monotonic() - sent[0]
            assert isinstance(stopped, bilux.Interrupted)
            assert stopped.picture.pixels.max() > 0 and not stopped.picture.info["complete"]
            print(seconds)
    """
    run = subprocess.run([sys.executable, "-c", textwrap.dedent(script)], capture_output=True, text=True, timeout=60)
    assert run.returncode == 0, run.stderr
    # The promise is 0.2 s; a busy machine gets more.
    assert float(run.stdout) < 1.0


def test_many_renders_in_threads_keep_memory_flat():
    resource = pytest.importorskip("resource")
    scene = bilux.generate("cornell")

    def render():
        return scene.render(size=24, spp=1, threads=1, integrator="path", aov=["depth"])

    wanted = render().pixels
    wrong = []

    def work():
        wrong.extend(picture for picture in (render() for _ in range(25)) if not np.array_equal(picture.pixels, wanted))

    def run():
        threads = [threading.Thread(target=work) for _ in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    warm, after = run(), run()
    assert not wrong
    assert after - warm < 20_000, f"{warm} kB after 200 renders, then {after} kB"


def test_objects_are_freed():
    def references():
        gc.collect()
        return sum(str(type(thing).__module__).startswith("bilux") for thing in gc.get_objects())

    scene = bilux.generate("cornell")
    picture = scene.render(size=8, spp=1)
    pixels = weakref.ref(picture.pixels)
    before = references()
    for _ in range(20):
        scene.copy().render(size=8, spp=1, integrator="path", progress=lambda progress: None)
    assert references() == before
    del picture
    gc.collect()
    assert pixels() is None


def test_a_scene_that_changes_during_a_render_does_not_change_the_picture(square):
    scene = bilux.generate("cornell")
    wanted = scene.render(size=64, spp=64, integrator="path").pixels
    changed = []

    def change(progress):
        if not changed:
            changed.append(scene.add_mesh(*square))
            scene.lights = []

    begun = scene.copy()
    picture = scene.render(size=64, spp=64, integrator="path", progress=change)
    assert np.array_equal(picture.pixels, wanted)
    assert len(begun.lights) > 0


def test_a_forked_process_gets_an_exception_and_does_not_hang():
    if not hasattr(__import__("os"), "fork"):
        pytest.skip("this system does not fork")
    script = """
        import os, sys, warnings
        warnings.simplefilter("ignore")
        import bilux
        bilux.generate("cornell").render(size=16, spp=1)
        child = os.fork()
        if child == 0:
            try:
                bilux.generate("cornell").render(size=16, spp=1)
            except bilux.Error as error:
                os._exit(7 if "spawn" in str(error) else 1)
            os._exit(2)
        sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
    """
    run = subprocess.run([sys.executable, "-c", textwrap.dedent(script)], capture_output=True, text=True, timeout=60)
    assert run.returncode == 7, run.stderr


@pytest.mark.parametrize("bar", ["tqdm", "line"])
def test_true_shows_a_bar(monkeypatch, capsys, bar):
    if bar == "tqdm":
        pytest.importorskip("tqdm")
    else:
        monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    bilux.generate("cornell").render(size=80, spp=60, integrator="path", progress=True)
    shown = capsys.readouterr().err
    assert "Mrays/s" in shown and "%" in shown


@pytest.mark.parametrize("work", ["render", "callback", "progressive", "queries"])
def test_a_program_may_end_while_a_thread_works(work):
    script = f"""
import threading, time, numpy as np, bilux
scene = bilux.generate("trio")
accel = bilux.Accel([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
rays = np.ones((3, 3))
begun = threading.Event()
def work(what={work!r}):
    while True:
        begun.set()
        if what == "render":
            scene.render(size=128, spp=10_000)
        if what == "callback":
            scene.render(size=128, spp=10_000, progress=lambda progress: time.sleep(0.01))
        if what == "progressive":
            list(scene.progressive(size=64, spp=10_000))
        if what == "queries":
            accel.closest(rays, rays)
threading.Thread(target=work, daemon=True).start()
begun.wait()
time.sleep(0.3)
"""
    for _ in range(3):
        ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
        assert (ended.returncode, ended.stderr) == (0, "")
