"""Labels: against rays that are traced on their own, against known poses, and with bugs that must be noticed."""

import pickle

import numpy as np
import pytest

import bilux

SIZE = (96, 72)
K = np.array([[90.0, 0, 44.3], [0, 95.0, 37.1], [0, 0, 1]])


def eye(position, target=(0, 0, 0)):
    """The matrix from the world to a camera at a place, with OpenCV's axes."""
    forward = np.subtract(target, position) / np.linalg.norm(np.subtract(target, position))
    right = np.cross(forward, [0, 1, 0])
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, :3] = [right, np.cross(forward, right), forward]
    pose[:3, 3] = -pose[:3, :3] @ position
    return pose


def camera(position=(1.0, 1.6, 5.0)):
    return bilux.cameras.opencv(K, eye(position), size=SIZE)


def turned(random, size=1.0):
    q, r = np.linalg.qr(random.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    place = np.eye(4)
    place[:3, :3] = q * np.linalg.det(q) * size
    place[:3, 3] = random.uniform(-1.2, 1.2, 3)
    return place


def blob(random, count=12):
    """A ragged closed strip of triangles: any triangles do."""
    vertices = random.normal(size=(count, 3))
    triangles = np.array([[i, (i + 1) % count, (i + 5) % count] for i in range(count)])
    return vertices, triangles


def scene_of(seed=3):
    """Some objects, of which some share meshes and one is a floor, and their places."""
    random = np.random.default_rng(seed)
    scene = bilux.Scene()
    scene.add_mesh([[-9, -2, -9], [-9, -2, 9], [9, -2, 9], [9, -2, -9]], [[0, 1, 2], [0, 2, 3]], name="floor")
    for kind in ("a", "b"):
        vertices, triangles = blob(random)
        places = np.stack([turned(random, 0.6) for _ in range(3)])
        scene.add_instances(vertices, triangles, places, name=kind, category={"a": "star", "b": "moon"}[kind])
    scene.add_camera(camera())
    scene.add_light(bilux.lights.environment(radiance=1.0))
    return scene


@pytest.fixture(scope="module")
def picture():
    return scene_of().render(size=SIZE, spp=1, integrator="path", labels=True)


def accelerated(scene):
    """All triangles of a scene as they are in the world, with the object and the row in its mesh of each."""
    corners, owners, rows = [], [], []
    for number, thing in enumerate(scene.objects):
        mesh = scene.mesh(number)
        placed = mesh.vertices @ thing.transform[:3, :3].T + thing.transform[:3, 3]
        corners.append(placed[mesh.triangles])
        owners.append(np.full(len(mesh.triangles), number))
        rows.append(np.arange(len(mesh.triangles)))
    corners = np.concatenate(corners)
    accel = bilux.Accel(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
    return accel, np.concatenate(owners), np.concatenate(rows)


def traced(scene, shift=0.0, upside_down=False):
    """What an independent ray through each pixel's centre meets: object, triangle, barycentric weights and distances."""
    accel, owners, rows = accelerated(scene)
    x, y = np.meshgrid(np.arange(SIZE[0]) + shift, np.arange(SIZE[1]) + shift)
    y = SIZE[1] - 1 - y if upside_down else y
    origins, directions = camera().rays(np.stack([x.ravel(), y.ravel()], 1))
    hits = accel.closest(origins, directions)
    hit, which = hits.primitive >= 0, hits.primitive
    objects = np.where(hit, owners[which] + 1, 0).reshape(SIZE[::-1])
    triangles = np.where(hit, rows[which] + 1, 0).reshape(SIZE[::-1])
    weights = np.stack([hits.u, hits.v], 1).reshape(*SIZE[::-1], 2)
    along = directions @ eye((1.0, 1.6, 5.0))[2, :3]
    return objects, triangles, weights, hits.t.reshape(SIZE[::-1]), (hits.t * along).reshape(SIZE[::-1]), hits.point


def test_labels_are_those_of_rays_traced_on_their_own(picture):
    objects, triangles, weights, t, z, points = traced(scene_of())
    assert len(np.unique(objects)) >= 6 and (objects == 0).sum() > 100
    np.testing.assert_array_equal(picture["ids"][..., 0], objects)
    np.testing.assert_array_equal(picture["primitive"], triangles)
    np.testing.assert_allclose(picture["barycentric"], weights, atol=2e-4)
    np.testing.assert_allclose(picture["depth"], t, rtol=1e-5)
    np.testing.assert_allclose(picture["z_depth"], z, rtol=1e-5)
    hit = objects > 0
    np.testing.assert_allclose(picture["position"][hit], points.reshape(*SIZE[::-1], 3)[hit], atol=2e-5)
    # Categories are numbered in their order, instances by their names.
    category, instance = np.array([0, 0, 2, 2, 2, 1, 1, 1]), np.array([0, 1, 1, 2, 3, 1, 2, 3])
    np.testing.assert_array_equal(picture["category"], category[objects])
    np.testing.assert_array_equal(picture["instance"], instance[objects])
    assert [picture.metadata[f"bilux.category.{i}"] for i in (1, 2)] == scene_of().categories == ["moon", "star"]


@pytest.mark.parametrize("bug", [{"shift": 0.5}, {"upside_down": True}])
def test_half_a_pixel_and_an_axis_upside_down_are_noticed(picture, bug):
    wrong = (traced(scene_of(), **bug)[0] != picture["ids"][..., 0]).sum()
    assert wrong > 50


def test_normals_face_the_camera_and_have_its_axes(picture):
    hit = picture["ids"][..., 0] > 0
    world, seen = picture["normal"][hit], picture["camera_normal"][hit]
    x, y = np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1]))
    _, directions = camera().rays(np.stack([x[hit], y[hit]], 1))
    assert ((world * directions).sum(1) < 1e-6).all()
    axes = eye((1.0, 1.6, 5.0))[:3, :3] * [[1], [-1], [-1]]
    np.testing.assert_allclose(seen, world @ axes.T, atol=1e-5)


