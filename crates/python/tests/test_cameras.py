"""Cameras that were calibrated with OpenCV: its own functions are the reference."""

import warnings

import numpy as np
import pytest

import bilux

K = np.array([[510.0, 2.5, 331.2], [0, 498.0, 228.7], [0, 0, 1]])
SIZE = (640, 480)
LENSES = {
    "none": None,
    "four": [-0.21, 0.05, 0.001, -0.002],
    "five": [-0.28, 0.11, 0.0007, 0.0004, -0.018],
    "rational": [1.2, 0.4, 0.001, -0.0015, 0.02, 1.5, 0.7, 0.06],
    "prism": [0.1, -0.05, 0.001, -0.0015, 0.02, 0.05, 0.01, 0.002, 0.003, -0.001, 0.002, 0.0007],
}
FISHEYE = [-0.02, 0.005, -0.003, 0.0004]


def pose(seed=1):
    """A rotation and a translation."""
    random = np.random.default_rng(seed)
    axes, _ = np.linalg.qr(random.normal(size=(3, 3)))
    return axes * np.sign(np.linalg.det(axes)), random.normal(size=3) * 2


def points_seen(rotation, shift, count=200, spread=0.5):
    """Points of the world ahead of the camera."""
    random = np.random.default_rng(2)
    depth = random.uniform(1, 9, size=(count, 1))
    ahead = np.hstack([random.uniform(-spread, spread, size=(count, 2)) * depth, depth])
    return (ahead - shift) @ rotation


@pytest.mark.parametrize("lens", LENSES)
def test_points_are_seen_where_opencv_sees_them(lens):
    cv2 = pytest.importorskip("cv2", reason="needs OpenCV: pip install opencv-python-headless")
    rotation, shift = pose()
    square = K * [[1, 0, 1], [1, 1, 1], [1, 1, 1]]  # cv2.projectPoints knows no skew.
    camera = bilux.cameras.opencv(square, R=rotation, t=shift, distortion=LENSES[lens], size=SIZE)
    points = points_seen(rotation, shift)
    coefficients = None if LENSES[lens] is None else np.array(LENSES[lens])
    expected, _ = cv2.projectPoints(points, cv2.Rodrigues(rotation)[0], shift, square, coefficients)
    found = camera.project(points)
    assert np.abs(found - expected[:, 0]).max() < 1e-4
    # And the way back, which OpenCV iterates.
    pixels = expected[:, 0]
    origins, directions = camera.rays(pixels)
    assert np.allclose(origins, -rotation.T @ shift, atol=1e-12)
    criteria = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 200, 1e-14)
    zero = np.zeros(5) if coefficients is None else coefficients
    # Version 5 has one function where 4 had two.
    undistort = getattr(cv2, "undistortPointsIter", cv2.undistortPoints)
    plane = undistort(pixels[:, None], square, zero, R=None, P=None, criteria=criteria)[:, 0]
    towards = np.hstack([plane, np.ones((len(plane), 1))])
    towards = towards / np.linalg.norm(towards, axis=1, keepdims=True) @ rotation
    assert np.abs(directions - towards).max() < 1e-6


def test_fisheye_lenses_see_points_where_opencv_sees_them():
    cv2 = pytest.importorskip("cv2", reason="needs OpenCV: pip install opencv-python-headless")
    rotation, shift = pose(3)
    narrow = K * [[0.5, 0.5, 1], [1, 0.5, 1], [1, 1, 1]]
    camera = bilux.cameras.opencv_fisheye(narrow, R=rotation, t=shift, distortion=FISHEYE, size=SIZE)
    points = points_seen(rotation, shift, spread=1.5)
    expected, _ = cv2.fisheye.projectPoints(
        points[:, None], cv2.Rodrigues(rotation)[0], shift, narrow, np.array(FISHEYE), None, narrow[0, 1] / narrow[0, 0]
    )
    assert np.abs(camera.project(points) - expected[:, 0]).max() < 1e-4


@pytest.mark.parametrize("kind", ["opencv", "opencv_fisheye"])
def test_pixels_come_back(kind):
    lens = FISHEYE if kind == "opencv_fisheye" else LENSES["prism"]
    rotation, shift = pose(5)
    camera = getattr(bilux.cameras, kind)(K, R=rotation, t=shift, distortion=lens, size=SIZE)
    columns, rows = np.meshgrid(np.arange(0, 640, 7), np.arange(0, 480, 7))
    pixels = np.stack([columns.ravel(), rows.ravel()], axis=1)
    origins, directions = camera.rays(pixels)
    assert np.allclose(np.linalg.norm(directions, axis=1), 1)
    assert np.abs(camera.project(origins + directions * 3) - pixels).max() < 1e-4


