"""Motion from arrays, and what happens behind a picture."""

import numpy as np
import pytest

import bilux

GLOW = bilux.materials.diffuse(reflectance=0.0, emission=1.0)


def at(x, y=0.0):
    matrix = np.eye(4)
    matrix[:2, 3] = x, y
    return matrix


@pytest.fixture
def moving(square):
    """A glowing square that moves by three of its widths in a second, in a picture four of them wide."""
    scene = bilux.Scene()
    scene.add_mesh(*square, material=GLOW)
    scene.add_camera(
        bilux.cameras.orthographic(position=(2, 0.5, 2), look_at=(2, 0.5, 0), up=(0, 1, 0), height=1)
    )
    scene.set_keyframes(0, [0, 1], [at(0), at(3)])
    return scene


def row(scene, **settings):
    return scene.render(size=(16, 4), spp=64, integrator="path", tonemap="none", **settings).pixels[1, :, 0]


def test_keyframes_move_an_object(moving):
    begin, middle, end = (row(moving, time=time) for time in (0, 0.5, 1))
    assert (begin > 0.5).nonzero()[0].tolist() == [0, 1, 2, 3]
    assert (middle > 0.5).nonzero()[0].tolist() == [6, 7, 8, 9]
    assert (end > 0.5).nonzero()[0].tolist() == [12, 13, 14, 15]
    assert np.array_equal(row(moving, time=9), end), "after the last keyframe it stands still"
    blurred = row(moving, time=0, shutter=1)
    assert np.allclose(blurred[4:12], 1 / 3, atol=0.1), "an open shutter blurs it"
    moving.set_transform(0, at(3))
    assert np.allclose(row(moving, time=0), end)


def test_keyframes_that_make_no_sense_are_refused(moving):
    shear = at(0)
    shear[0, 1] = 0.5
    for times, transforms, message in [
        ([0, 1], [at(0)], "there are 1 for 2 times"),
        ([0, 1], [at(0), shear], "matrix 1 shears"),
        ([1, 0], [at(0), at(1)], "increase"),
        ([0, np.nan], [at(0), at(1)], "finite"),
        ([0, 1], [at(0), np.diag([-1.0, 1, 1, 1])], "mirror"),
        ([], np.zeros((0, 4, 4)), "at least one"),
    ]:
        with pytest.raises(ValueError, match=message):
            moving.set_keyframes(0, times, transforms)
    with pytest.raises(IndexError):
        moving.set_keyframes(7, [0, 1], [at(0), at(1)])
    assert (row(moving, time=1) > 0.5).nonzero()[0].tolist() == [12, 13, 14, 15], "the motion stays as it was"


def test_replays_are_the_samples_of_the_picture():
    scene, settings = bilux.generate("cornell"), {"size": 8, "spp": 4, "integrator": "path"}
    pixel = scene.render(**settings).pixels[5, 3]
    replays = [scene.replay(3, 5, sample, **settings) for sample in range(4)]
    assert np.allclose(np.mean([replay.radiance for replay in replays], 0), pixel, rtol=1e-3)
    first = replays[0]
    assert str(first).startswith("pixel 3,5 sample 0") and all(what in str(first) for _, what in first.events)
    assert first.rays > 0 and np.isfinite(first.origin + first.direction).all()
    with pytest.raises(bilux.RenderError, match="8"):
        scene.replay(8, 0, **settings)
    with pytest.raises(TypeError, match="spp"):
        scene.replay(0, 0, noise=0.1)


def test_strategies_add_up_to_the_picture():
    scene, settings = bilux.generate("cornell"), {"size": 12, "spp": 2, "integrator": "bdpt", "max_depth": 3}
    found = scene.strategies(**settings)
    assert len({strategy.name for strategy in found}) == len(found) > 4
    assert {strategy.s + strategy.t for strategy in found} <= {2, 3, 4, 5} and not any(s.merges for s in found)
    total = sum(strategy.weighted.pixels for strategy in found)
    assert np.allclose(total, scene.render(**settings).pixels, rtol=1e-3, atol=1e-4)
    assert all((s.unweighted.pixels >= s.weighted.pixels - 1e-4).all() for s in found)
    with pytest.raises(bilux.SceneError, match="'path' has no separate strategies: choose one of .*bdpt"):
        scene.strategies(size=8, spp=1, integrator="path")
    assert scene.strategies(**(settings | {"spp": 100_000}), progress=lambda progress: False) == []
