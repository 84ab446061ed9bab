"""Laser scans from Python: patterns, poses, moving objects, and files of points."""

import numpy as np
import pytest

import bilux

SQUARE = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]]


def at(x, y, z, scale=1.0):
    matrix = np.diag([scale, scale, scale, 1.0])
    matrix[:3, 3] = x, y, z
    return matrix


def wall(distance, half=50.0, **keywords):
    """A scene with a wall of reflectance 0.5 ahead."""
    scene = bilux.Scene()
    scene.add_mesh(*SQUARE, material=bilux.materials.diffuse(reflectance=0.5), transform=at(0, 0, -distance, half), **keywords)
    return scene


def test_a_wall_is_where_it_is_and_as_bright_as_it_is():
    beams = bilux.lidar.raster((21, 11), (40, 20))
    cloud = wall(10).lidar(beams)
    cos = -beams.directions[:, 2]
    assert np.allclose(cloud.range, 10 / cos, rtol=1e-5)
    assert np.allclose(cloud.intensity, 0.5 * cos / np.pi / (10 / cos) ** 2, rtol=1e-4)
    assert np.allclose(cloud.points[:, 2], -10, atol=1e-4) and np.array_equal(cloud.pulse, np.arange(231))
    assert set(cloud.object) == {0} and set(cloud.number) == {1} and set(cloud.count) == {1}
    # From above, to the left, and turned around.
    pose = np.array([[-1.0, 0, 0, 2], [0, 1, 0, 3], [0, 0, -1, -20], [0, 0, 0, 1]])
    behind = wall(10).lidar([[0, 0, -1]], pose=pose)
    assert np.allclose(behind.points, [[2, 3, -10]], atol=1e-5)


def test_the_spinning_pattern_goes_around_and_its_firings_have_their_times():
    beams = bilux.lidar.spinning([-15, 0, 15], 90, frequency=5)
    assert np.allclose(beams.directions[1::3], [[0, 0, -1], [-1, 0, 0], [0, 0, 1], [1, 0, 0]], atol=1e-12)
    assert np.allclose(beams.times, np.repeat([0, 0.05, 0.1, 0.15], 3))
    assert np.allclose(np.degrees(np.arcsin(beams.directions[:3, 1])), [-15, 0, 15])
    ahead = bilux.lidar.spinning([0], 1, azimuths=(-30, 30))
    assert len(ahead.times) == 61 and (-ahead.directions[:, 2] > 0.86).all()


def test_a_scan_of_something_that_moves_is_sheared():
    scene = wall(10, name="car")
    scene.set_keyframes(0, [0, 1], [at(0, 0, -10, 50), at(0, 0, -20, 50)])
    beams = bilux.lidar.Beams(np.tile([0.0, 0, -1], (5, 1)), np.linspace(0, 1, 5))
    assert np.allclose(scene.lidar(beams).range, [10, 12.5, 15, 17.5, 20], rtol=1e-5)
    assert np.allclose(scene.lidar(beams, time=0.5).range, [15, 17.5, 20, 20, 20], rtol=1e-5)
    poses = np.stack([at(0, 0, -z) for z in range(5)])
    assert np.allclose(scene.lidar(beams, pose=poses).range, np.array([10, 12.5, 15, 17.5, 20]) - np.arange(5), rtol=1e-5)


def test_panes_return_what_is_behind_too():
    scene = wall(10)
    scene.add_mesh(*SQUARE, material=bilux.materials.translucent(), transform=at(0, 0, -4, 0.02))
    wide = dict(divergence=20, rays=400)
    both = scene.lidar([[0, 0, -1]], **wide)
    assert np.allclose(both.range, [4, 10], rtol=1e-3) and list(both.object) == [1, 0] and list(both.number) == [1, 2]
    assert list(scene.lidar([[0, 0, -1]], returns="last", **wide).object) == [0]
    assert list(scene.lidar([[0, 0, -1]], returns="first", **wide).object) == [1]


def test_noise_has_its_deviation_and_follows_the_seed():
    beams = np.tile([0.0, 0, -1], (20_000, 1))
    noisy = wall(10).lidar(beams, range_noise=0.03, seed=1)
    assert np.std(noisy.range) == pytest.approx(0.03, rel=0.03) and np.mean(noisy.range) == pytest.approx(10, abs=1e-3)
    assert np.array_equal(noisy.range, wall(10).lidar(beams, range_noise=0.03, seed=1).range)
    assert not np.array_equal(noisy.range, wall(10).lidar(beams, range_noise=0.03, seed=2).range)


def test_the_file_of_points_is_read_again(tmp_path):
    cloud = wall(10).lidar(bilux.lidar.raster((30, 20), (40, 30)))
    cloud.save(tmp_path / "cloud.ply")
    points = bilux.load(tmp_path / "cloud.ply")
    low, high = points.bounds
    assert np.allclose(low, cloud.points.min(axis=0), atol=0.5) and np.allclose(high, cloud.points.max(axis=0), atol=0.5)
    # Two echoes of one pulse, and one of another.
    scene = wall(10)
    scene.add_mesh(*SQUARE, material=bilux.materials.translucent(), transform=at(0, 0, -4, 0.02))
    both = scene.lidar([[0, 0, -1], [0.4, 0, -1]], divergence=20, rays=400)
    both.save(tmp_path / "both.ply")
    head, body = (tmp_path / "both.ply").read_bytes().split(b"end_header\n", 1)
    kinds = {"float": "<f4", "int": "<i4", "uchar": "u1", "double": "<f8"}
    columns = [line.split() for line in head.decode().splitlines() if line.startswith("property")]
    rows = np.frombuffer(body, [(name, kinds[kind]) for _, kind, name in columns])
    assert rows["return_number"].tolist() == both.number.tolist() and rows["number_of_returns"].tolist() == both.count.tolist()
    assert sorted(zip(both.number.tolist(), both.count.tolist(), strict=True)) == [(1, 1), (1, 2), (2, 2)]
    assert np.allclose(rows["intensity"], both.intensity) and rows["object"].tolist() == both.object.tolist()
    with pytest.raises(ValueError, match=".ply"):
        cloud.save(tmp_path / "cloud.xyz")
    with pytest.raises(ValueError, match="colours"):
        cloud.save(tmp_path / "cloud.ply", colours=[[1, 0, 0]])


def test_what_makes_no_sense_is_refused():
    scene = wall(10)
    ahead = [[0, 0, -1]]
    with pytest.raises(ValueError, match="rotation"):
        scene.lidar(ahead, pose=np.diag([2, 1, 1, 1]))
    with pytest.raises(ValueError, match="pose"):
        scene.lidar(ahead, pose=np.eye(3))
    with pytest.raises(ValueError, match="length"):
        scene.lidar([[0, 0, 0]])
    with pytest.raises(ValueError, match="beams"):
        scene.lidar([0, 0, -1])
    with pytest.raises(bilux.SceneError, match="range_noise"):
        scene.lidar(ahead, range_nois=1)
    with pytest.raises(bilux.SceneError, match="rays"):
        scene.lidar(ahead, rays=0)
    with pytest.raises(bilux.SceneError, match="min_range"):
        scene.lidar(ahead, min_range=5, max_range=4)
    with pytest.raises(ValueError, match="azimuth_step"):
        bilux.lidar.spinning([0], 0)
    assert len(scene.lidar(np.empty((0, 3))).range) == 0