def test_all_ways_to_say_a_pose_are_one():
    rotation, shift = pose(7)
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation, shift
    one = bilux.cameras.opencv(K, matrix, size=SIZE)
    assert one == bilux.cameras.opencv(K, matrix[:3], size=SIZE) == bilux.cameras.opencv(K, R=rotation, t=shift, size=SIZE)
    angle = np.arccos((np.trace(rotation) - 1) / 2)
    axis = np.array([rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]])
    turned = bilux.cameras.opencv(K, R=axis / (2 * np.sin(angle)) * angle, t=shift, size=SIZE)
    points = points_seen(rotation, shift)
    assert np.abs(turned.project(points) - one.project(points)).max() < 1e-6


def test_pictures_show_points_where_they_are_projected():
    """A small ball that glows: the middle of its light is the pixel of its middle."""
    rotation, shift = pose(9)
    camera = bilux.cameras.opencv(K, R=rotation, t=shift, distortion=LENSES["five"], size=SIZE)
    for ahead in ([0.4, -0.3, 1.2], [-0.5, 0.25, 1.1]):
        place = rotation.T @ (np.array(ahead) - shift)
        scene = bilux.Scene()
        scene.add_light(bilux.lights.sphere(position=tuple(place), radius=0.01, radiance=1))
        scene.add_mesh([[90, 90, 90], [91, 90, 90], [90, 91, 90]], [[0, 1, 2]])
        scene.add_camera(camera)
        picture = scene.render(spp=16, integrator="path", tonemap="none", denoise=False)
        assert (picture.width, picture.height) == SIZE
        light = picture.pixels[..., 1].astype(float)
        middle = [(light.sum(axis) * np.arange(light.shape[1 - axis])).sum() / light.sum() for axis in (0, 1)]
        assert np.abs(np.array(middle) - camera.project([place])[0]).max() < 0.1


def test_cameras_of_other_kinds_need_a_size():
    camera = bilux.cameras.perspective(position=(0, 0, 4), look_at=(0, 0, 0), fov=40)
    assert camera.project([[0, 0, 0]], size=(640, 480)) == pytest.approx(np.array([[319.5, 239.5]]))
    with pytest.raises(ValueError, match="size: give"):
        camera.project([[0, 0, 0]])
    with pytest.raises(TypeError, match="bilux.lights"):
        bilux.lights.point().project([[0, 0, 0]])
    assert np.isnan(camera.project([[0, 0, 9]], size=(64, 48))).all(), "behind the camera"
    with pytest.raises(ValueError, match="pixels: its shape"):
        camera.rays([[1, 2, 3]], size=(64, 48))


def turned(K):
    return np.asarray(K).T