def test_labels_depend_on_neither_seed_nor_samples(picture):
    again = scene_of().render(size=SIZE, spp=3, seed=9, integrator="path", labels=True)
    assert set(again.layers) == set(picture.layers)
    for layer in picture.layers:
        np.testing.assert_array_equal(again[layer], picture[layer])


def test_a_distance_for_a_z_depth_is_noticed(picture):
    *_, t, z, _ = traced(scene_of())
    hit = np.isfinite(t)
    assert (np.abs(picture["z_depth"][hit] - t[hit]) > 1e-3 * t[hit]).mean() > 0.9
    assert (np.abs(picture["z_depth"][hit] - z[hit]) > 1e-5 * z[hit]).mean() == 0


def moved():
    """The scene in the next frame: all but the floor elsewhere, and so is the camera."""
    scene, random = scene_of(), np.random.default_rng(11)
    for number in range(1, len(scene)):
        turn = np.eye(4)
        angle = random.uniform(-0.2, 0.2)
        turn[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        turn[:3, 3] = random.uniform(-0.2, 0.2, 3)
        scene.set_transform(number, turn @ scene.objects[number].transform)
    scene.cameras = [camera((1.3, 1.5, 5.1))]
    return scene


def flow_of(picture, here, there, cameras):
    """How far the points of a picture move, by the poses: in pixels, to the right and upwards."""
    objects, triangles = picture["ids"][..., 0].astype(int), picture["primitive"].astype(int)
    flow = np.zeros((*objects.shape, 2))
    for number in range(len(here)):
        shown = objects == number + 1
        mesh = here.mesh(number)
        corners = mesh.vertices.astype(float)[mesh.triangles[triangles[shown] - 1]]
        u, v = picture["barycentric"].astype(float)[shown].T[..., None]
        points = corners[:, 0] * (1 - u - v) + corners[:, 1] * u + corners[:, 2] * v
        ends = []
        for scene, seen_by in zip((here, there), cameras, strict=True):
            place = scene.objects[number].transform
            ends.append(seen_by.project(points @ place[:3, :3].T + place[:3, 3]))
        flow[shown] = (ends[1] - ends[0]) * [1, -1]
    return flow


def test_flow_is_that_of_known_poses():
    here, there = scene_of(), moved()
    cameras = (camera(), camera((1.3, 1.5, 5.1)))
    settings = {"size": SIZE, "spp": 1, "integrator": "path", "labels": True}
    picture = here.render(next=there, previous=there, **settings)
    expected = flow_of(picture, here, there, cameras)
    assert np.abs(expected).max() > 2
    np.testing.assert_allclose(picture["motion"], expected, atol=1e-4)
    np.testing.assert_allclose(picture["backward_motion"], expected, atol=1e-4)
    np.testing.assert_array_equal(picture["occluded"][..., 0], picture["occluded"][..., 1])
    # The other way around; one for the other is noticed.
    back = there.render(previous=here, **settings)
    returning = flow_of(back, there, here, cameras[::-1])
    np.testing.assert_allclose(back["backward_motion"], returning, atol=1e-4)
    assert np.abs(back["motion"] - returning).max() > 2 and not back["motion"].any()
    assert np.abs(picture["motion"] - expected * [1, -1]).max() > 2


def test_what_is_hidden_in_the_next_frame_is_what_other_rays_do_not_reach():
    here, there = scene_of(), moved()
    picture = here.render(size=SIZE, spp=1, integrator="path", labels=True, next=there)
    x, y = np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1]))
    target = np.stack([x, y], -1) + picture["motion"] * [1, -1]
    objects, triangles = picture["ids"][..., 0].astype(int), picture["primitive"].astype(int)
    inside = (target >= -0.5).all(-1) & (target < np.array(SIZE) - 0.5).all(-1)
    accel, owners, rows = accelerated(there)
    origins, directions = camera((1.3, 1.5, 5.1)).rays(target.reshape(-1, 2))
    hits = accel.closest(origins, directions)
    # How far the point itself is, by its triangle and weights.
    first = np.searchsorted(owners, np.arange(len(there)))
    own = np.where(objects > 0, first[objects - 1] + triangles - 1, 0).ravel()
    corners = np.concatenate([
        (there.mesh(n).vertices @ there.objects[n].transform[:3, :3].T + there.objects[n].transform[:3, 3])[there.mesh(n).triangles]
        for n in range(len(there))
    ])[own]  # fmt: skip
    u, v = picture["barycentric"].reshape(-1, 2).T[..., None]
    points = corners[:, 0] * (1 - u - v) + corners[:, 1] * u + corners[:, 2] * v
    distance = np.linalg.norm(points - origins, axis=1)
    hidden = ~inside.ravel() | (hits.t < distance * (1 - 1e-4)) & (hits.primitive != own)
    shown = (objects > 0).ravel()
    found = picture["occluded"][..., 0].ravel()
    np.testing.assert_array_equal(found[shown], hidden[shown])
    assert 100 < found.sum() < 0.5 * shown.sum() and not found[~shown].any() and (found[inside.ravel()] == 1).sum() > 50


