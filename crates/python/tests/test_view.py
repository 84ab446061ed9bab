"""Views: what a notebook sends goes in, and pictures come out."""

import subprocess
import sys
import threading

import numpy as np
import pytest

import bilux
from bilux import _html, _widget
from bilux._orbit import Orbit


class Shown:
    """What a browser would show."""

    def __init__(self):
        self.frames = []
        self.came = threading.Condition()

    def __call__(self, png, text):
        with self.came:
            self.frames.append((png, text))
            self.came.notify_all()

    def wait_for(self, text):
        """The first picture with this text."""
        with self.came:
            assert self.came.wait_for(lambda: any(text in frame[1] for frame in self.frames), 30), self.frames
            return next(png for png, said in self.frames if text in said)


@pytest.fixture
def view():
    view = bilux.generate("cornell").view(size=(48, 32), spp=8)
    yield view
    view.close()


def test_pictures_come_until_the_last_is_that_of_a_render(view):
    shown = Shown()
    view.show(shown)
    png = shown.wait_for("8 of 8 samples")
    assert png.startswith(b"\x89PNG")
    whole = bilux.generate("cornell").render(size=(48, 32), spp=8, integrator="path")
    assert np.array_equal(view.wait(30).pixels, whole.pixels)
    # What is shown later begins with the latest picture.
    again = Shown()
    view.show(again)
    assert again.frames == [(png, "8 of 8 samples per pixel")]


def test_the_mouse_turns_the_picture_and_turns_it_back(view):
    straight = view.wait(30).pixels
    view.receive({"drag": [0.1, 0.05]})
    turned = view.wait(30).pixels
    assert not np.array_equal(turned, straight)
    view.receive({"zoom": 2.0})
    assert not np.array_equal(view.wait(30).pixels, turned)
    view.receive({"drag": [-0.1, -0.05], "zoom": 0.5})
    assert np.abs(view.wait(30).pixels - straight).mean() < 1e-3 * straight.mean()


def test_what_is_dragged_follows_the_mouse():
    moves = []
    view = bilux.generate("cornell").view(size=(40, 20), spp=1)
    view.move = lambda *move: moves.append(move)
    view.receive({"drag": [0.5, 0.1], "zoom": 2})
    view.close()
    # To the right and down: the camera goes to the left and up, by as much for a pixel either way.
    assert moves == [(-90.0, pytest.approx(9.0), 2.0)]


def test_a_model_in_the_studio_turns_too(folder):
    scene = bilux.Scene()
    scene.add_mesh([[0, 0, 0], [1, 0, 0], [0, 2, 0]], [[0, 1, 2]])
    view = scene.view(size=32, spp=1)
    straight = view.wait(30).pixels
    assert np.array_equal(straight, scene.render(size=32, spp=1, integrator="path").pixels)
    view.move(turn=40)
    assert not np.array_equal(view.wait(30).pixels, straight)
    view.close()


def test_messages_that_make_no_sense_change_nothing(view):
    first = view.wait(30)
    for message in [{}, {"drag": "up"}, {"drag": [1]}, {"drag": [np.nan, 0]}, {"zoom": 0}, {"zoom": -1}, {"drag": None}]:
        view.receive(message)
    assert view.wait(30) is first


def test_changes_of_the_scene_are_seen_after_refresh():
    scene = bilux.generate("cornell")
    view = scene.view(size=16, spp=2)
    before = view.wait(30).pixels
    scene.lights = [bilux.lights.environment(radiance=(1, 0, 0))]
    view.refresh()
    assert not np.array_equal(view.wait(30).pixels, before)
    view.close()


def test_a_move_stops_the_render_before_it():
    view = bilux.generate("cornell").view(size=(200, 150), spp=100_000)
    shown = Shown()
    view.show(shown)
    shown.wait_for("2 of 100000")
    for _ in range(5):
        view.move(turn=10)
    before = len(shown.frames)
    with shown.came:
        assert shown.came.wait_for(lambda: any("1 of 100000" in said for _, said in shown.frames[before:]), 30)
    view.close()
    assert not view._thread.is_alive()


def test_what_goes_wrong_comes_out():
    view = bilux.generate("cornell").view(size=16, spp=1, max_dept=3)
    with pytest.raises(bilux.SceneError, match="max_depth"):
        view.wait(30)
    shown = Shown()
    view.show(shown)
    assert "max_depth" in shown.frames[0][1]
    view.close()
    with pytest.raises(IndexError, match="no camera 3"):
        bilux.generate("cornell").view(camera=3)
    with pytest.raises(TypeError, match="size"):
        bilux.generate("cornell").view(size=None)


def test_the_camera_stays_upright_and_at_its_distance():
    scene = bilux.generate("trio")
    orbit = Orbit(scene)
    [camera] = orbit.place(scene)[0].cameras
    eye, pivot = np.array(camera.parameters["position"]), None
    right = Orbit(scene)
    right.move(turn=90, lift=20)
    [moved] = right.place(scene)[0].cameras
    assert eye[2] > 6 and moved.parameters["position"][0] > 5 and moved.parameters["position"][1] > eye[1]
    for _ in range(30):
        orbit.move(turn=37, lift=50)
        [camera] = orbit.place(scene)[0].cameras
        pivot = np.array(camera.parameters["look_at"])
        place = np.array(camera.parameters["position"])
        assert np.linalg.norm(place - pivot) == pytest.approx(np.linalg.norm(eye - pivot), rel=1e-5)
        assert camera.parameters["up"] == [0, 1, 0]
    ahead = (place - pivot) / np.linalg.norm(place - pivot)
    assert 0.9 < ahead[1] < 1, "from above, but not from straight above"


def test_a_widget_shows_it(view):
    pytest.importorskip("anywidget", reason="anywidget is not installed")
    view.wait(30)
    widget = _widget.of(view)
    assert widget.png.startswith(b"\x89PNG") and "8 of 8" in widget.caption and (widget.width, widget.height) == (48, 32)
    before = view.picture
    widget._handle_custom_msg({"drag": [0.2, 0.0], "zoom": 1}, [])
    assert view.wait(30) is not before
    assert "application/vnd.jupyter.widget-view+json" in view._repr_mimebundle_()[0]


def test_without_anywidget_it_is_html_and_a_comm(view, monkeypatch):
    class Comm:
        sent = []

        def send(self, data):
            self.sent.append(data)

        def on_msg(self, take):
            self.take = take

    bundle = _html.shown(view)
    assert "new_comm" in bundle["text/html"] and "data:image/png;base64," in bundle["text/html"]
    view.wait(30)
    comm = Comm()
    _html.connect(view, comm)
    assert comm.sent[-1]["text"].startswith("8 of 8")
    before = view.picture
    comm.take({"content": {"data": {"drag": [0.2, 0], "zoom": 1}}})
    assert view.wait(30) is not before
    monkeypatch.setattr(_widget, "of", lambda view: None)
    assert "text/html" in view._repr_mimebundle_()


def test_a_scene_shows_a_small_picture_of_itself():
    assert bilux.generate("cornell")._repr_png_().startswith(b"\x89PNG")
    assert bilux.Scene()._repr_png_() is None


def test_a_program_may_end_while_a_view_renders():
    script = "import bilux, time; bilux.generate('trio').view(spp=1_000_000); time.sleep(0.3)"
    subprocess.run([sys.executable, "-c", script], check=True, timeout=30)
