"""Labels of one moment: objects, cameras and skins that move, and depths at any distance, by closed forms."""

import base64
import json
import pickle

import numpy as np
import pytest

import bilux
from bilux import labels
from test_datasets import png

SIZE = (120, 90)
CARD = np.array([[-0.3, -0.2, 0], [0.3, -0.2, 0], [0.3, 0.2, 0], [-0.3, 0.2, 0]])
HALVES = [[0, 1, 2], [0, 2, 3]]
# It looks along -z all the time, and is at (t, t / 4, 6 + t).
MOVING = b"""
[[camera]]
fov = 50
position = [0, 0, 6]
look_at = [0, 0, 0]
[[camera.keyframes]]
time = 0
[[camera.keyframes]]
time = 2
position = [2, 0.5, 8]
look_at = [2, 0.5, 0]

[[light]]
kind = "environment"
"""


def seen_by_moving_camera():
    """A card that moves by (0, 1/2, -1) in a second, and one that stands still."""
    scene = bilux.load(MOVING + b"[[model]]\nshape = 'quad'\nname = 'far'\nscale = 50\ntranslate = [0, 0, -30]\n", format="toml")
    card = scene.add_mesh(CARD, HALVES, name="card", category="card")
    places = np.stack([np.eye(4)] * 2)
    places[1, :3, 3] = [0, 1, -2]
    scene.set_keyframes(card, [0, 2], places)
    place = np.eye(4)
    place[:3, 3] = [1.5, -0.7, 1]
    scene.add_mesh(CARD, HALVES, name="still", category="card", transform=place)
    return scene


@pytest.mark.parametrize("time", [0.0, 0.5, 1.5])
def test_poses_are_those_of_a_moving_camera(tmp_path, time):
    scene = seen_by_moving_camera()
    seen = labels.instances(scene, size=SIZE, margin=80, time=time)
    picture = scene.render(size=SIZE, spp=1, integrator="path", aov=["z_depth"], time=time)
    bop = labels.Bop(tmp_path, ["card"])
    bop.add(picture, seen, scene.cameras[0])
    bop.save()
    poses = json.loads((tmp_path / "scene_gt.json").read_text())["0"]
    [known] = json.loads((tmp_path / "scene_camera.json").read_text()).values()
    eye = np.array([time, time / 4, 6 + time])
    for pose, instance, place in zip(poses, seen, ([0, time / 2, -time], [1.5, -0.7, 1]), strict=True):
        x, y, z = place - eye
        np.testing.assert_allclose(pose["cam_t_m2c"], [x * 1e3, -y * 1e3, -z * 1e3], atol=0.01)
        # Its middle is in the middle of its mask.
        pixel = np.reshape(known["cam_K"], (3, 3)) @ pose["cam_t_m2c"]
        left, top, width, height = instance.masks.box
        middle = [left + (width - 1) / 2, top + (height - 1) / 2]
        np.testing.assert_allclose(pixel[:2] / pixel[2], middle, atol=1)
    labels.kitti(tmp_path / "a.txt", seen[1:], scene.cameras[0], SIZE)
    [line] = (tmp_path / "a.txt").read_text().splitlines()
    x, y, z = np.array([1.5, -0.9, 1]) - eye
    np.testing.assert_allclose([float(word) for word in line.split()[11:14]], [x, -y, -z], atol=1e-4)


def test_labels_of_two_moments_are_refused(tmp_path):
    scene = seen_by_moving_camera()
    picture = scene.render(size=SIZE, spp=1, integrator="path", aov=["z_depth"], time=0.5)
    early, late = (labels.instances(scene, size=SIZE, time=time) for time in (0.5, 0.75))
    with pytest.raises(ValueError, match=r"of different moments, 0.5 and 0.75 s"):
        labels.Bop(tmp_path, ["card"]).add(picture, late, scene.cameras[0])
    with pytest.raises(ValueError, match=r"of different moments, 0.5 and 0.75 s"):
        labels.kitti(tmp_path / "a.txt", [early[0], late[1]], scene.cameras[0], SIZE)