def test_backward_flow_closes_with_forward_flow_when_the_camera_moves():
    here = bilux.Scene()
    here.add_mesh([[-9, -9, 0.5], [9, -9, -0.5], [9, 9, 0.2], [-9, 9, -0.3]], [[0, 1, 2]])
    here.add_mesh([[-9, -9, 0.5], [9, 9, 0.2], [-9, 9, -0.3]], [[0, 1, 2]])
    there = here.copy()
    here.add_camera(camera())
    there.add_camera(camera((1.1, 1.5, 4.9)))
    settings = {"size": SIZE, "spp": 1, "integrator": "path", "labels": True}
    forward = here.render(next=there, **settings)["motion"] * [1, -1]
    backward = there.render(previous=here, **settings)["backward_motion"] * [1, -1]
    x, y = np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1]))
    target = np.stack([x, y], -1) + forward
    inside = (target > 0).all(-1) & (target[..., 0] < SIZE[0] - 1) & (target[..., 1] < SIZE[1] - 1)
    low = np.floor(target[inside]).astype(int)
    share = target[inside] - low
    pick = lambda dx, dy: backward[low[:, 1] + dy, low[:, 0] + dx]  # noqa: E731
    right, down = share[:, :1], share[:, 1:]
    between = (pick(0, 0) * (1 - right) + pick(1, 0) * right) * (1 - down) + (pick(0, 1) * (1 - right) + pick(1, 1) * right) * down
    assert inside.sum() > 4000 and np.abs(forward).max() > 1
    np.testing.assert_allclose(between, -forward[inside], atol=0.02)


