"""Pictures in intervals of length, from Python."""

import numpy as np
import pytest

import bilux


def plate(distance):
    """A plate ahead of a camera with a lamp at it."""
    scene = bilux.Scene()
    corners = [[-5, -5, -distance], [5, -5, -distance], [5, 5, -distance], [-5, 5, -distance]]
    scene.add_mesh(corners, [[0, 1, 2], [0, 2, 3]], material=bilux.materials.diffuse(reflectance=0.5))
    scene.add_light(bilux.lights.point(position=(0, 1e-4, 0), intensity=10))
    scene.add_camera(bilux.cameras.perspective(position=(0, 0, 0), look_at=(0, 0, -1), fov=20))
    return scene


@pytest.mark.parametrize("integrator", ["path", "bdpt"])
def test_a_flash_returns_at_the_speed_of_light(integrator):
    found = plate(3).transient(0.01, 100, begin=5.9, size=(16, 12), spp=4, integrator=integrator)
    lengths = found.edges[:-1] + 0.005
    mean = (found.light[..., 1] * lengths).sum(axis=2) / found.light[..., 1].sum(axis=2)
    y, x = np.meshgrid(np.arange(12) - 5.5, np.arange(16) - 7.5, indexing="ij")
    pixel = 2 * 3 * np.tan(np.radians(10)) / 12
    expected = 2 * np.sqrt(9 + (x * pixel) ** 2 + (y * pixel) ** 2)
    assert np.abs(mean - expected).max() < 0.02
    assert found.rest.max() < 1e-6
    assert found.times[-1] == pytest.approx(6.9 / 299_792_458)


def test_the_intervals_and_the_rest_are_the_picture():
    scene = bilux.generate("cornell")
    settings = dict(size=24, spp=8, integrator="path", seed=5)
    picture = scene.render(denoise=False, **settings).pixels
    found = scene.transient(0.1, 30, begin=1.5, **settings)
    assert np.allclose(found.light.sum(axis=2) + found.rest, picture, atol=1e-5)
    assert (found.light.sum(axis=(0, 1, 3)) > 0).sum() > 8 and found.rest.max() > 0


def test_what_has_no_length_is_refused():
    with pytest.raises(bilux.SceneError, match="vcm"):
        plate(3).transient(0.1, 10, size=8, integrator="vcm")
    with pytest.raises(bilux.SceneError, match="bin_width"):
        plate(3).transient(0, 10, size=8)
    with pytest.raises(ValueError, match="bins"):
        plate(3).transient(0.1, 0, size=8)
    with pytest.raises(bilux.SceneError, match="memory"):
        plate(3).transient(0.1, 100_000, size=512)
    assert plate(3).transient(0.1, 4, size=64, spp=64, progress=lambda progress: False) is None