MISTAKES = {
    "K: it must be upper triangular.*transpose": dict(K=turned(K)),
    "K: its shape": dict(K=np.eye(4)),
    "K: the focal lengths": dict(K=np.diag([-1.0, 1, 1])),
    "size: give": dict(size=None),
    r"size: .* is no width": dict(size=(640.5, 480)),
    "size: K has its principal point": dict(size=(300, 480)),
    "R: it is no rotation.*0.21 off.*scales by 1.1": dict(R=np.eye(3) * 1.1, t=[0, 0, 0]),
    "R: it mirrors": dict(R=np.diag([1.0, 1, -1]), t=[0, 0, 0]),
    "t: R and t belong together": dict(R=np.eye(3)),
    "t: it has 2 numbers": dict(R=np.eye(3), t=[0, 0]),
    "world_to_camera: give it, or R and t": dict(world_to_camera=np.eye(4), R=np.eye(3), t=[0, 0, 0]),
    "world_to_camera: its last row.*transpose": dict(
        world_to_camera=np.array([[1.0, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [1, 2, 3, 1]])
    ),
    "distortion: there are 3": dict(distortion=[0.1, 0.2, 0.3]),
    "distortion: the last two": dict(distortion=[0.0] * 12 + [0.1, 0]),
    "distortion: the camera's lens model ends .* folds over": dict(distortion=[-0.9, 0, 0, 0]),
    "not all of its numbers are finite": dict(distortion=[np.nan, 0, 0, 0]),
    "beyond: 'grey'": dict(beyond="grey"),
    "fx: the matrices say it": dict(fx=3),
}


@pytest.mark.parametrize("message", MISTAKES)
def test_mistakes_name_their_argument(message):
    with pytest.raises(ValueError, match=message):
        bilux.cameras.opencv(**(dict(K=K, size=SIZE) | MISTAKES[message]))


def test_pixels_beyond_a_fold_are_black_if_that_is_wanted():
    camera = bilux.cameras.opencv(K, distortion=[-0.9, 0, 0, 0], size=SIZE, beyond="black")
    _, directions = camera.rays([[0, 0], [320, 240]])
    assert np.isnan(directions[0]).all() and np.isfinite(directions[1]).all()
    scene = bilux.Scene()
    scene.add_mesh([[90, 90, 90], [91, 90, 90], [90, 91, 90]], [[0, 1, 2]])
    scene.add_light(bilux.lights.environment(radiance=1.0))
    scene.add_camera(camera)
    with pytest.warns(bilux.SceneWarning, match="folds over"):
        pixels = scene.render(size=(64, 48), spp=4, integrator="path", tonemap="none", denoise=False).pixels
    assert (pixels[0, 0] == 0).all() and np.allclose(pixels[24, 32], 1)


@pytest.mark.parametrize("extension", ["yml", "json"])
def test_what_opencv_writes_is_read(tmp_path, extension):
    cv2 = pytest.importorskip("cv2", reason="needs OpenCV: pip install opencv-python-headless")
    path = str(tmp_path / f"camera.{extension}")
    file = cv2.FileStorage(path, cv2.FILE_STORAGE_WRITE)
    file.write("image_width", SIZE[0])
    file.write("image_height", SIZE[1])
    file.write("camera_matrix", K)
    file.write("distortion_coefficients", np.array(LENSES["prism"])[:, None])
    file.release()
    [camera] = bilux.read_cameras(path)
    expected = bilux.cameras.opencv(K, distortion=LENSES["prism"], size=SIZE)
    # It does not say where it is: it looks from (0, 0, 5) at the origin.
    points = np.random.default_rng(3).uniform(-1, 1, size=(50, 3))
    assert np.allclose(camera.project(points + [0, 0, 2]), expected.project(points * [1, -1, -1] + [0, 0, 3]), atol=1e-6)
    scene = bilux.generate("cornell")
    scene.cameras = [camera]
    picture = scene.render(spp=1)
    assert (picture.width, picture.height) == SIZE


def test_files_without_cameras_are_errors(tmp_path):
    (tmp_path / "camera.yml").write_text("a: 1\n")
    with pytest.raises(bilux.FormatError, match="no camera matrix"):
        bilux.read_cameras(tmp_path / "camera.yml")
    with pytest.raises(FileNotFoundError):
        bilux.read_cameras(tmp_path / "missing.yml")


def test_a_pair_of_eyes_has_the_disparity_of_its_depth():
    eyes = {side: bilux.cameras.perspective(fov=50, stereo=side, eye_distance=0.2) for side in ("left", "right")}
    points = np.random.default_rng(4).uniform(-1, 1, size=(40, 3))
    seen = {side: eye.project(points, size=(600, 400)) for side, eye in eyes.items()}
    focal = 200 / np.tan(np.radians(25))
    disparity = focal * 0.2 / (5 - points[:, 2])
    assert np.allclose((seen["left"] - seen["right"])[:, 0], disparity, atol=1e-4)
    assert np.allclose((seen["left"] - seen["right"])[:, 1], 0, atol=1e-4)


def test_poses_the_other_way_round():
    rotation, shift = pose()
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation, shift
    ours = bilux.cameras.opencv(K, matrix, size=SIZE)
    other = bilux.cameras.opencv(K, camera_to_world=np.linalg.inv(matrix), size=SIZE)
    points = points_seen(rotation, shift)
    np.testing.assert_allclose(other.project(points), ours.project(points), atol=1e-9)
    with pytest.raises(ValueError, match="camera_to_world: give it, or world_to_camera"):
        bilux.cameras.opencv(K, matrix, camera_to_world=matrix, size=SIZE)
    with pytest.raises(ValueError, match=r"camera_to_world: its last row is .* transpose it: camera_to_world.T"):
        bilux.cameras.opencv(K, camera_to_world=matrix.T, size=SIZE)


def test_a_camera_that_sees_nothing_is_said():
    """Such as one whose pose goes from the camera to the world, where the other way is meant."""
    scene = bilux.Scene()
    scene.add_mesh([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], [[0, 1, 2]])
    to_camera = np.array([[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 5], [0, 0, 0, 1.0]])
    turn = np.eye(4)
    turn[:3, :3] = [[0, 0, -1], [0, 1, 0], [1, 0, 0]]
    for matrix, is_said in ((to_camera @ turn, False), (np.linalg.inv(to_camera @ turn), True)):
        scene.cameras = [bilux.cameras.opencv(K, matrix, size=SIZE)]
        warned = scene.render(size=(32, 24), spp=1, integrator="path").info["warnings"] if not is_said else None
        if is_said:
            with pytest.warns(bilux.SceneWarning, match="sees none of the scene's objects"):
                scene.render(size=(32, 24), spp=1, integrator="path")
        else:
            assert not [text for text in warned if "sees none" in text]


def test_what_moves_into_the_picture_is_seen():
    """However small it is there, at the moment that is rendered."""
    scene = bilux.Scene()
    number = scene.add_mesh([[-1e-3, -1e-3, 0], [1e-3, -1e-3, 0], [0, 1e-3, 0]], [[0, 1, 2]])
    places = np.tile(np.eye(4), (2, 1, 1))
    places[0, 0, 3], places[1, 0, 3] = 90.0, 0.03
    scene.set_keyframes(number, [0, 2], places)
    scene.cameras = [bilux.cameras.perspective(position=(0, 0, 5), look_at=(0, 0, 0))]
    for time, is_said in ((2.0, False), (0.0, True)):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            scene.render(size=(32, 24), spp=1, integrator="path", time=time)
        assert any("sees none" in str(one.message) for one in caught) == is_said, time


def test_a_camera_matrix_may_have_any_factor():
    """Such as one that was multiplied out from homogeneous points: K[2, 2] divides it."""
    camera, scaled = (bilux.cameras.opencv(matrix, R=pose()[0], t=pose()[1], size=SIZE) for matrix in (K, K * -2.5))
    points = points_seen(*pose())
    np.testing.assert_allclose(scaled.project(points), camera.project(points), atol=1e-9)


def test_a_camera_without_axes_is_refused_at_once():
    for kind in ("perspective", "orthographic", "fisheye", "panorama"):
        with pytest.raises(bilux.SceneError, match=r"straight down needs another up"):
            getattr(bilux.cameras, kind)(position=(0, 5, 0), look_at=(0, 0, 0))
        down = getattr(bilux.cameras, kind)(position=(0, 5, 0), look_at=(0, 0, 0), up=(0, 0, -1))
        assert down.with_(position=(0, 7, 0)).parameters["position"] == (0, 7, 0)


def test_colours_as_screens_show_them():
    scene = bilux.Scene()
    card = [[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]]
    scene.add_mesh(card, [[0, 1, 2], [0, 2, 3]], material=bilux.materials.diffuse(reflectance="#ff8040"))
    scene.add_light(bilux.lights.environment(radiance=1))
    scene.add_camera(bilux.cameras.perspective(position=(0, 0, 5), look_at=(0, 0, 0)))
    # By the curve of sRGB; radiance 1 all around is reflected with the albedo.
    found = scene.render(size=8, spp=64, integrator="path", max_depth=1).pixels.mean((0, 1))
    np.testing.assert_allclose(found, [1, 0.21586, 0.05127], rtol=0.02)
    with pytest.raises(bilux.SceneError, match="#rrggbb"):
        bilux.materials.diffuse(reflectance="#ff80")


def test_textures_beyond_the_range_are_said():
    scene = bilux.Scene()
    corners, texture = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], bilux.Texture(np.full((4, 4, 3), 200.0), name="paint")
    scene.add_mesh(corners, [[0, 1, 2]], uvs=[[0, 0], [1, 0], [0, 1]], material=bilux.materials.diffuse(reflectance=texture))
    with pytest.warns(bilux.SceneWarning, match="'paint' has 200 in it, but reflectance"):
        scene.render(size=8, spp=1)