def test_flow_of_keyframes_has_both_directions():
    scene = scene_of()
    places = np.stack([scene.objects[1].transform] * 2)
    places[:, 0, 3] = [-0.5, 0.5]
    for number in range(len(scene)):
        scene.set_transform(number, scene.objects[number].transform)
    rigid = places.copy()
    scene.set_keyframes(1, [0, 1], rigid)
    picture = scene.render(size=SIZE, spp=1, integrator="path", labels=True, time=0.5, fps=10)
    shown = picture["ids"][..., 0] == 2
    assert shown.sum() > 50
    np.testing.assert_allclose(picture["motion"][shown], -picture["backward_motion"][shown], atol=0.3)
    assert np.abs(picture["motion"][shown]).max() > 0.5 and not picture["motion"][~shown].any()


def test_scenes_in_other_frames_have_the_same_objects():
    other = scene_of()
    other.remove(2)
    with pytest.raises(bilux.SceneError, match="next: this scene has other objects"):
        scene_of().render(size=8, spp=1, aov=["motion"], next=other)


def test_amodal_masks_are_those_of_each_object_alone():
    scene = scene_of()
    picture = scene.render(size=SIZE, spp=1, integrator="path", aov=["ids"])
    found = scene.amodal(size=SIZE)
    assert [one.objects for one in found] == [(number,) for number in range(len(scene))]
    hidden = 0
    for number, one in enumerate(found):
        alone = scene.copy()
        for other in range(len(scene)):
            alone.set_visibility(other, "full" if other == number else "hidden")
        mask = alone.render(size=SIZE, spp=1, integrator="path", aov=["ids"])["ids"][..., 0] == number + 1
        np.testing.assert_array_equal(one.mask, mask)
        np.testing.assert_array_equal(one.visible_mask, picture["ids"][..., 0] == number + 1)
        rows, columns = np.nonzero(mask)
        assert one.box == (columns.min(), rows.min(), np.ptp(columns) + 1, np.ptp(rows) + 1)
        assert one.pixels == mask.sum() and one.visible_fraction == one.visible_mask.sum() / mask.sum()
        hidden += one.visible_fraction < 0.9
    assert hidden >= 2


def test_amodal_masks_of_groups_and_beyond_the_picture():
    scene = scene_of()
    [both] = scene.amodal([[1, 4]], size=SIZE)
    one, other = scene.amodal([1, 4], size=SIZE)
    np.testing.assert_array_equal(both.mask, one.mask | other.mask)
    np.testing.assert_array_equal(both.visible_mask, one.visible_mask | other.visible_mask)
    [floor] = scene.amodal([0], size=SIZE, margin=20)
    assert floor.mask.shape == (SIZE[1] + 40, SIZE[0] + 40) and floor.box[0] == -20
    np.testing.assert_array_equal(floor.mask[20:-20, 20:-20], scene.amodal([0], size=SIZE)[0].mask)
    assert not floor.visible_mask[:20].any()
    with pytest.raises(bilux.SceneError, match="object 1 is in two groups"):
        scene.amodal([1, [1, 2]], size=8)
    with pytest.raises(IndexError, match="no object 99"):
        scene.amodal([99], size=8)
    with pytest.raises(bilux.Error, match="a side is 1 to"):
        scene.amodal([1], size=8, margin=1 << 20)


def test_what_the_camera_does_not_see_has_a_shadow_still():
    scene = bilux.generate("cornell")
    settings = {"size": 48, "spp": 32, "integrator": "path", "seed": 1}
    full = scene.render(aov=["ids"], **settings)
    scene.set_visibility(5, "no-camera")
    unseen = scene.render(aov=["ids", "crypto_object"], **settings)
    scene.set_visibility(5, "hidden")
    gone = scene.render(aov=["ids"], **settings)
    assert (full["ids"][..., 0] == 6).sum() > 50
    assert not (unseen["ids"][..., 0] == 6).any() and not (gone["ids"][..., 0] == 6).any()
    np.testing.assert_array_equal(unseen["ids"], gone["ids"])
    # It takes light from the others.
    assert unseen.pixels.mean() < 0.98 * gone.pixels.mean()
    for integrator in ("light", "bdpt"):
        same = scene.copy()
        same.set_visibility(5, "no-camera")
        other = same.render(**settings | {"integrator": integrator, "spp": 128})
        assert abs(other.pixels.mean() / unseen.pixels.mean() - 1) < 0.04, integrator
    with pytest.raises(bilux.SceneError, match="no visibility 'ful'; did you mean 'full'"):
        scene.set_visibility(5, "ful")