def test_cameras_keep_their_keyframes():
    [camera] = seen_by_moving_camera().cameras
    assert [time for time, _ in camera.keyframes] == [0, 2]
    scene = bilux.Scene()
    scene.cameras = [camera]
    scene.add_camera(pickle.loads(pickle.dumps(camera)))
    assert scene.cameras == [camera, camera]
    for time in (0.0, 0.5, 2.0, 3.0):
        at = min(time, 2.0)
        origins, directions = camera.rays([[59.5, 44.5]], size=SIZE, time=time)
        np.testing.assert_allclose(origins, [[at, at / 4, 6 + at]], atol=1e-6)
        np.testing.assert_allclose(directions, [[0, 0, -1]], atol=1e-6)
        np.testing.assert_allclose(camera.project([[at, at / 4, 0]], size=SIZE, time=time), [[59.5, 44.5]], atol=1e-4)
    still = camera.with_(position=(0, 0, 9), look_at=(0, 0, 0))
    np.testing.assert_allclose(still.rays([[59.5, 44.5]], size=SIZE, time=1.7)[0], [[0, 0, 9]])
    with pytest.raises(TypeError, match="lights do not move"):
        type(camera)("lights", "point", {}, "", [(0.0, {})])


def skinned():
    """A strip from y = 0 to 1, whose upper end a joint lifts by 2 in a second, as a file."""
    arrays = {
        "positions": np.array([[-0.2, 0, 0], [0.2, 0, 0], [0.2, 1, 0], [-0.2, 1, 0]], "<f4"),
        "joints": np.array([[0, 0, 0, 0]] * 2 + [[1, 0, 0, 0]] * 2, "<u2"),
        "weights": np.array([[1, 0, 0, 0]] * 4, "<f4"),
        "triangles": np.array([0, 1, 2, 0, 2, 3], "<u2"),
        "times": np.array([0, 1], "<f4"),
        "places": np.array([[0, 1, 0], [0, 3, 0]], "<f4"),
        "inverse": np.array([np.eye(4), np.eye(4)], "<f4"),
    }
    arrays["inverse"][1, 3, 1] = -1
    kinds = {"positions": "VEC3", "joints": "VEC4", "weights": "VEC4", "triangles": "SCALAR", "times": "SCALAR", "places": "VEC3", "inverse": "MAT4"}
    data, views, accessors = b"", [], []
    for name, array in arrays.items():
        flat = array.tobytes() + b"\0" * (-array.nbytes % 4)
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": array.nbytes})
        view = {"bufferView": len(views) - 1, "componentType": 5126 if array.dtype == "<f4" else 5123, "type": kinds[name]}
        count = array.size if kinds[name] == "SCALAR" else len(array)
        limits = {"min": array.min(0).tolist(), "max": array.max(0).tolist()} if name == "positions" else {}
        limits = {"min": [0.0], "max": [1.0]} if name == "times" else limits
        accessors.append(view | {"count": count} | limits)
        data += flat
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0, "skin": 0, "name": "strip"}, {"name": "root", "children": [2]}, {"name": "tip", "translation": [0, 1, 0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2}, "indices": 3}]}],
        "skins": [{"joints": [1, 2], "inverseBindMatrices": 6}],
        "animations": [{"channels": [{"sampler": 0, "target": {"node": 2, "path": "translation"}}], "samplers": [{"input": 4, "output": 5}]}],
        "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
        "bufferViews": views, "accessors": accessors,
    }  # fmt: skip
    return json.dumps(document).encode()