@pytest.mark.parametrize("name", ["scene.glb", "scene.toml"])
def test_categories_go_through_files_and_pickles(tmp_path, name):
    scene = scene_of()
    scene.save(tmp_path / name)
    again = bilux.load(tmp_path / name)
    assert [thing.category for thing in again.objects] == [thing.category for thing in scene.objects]
    scene.set_visibility(2, "no-camera")
    copy = pickle.loads(pickle.dumps(scene))
    assert [thing[-2:] for thing in copy.objects] == [thing[-2:] for thing in scene.objects]
    if name.endswith("toml"):
        scene.save(tmp_path / name)
        assert bilux.load(tmp_path / name).objects[2].visibility == "no-camera"
    else:
        assert any("which rays see" in lost for lost in scene.save(tmp_path / name))


def test_the_command_line_writes_all_labels(command_line, tmp_path):
    scene = scene_of()
    scene.save(tmp_path / "scene.toml")
    command_line("render", tmp_path / "scene.toml", "-o", tmp_path / "a.exr", "--size", "32x24", "--spp", "1", "-i", "path", "--labels")
    ours = scene.render(size=(32, 24), spp=1, integrator="path", labels=True)
    theirs = bilux.read_picture(tmp_path / "a.exr")
    assert set(theirs.layers) == set(ours.layers) and len(ours.layers) == 14
    np.testing.assert_array_equal(theirs["category"], ours["category"])
    assert theirs.metadata["bilux.category.2"] == "star"


def test_scenes_are_merged():
    room, thing = bilux.generate("cornell"), scene_of()
    before = len(room)
    place = np.eye(4)
    place[:3, 3] = (0, 1, 0)
    added = room.merge(thing, transform=place)
    assert added == range(before, before + len(thing)) and len(room.lights) == len(bilux.generate("cornell").lights)
    assert room.objects[added[1]].category == "star"
    np.testing.assert_allclose(room.objects[added[1]].transform, place @ thing.objects[1].transform, atol=1e-6)
    materials = len(room.materials)
    room.merge(thing, lights=True, cameras=True)
    assert len(room.materials) == materials, "what is there already is not added again"
    assert len(room.lights) == len(bilux.generate("cornell").lights) + 1 and len(room.cameras) == 2
    # A scene with textures looks the same, merged.
    grid = bilux.Texture(np.indices((8, 8)).sum(0)[..., None].repeat(3, 2) % 2.0)
    card = bilux.Scene()
    uvs = [[0, 0], [1, 0], [1, 1], [0, 1]]
    card.add_mesh(
        [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]], uvs=uvs,
        material=bilux.materials.diffuse(reflectance=grid),
    )  # fmt: skip
    alone = card.copy()
    other = bilux.Scene()
    other.add_mesh([[0, 0, 9], [1, 0, 9], [0, 1, 9]], [[0, 1, 2]], material=bilux.materials.diffuse(reflectance=bilux.Texture(np.zeros((2, 2, 3)))))
    other.merge(card)
    other.remove(0)
    for scene in (alone, other):
        scene.add_camera(bilux.cameras.perspective(position=(0, 0, 4), look_at=(0, 0, 0), fov=40))
        scene.add_light(bilux.lights.environment(radiance=1.0))
    settings = {"size": 24, "spp": 2, "integrator": "path"}
    np.testing.assert_array_equal(alone.render(**settings).pixels, other.render(**settings).pixels)


def test_colours_of_vertices():
    scene = bilux.Scene()
    corners, colours = [[-1, -1, 0], [1, -1, 0], [0, 1, 0]], np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1]])
    scene.add_mesh(corners, [[0, 1, 2]], colors=colours)
    np.testing.assert_array_equal(scene.mesh(0).colors, colours)
    scene.add_camera(bilux.cameras.perspective(position=(0, 0, 4), look_at=(0, 0, 0), fov=40))
    picture = scene.render(size=32, spp=8, integrator="path", aov=["albedo", "barycentric", "ids"])
    shown = picture["ids"][..., 0] > 0
    u, v = picture["barycentric"][shown].T
    inner = (u > 0.1) & (v > 0.1) & (u + v < 0.9)
    np.testing.assert_allclose(picture["albedo"][shown][inner], np.stack([1 - u - v, u, v], 1)[inner], atol=0.05)
    bytes_of = bilux.Scene()
    bytes_of.add_mesh(corners, [[0, 1, 2]], colors=np.full((3, 4), 188, np.uint8))
    np.testing.assert_allclose(bytes_of.mesh(0).colors, 0.5029, atol=1e-3)
    with pytest.raises(ValueError, match="colors: row 1 is .* from 0 to 1"):
        scene.add_mesh(corners, [[0, 1, 2]], colors=[[0, 0, 0], [2, 0, 0], [0, 0, 0]])
    with pytest.raises(ValueError, match="colors: there are 2 rows for 3 vertices"):
        scene.add_mesh(corners, [[0, 1, 2]], colors=[[0, 0, 0], [1, 0, 0]])


def test_surroundings_from_an_array():
    sky = np.zeros((16, 32, 3), np.float32)
    sky[:8] = [0.2, 0.4, 0.9]
    scene = bilux.Scene()
    scene.add_light(bilux.lights.environment(radiance=bilux.Texture(sky)))
    scene.add_camera(bilux.cameras.perspective(position=(0, 0, 4), look_at=(0, 0, 0), fov=40))
    scene.add_mesh([[0, 0, 9], [1, 0, 9], [0, 1, 9]], [[0, 1, 2]])
    picture = scene.render(size=16, spp=4, integrator="path").pixels
    np.testing.assert_allclose(picture[0, 8], [0.2, 0.4, 0.9], rtol=1e-2)
    assert not picture[-1].any()


def moving_card(time, of_file=None):
    """A card that is at x = 3 t and turns by a quarter in a second, and what is seen of it."""
    scene = bilux.Scene()
    if of_file:
        # Of no objects, which is said.
        with pytest.warns(bilux.SceneWarning):
            scene = bilux.load(f"[render]\ntime = {of_file}\n".encode(), format="toml")
    card = np.array([[-0.3, -0.2, 0], [0.3, -0.2, 0], [0.3, 0.2, 0], [-0.3, 0.2, 0]])
    moves = np.stack([np.eye(4), np.eye(4)])
    moves[1, :3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    moves[1, 0, 3] = 3
    number = scene.add_mesh(card, [[0, 1, 2], [0, 2, 3]], name="card", category="card")
    scene.set_keyframes(number, [0, 1], moves)
    # A second one, that stands still.
    scene.add_mesh(card + [0, -1, 0], [[0, 1, 2], [0, 2, 3]], name="still", category="card")
    scene.add_camera(bilux.cameras.opencv(K, eye((0.0, 0.0, 6.0)), size=SIZE))
    scene.add_light(bilux.lights.environment(radiance=1.0))
    return bilux.labels.instances(scene, size=SIZE, **({} if time is None else {"time": time}))


@pytest.mark.parametrize(
    ("time", "of_file", "moment"),
    [(None, None, 0.0), (0.0, None, 0.0), (0.25, None, 0.25), (0.5, 0.25, 0.5), (None, 0.25, 0.25)],
)
def test_places_are_of_the_moment_of_the_masks(time, of_file, moment):
    card, still = moving_card(time, of_file)
    assert np.allclose(card.transform[:3, 3], [3 * moment, 0, 0], atol=1e-5)
    angle = np.pi / 2 * moment
    assert np.allclose(card.transform[:2, :2], [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]], atol=1e-5)
    assert np.allclose(still.transform, np.eye(4))
    # The middle of what is seen is where the place is in the picture.
    left, top, width, height = card.masks.visible_box
    seen = np.array([left + (width - 1) / 2, top + (height - 1) / 2])
    to_camera = eye((0.0, 0.0, 6.0)) @ card.transform
    place = K @ to_camera[:3, 3]
    assert np.abs(seen - (place / place[2])[:2]).max() < 1