@pytest.mark.parametrize("way", ["loaded", "posed"])
def test_bounds_of_skins_are_of_the_moment(way):
    scene = bilux.load(skinned(), format="gltf", time=0.25 if way == "loaded" else 0.0)
    scene.set_category(0, "strip")
    scene.add_camera(bilux.cameras.perspective(position=(0, 1, 5), look_at=(0, 1, 0), fov=60))
    if way == "posed":
        scene.pose(time=0.25)
    [one] = labels.instances(scene, size=SIZE)
    np.testing.assert_allclose(one.bounds, [[-0.2, 0, 0], [0.2, 1.5, 0]], atol=1e-6)
    focal = SIZE[1] / 2 / np.tan(np.radians(30))
    assert one.time == 0.25 and abs(one.masks.visible_box[3] - focal * 1.5 / 5) <= 1
    # Another moment than that of its meshes is no silent mixture.
    for call in (labels.instances, bilux.Scene.amodal, bilux.Scene.irradiance):
        arguments = ([[0, 0, 0]],) if call is bilux.Scene.irradiance else ()
        with pytest.raises(bilux.SceneError, match=r"read for 0.25 s: .* scene.pose\(time=0.75\)"):
            call(scene, *arguments, time=0.75)
    with pytest.raises(bilux.SceneError, match=r"read for 0.25 s"):
        scene.lidar([[0, 0, -1]], time=0.75)


@pytest.mark.parametrize("distances", [(9.0, 40.0), (0.3, 0.7), (70.0, 650.0), (2.0, 6.6)])
def test_depths_of_bop_fit_at_any_distance(tmp_path, distances):
    scene = bilux.Scene()
    for side, z in zip((-1, 1), distances, strict=True):
        scene.add_mesh(CARD * z + [side * z * 0.35, 0, -z], HALVES, name=f"at {z}", category="card")
    K = np.array([[100, 0, 59.5], [0, 100, 44.5], [0, 0, 1.0]])
    scene.add_camera(bilux.cameras.opencv(K, np.diag([1.0, -1, -1, 1]), size=SIZE))
    scene.add_light(bilux.lights.environment(radiance=1))
    picture = scene.render(size=SIZE, spp=1, integrator="path", labels=True)
    bop = labels.Bop(tmp_path / "a", ["card"])
    bop.add(picture, labels.instances(scene, size=SIZE), scene.cameras[0])
    bop.save()
    scale = json.loads((tmp_path / "a/scene_camera.json").read_text())["0"]["depth_scale"]
    millimetres = png(tmp_path / "a/depth/000000.png") * scale
    visible = np.isfinite(picture["z_depth"])
    np.testing.assert_allclose(millimetres[visible], picture["z_depth"][visible] * 1e3, rtol=1e-3)
    assert {round(float(z), 3) for z in np.unique(picture["z_depth"][visible].round(3))} == set(distances)
    info = json.loads((tmp_path / "a/scene_gt_info.json").read_text())["0"]
    assert [one["px_count_valid"] for one in info] == [one["px_count_all"] for one in info]
    fixed = labels.Bop(tmp_path / "b", ["card"], depth_scale=max(distances) / 100)
    with pytest.raises(ValueError, match=r"depth_scale: depths reach .* hold at most .* is chosen so that they fit"):
        fixed.add(picture, labels.instances(scene, size=SIZE), scene.cameras[0])


def test_pixels_whose_depth_is_no_number_of_the_file_are_not_valid(tmp_path):
    """What is nearer than half a step is written as 0, which says that there is no depth."""
    scene = bilux.Scene()
    scene.add_mesh(CARD * 0.4 + [-0.15, 0, -0.4], HALVES, name="near", category="card")
    scene.add_mesh(CARD * 9 + [3, 0, -9], HALVES, name="far", category="card")
    scene.add_camera(bilux.cameras.perspective(position=(0, 0, 0), look_at=(0, 0, -1), fov=50))
    scene.add_light(bilux.lights.environment(radiance=1))
    picture = scene.render(size=SIZE, spp=1, integrator="path", labels=True)
    bop = labels.Bop(tmp_path, ["card"], depth_scale=1000)
    bop.add(picture, labels.instances(scene, size=SIZE), scene.cameras[0])
    bop.save()
    near, far = json.loads((tmp_path / "scene_gt_info.json").read_text())["0"]
    assert near["px_count_valid"] == 0 < near["px_count_all"] and far["px_count_valid"] == far["px_count_all"] > 0
