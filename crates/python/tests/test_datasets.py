"""Data sets: what is written is read again, by our own readers here and by those of others where they are installed."""

import json
import struct
import zlib

import numpy as np
import pytest

import bilux
from bilux import labels
from test_labels import SIZE, K, camera, eye, scene_of


def png(path):
    """The numbers of a grey PNG without filters."""
    data, at, parts, head = path.read_bytes(), 8, b"", None
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        content = data[at + 8 : at + 8 + length]
        assert zlib.crc32(kind + content) == struct.unpack(">I", data[at + 8 + length : at + 12 + length])[0]
        head = struct.unpack(">IIBBBBB", content) if kind == b"IHDR" else head
        parts += content if kind == b"IDAT" else b""
        at += 12 + length
    width, height, bits, *kind = head
    assert kind == [0, 0, 0, 0]
    rows = np.frombuffer(zlib.decompress(parts), np.uint8).reshape(height, -1)
    assert not rows[:, 0].any()
    return np.ascontiguousarray(rows[:, 1:]).view(f">u{bits // 8}").astype(int)


@pytest.fixture(scope="module")
def seen():
    return labels.instances(scene_of(), size=SIZE, margin=24)


MASKS = [np.random.default_rng(number).random((17, 23)) < share for number, share in enumerate((0.1, 0.5, 0.9))]
MASKS += [np.zeros((3, 4), bool), np.ones((3, 4), bool), np.eye(6, dtype=bool)]


@pytest.mark.parametrize("mask", MASKS)
def test_runs_and_their_strings_say_the_mask(mask):
    counts = labels.runs(mask)
    assert sum(counts) == mask.size
    again = np.repeat(np.arange(len(counts)) % 2, counts).reshape(mask.shape, order="F")
    np.testing.assert_array_equal(again, mask)
    assert labels.decoded(labels.compressed(counts)) == counts


@pytest.mark.parametrize("categories", [["a", "b", "a"], {"a": 1, "b": 1}])
def test_categories_that_are_there_twice_are_refused(tmp_path, categories):
    for make in (labels.Coco, lambda given: labels.Bop(tmp_path, given), lambda given: labels.yolo(tmp_path / "a.txt", [], given)):
        with pytest.raises(ValueError, match="categories: the (name 'a'|number 1) is there twice"):
            make(categories)


def test_what_is_no_mask_is_refused():
    for function in (labels.runs, labels.polygons):
        with pytest.raises(ValueError, match=r"mask: its shape is \(2,\), but must be \(height, width\)"):
            function([1, 0])
    with pytest.raises(ValueError, match="objects: 2 is there twice in a group"):
        scene_of().amodal([[1, 2, 2]], size=SIZE)


def test_long_runs_and_broken_strings():
    counts = [0, 70000, 3, 65536 * 1024, 1, 5]
    assert labels.decoded(labels.compressed(counts)) == counts
    with pytest.raises(ValueError, match="cut off"):
        labels.decoded(labels.compressed([700000])[:-1])
    with pytest.raises(ValueError, match="not in masks of COCO"):
        labels.decoded("\x7f")


def test_pycocotools_reads_masks_as_we_do(seen):
    coco_mask = pytest.importorskip("pycocotools.mask")
    for mask in [*MASKS, *(one.masks.visible_mask for one in seen)]:
        theirs = coco_mask.encode(np.asfortranarray(mask, np.uint8))
        assert theirs["counts"].decode() == labels.compressed(labels.runs(mask))
        assert labels.decoded(theirs["counts"]) == labels.runs(mask)
        outlines = [outline for outline in labels.polygons(mask) if len(outline) >= 6]
        if not outlines:
            continue
        joined = coco_mask.decode(coco_mask.merge(coco_mask.frPyObjects(outlines, *mask.shape)))
        np.testing.assert_array_equal(joined.astype(bool), filled(mask))


def filled(mask):
    """The mask without its holes: what is not reached from outside by steps to the side, or diagonally between outlines."""
    outside = np.pad(~mask, 1, constant_values=True)
    reached = np.zeros_like(outside)
    reached[0] = True
    while True:
        grown = reached.copy()
        for axis in (0, 1):
            for step in (1, -1):
                grown |= np.roll(reached, step, axis)
        for down in (1, -1):
            for right in (1, -1):
                grown |= np.roll(reached, (down, right), (0, 1))
        grown &= outside
        if (grown == reached).all():
            return ~reached[1:-1, 1:-1]
        reached = grown


def test_outlines_of_one_mask_are_as_large_as_it_is():
    ring = np.ones((6, 7), bool)
    ring[2:4, 2:5] = False
    [outline] = labels.polygons(ring)
    assert outline == [0.0, 0.0, 7.0, 0.0, 7.0, 6.0, 0.0, 6.0]
    two = np.zeros((4, 6), bool)
    two[0, 0], two[1:, 2:5] = True, True
    first, second = labels.polygons(two)
    assert second == [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0] and max(first[::2]) == 5.0
    # Pixels that only touch at a corner stay apart.
    assert len(labels.polygons(np.eye(5, dtype=bool))) == 5 and labels.polygons(np.zeros((2, 2))) == []


def test_coco_holds_what_is_visible(seen, tmp_path):
    coco = labels.Coco(["moon", "star"])
    assert coco.add("a.png", seen) == 0 and coco.add("empty.png", [], size=SIZE) == 1
    coco.save(tmp_path / "instances.json")
    content = json.loads((tmp_path / "instances.json").read_text())
    assert [image["width"] for image in content["images"]] == [SIZE[0]] * 2
    picture = scene_of().render(size=SIZE, spp=1, integrator="path", aov=["ids", "category"])
    visible = [one for one in seen if one.masks.visible_pixels]
    assert len(content["annotations"]) == len(visible) > 3
    for label, one in zip(content["annotations"], visible, strict=True):
        counts = labels.decoded(label["segmentation"]["counts"])
        mask = np.repeat(np.arange(len(counts)) % 2, counts).reshape(SIZE[::-1], order="F").astype(bool)
        np.testing.assert_array_equal(mask, picture["ids"][..., 0] == one.masks.objects[0] + 1)
        assert set(picture["category"][mask]) == {label["category_id"]} and label["area"] == mask.sum()
        rows, columns = np.nonzero(mask)
        assert label["bbox"] == [columns.min(), rows.min(), np.ptp(columns) + 1, np.ptp(rows) + 1]
    with pytest.raises(ValueError, match="categories: 'star', of the object 'a', is none of moon"):
        labels.Coco(["moon"]).add("a.png", seen)
    with pytest.raises(ValueError, match="size: nothing is in the picture"):
        coco.add("b.png", [])


def test_pycocotools_reads_the_file(seen, tmp_path):
    reader = pytest.importorskip("pycocotools.coco")
    for polygons in (False, True):
        coco = labels.Coco({"moon": 4, "star": 7}, polygons=polygons)
        coco.add("a.png", seen)
        coco.save(tmp_path / "instances.json")
        theirs = reader.COCO(str(tmp_path / "instances.json"))
        assert sorted(theirs.getCatIds()) == [4, 7]
        visible = [one for one in seen if one.masks.visible_pixels]
        for label, one in zip(theirs.loadAnns(theirs.getAnnIds()), visible, strict=True):
            mask = one.masks.visible_mask[24:-24, 24:-24]
            read = theirs.annToMask(label).astype(bool)
            np.testing.assert_array_equal(read, filled(mask) if polygons else mask)


def test_depths_are_written_in_steps(tmp_path):
    depth = np.array([[0.0, 1.2345, 65.5351], [np.inf, np.nan, -2.0]])
    labels.write_depth(tmp_path / "depth.png", depth)
    np.testing.assert_array_equal(png(tmp_path / "depth.png"), [[0, 1234, 65535], [0, 0, 0]])
    with pytest.raises(ValueError, match=r"depths reach 65.6 m, but 16 bits of 1 mm hold at most 65.535 m"):
        labels.write_depth(tmp_path / "depth.png", [[1.0, 65.6]])
    with pytest.raises(ValueError, match="unit: 0 is no positive number"):
        labels.write_depth(tmp_path / "depth.png", depth, unit=0)
    labels.write_png(tmp_path / "mask.png", depth > 1)
    np.testing.assert_array_equal(png(tmp_path / "mask.png"), 255 * (depth > 1))
    with pytest.raises(ValueError, match="numbers: float64 of shape"):
        labels.write_png(tmp_path / "mask.png", depth)


@pytest.mark.parametrize("kind", ["opencv", "perspective"])
def test_matrices_of_cameras(kind):
    if kind == "opencv":
        wanted, pose = K, eye((1.0, 1.6, 5.0))
        ours = camera()
    else:
        pose = eye((3.0, -1.0, 2.0))
        ours = bilux.cameras.perspective(position=(3, -1, 2), look_at=(0, 0, 0), fov=50)
        focal = SIZE[1] / 2 / np.tan(np.radians(25))
        wanted = np.array([[focal, 0, SIZE[0] / 2 - 0.5], [0, focal, SIZE[1] / 2 - 0.5], [0, 0, 1]])
    found, world_to_camera = labels.matrices(ours, SIZE)
    np.testing.assert_allclose(found, wanted, atol=1e-3)
    np.testing.assert_allclose(world_to_camera, pose, atol=1e-5)
    points = np.random.default_rng(2).normal(size=(20, 3))
    seen = (points @ world_to_camera[:3, :3].T + world_to_camera[:3, 3]) @ found.T
    np.testing.assert_allclose(seen[:, :2] / seen[:, 2:], ours.project(points, size=SIZE), atol=1e-5)


def test_cameras_without_a_matrix_are_refused():
    bent = bilux.cameras.opencv(K, eye((0, 0, 5)), size=SIZE, distortion=[0.1, 0, 0, 0])
    with pytest.raises(ValueError, match="its pictures are distorted"):
        labels.matrices(bent, SIZE)
    with pytest.raises(ValueError, match="do not come from one point"):
        labels.matrices(bilux.cameras.orthographic(position=(0, 0, 5), look_at=(0, 0, 0)), SIZE)


def test_lines_of_yolo(seen, tmp_path):
    labels.yolo(tmp_path / "a.txt", seen, ["star", "moon"])
    visible = [one for one in seen if one.masks.visible_pixels]
    lines = np.array([line.split() for line in (tmp_path / "a.txt").read_text().splitlines()], float)
    assert [int(line[0]) for line in lines] == [["star", "moon"].index(one.category) for one in visible]
    for (_, x, y, across, down), one in zip(lines, visible, strict=True):
        box = np.array([x - across / 2, y - down / 2, across, down]) * (*SIZE, *SIZE)
        np.testing.assert_allclose(box, one.masks.visible_box, atol=1e-3)
    labels.yolo(tmp_path / "b.txt", seen, ["star", "moon"], segments=True)
    for line, one in zip((tmp_path / "b.txt").read_text().splitlines(), visible, strict=True):
        corners = np.array(line.split()[1:], float).reshape(-1, 2) * SIZE
        x, y, across, down = one.masks.visible_box
        assert (corners.min(0) >= [x - 1e-3, y - 1e-3]).all() and (corners.max(0) <= [x + across + 1e-3, y + down + 1e-3]).all()


def upright():
    """Boxes that stand before an upright camera, each turned about its height; one is cut off, one behind another."""
    scene = bilux.Scene()
    corners = np.array([[x, y, z] for x in (-0.4, 0.4) for y in (0, 0.5) for z in (-1, 1)], float)
    faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
    for x, z, angle in ((-1.6, 0, 0.3), (0.4, 0.5, 1.2), (0.7, -3.0, 0.0), (3.1, 0, -2.0)):
        place = np.eye(4)
        place[:3, :3] = [[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]]
        place[:3, 3] = x, -0.5, z
        scene.add_mesh(corners, faces, transform=place, category="Car")
    scene.add_camera(bilux.cameras.opencv(K, eye((0, 0.4, 7), (0, 0.4, 0)), size=SIZE))
    return scene


def test_lines_of_kitti_hold_boxes_in_space(tmp_path):
    scene = upright()
    seen = labels.instances(scene, size=SIZE, margin=60)
    labels.kitti(tmp_path / "000000.txt", seen, scene.cameras[0], SIZE)
    lines = [line.split() for line in (tmp_path / "000000.txt").read_text().splitlines()]
    assert len(lines) == 4 and all(len(line) == 15 and line[0] == "Car" for line in lines)
    truncated = [float(line[1]) for line in lines]
    assert truncated[:3] == [0, 0, 0] and 0.1 < truncated[3] < 0.9
    assert [int(line[2]) for line in lines] == [0, 0, 2, 0]
    for line, one in zip(lines, seen, strict=True):
        alpha, left, top, right, bottom, height, width, length, x, y, z, turn = map(float, line[3:])
        assert (height, width, length) == (0.5, 0.8, 2.0)
        np.testing.assert_allclose(np.sin(alpha - turn + np.arctan2(x, z)), 0, atol=1e-3)
        # The corners of the box, as KITTI's own tools place them.
        across, up, along = np.meshgrid([-1, 1], [0, -1], [-1, 1], indexing="ij")
        box = np.stack([along.ravel() * length / 2, up.ravel() * height, across.ravel() * width / 2])
        turned = np.array([[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]]) @ box
        pixels = K @ (turned + [[x], [y], [z]])
        pixels = pixels[:2] / pixels[2]
        column, row, wide, tall = one.masks.box
        np.testing.assert_allclose(pixels.min(1), [column, row], atol=1.01)
        np.testing.assert_allclose(pixels.max(1), [column + wide - 1, row + tall - 1], atol=1.01)
        assert (left, top) == one.masks.visible_box[:2] and right - left == one.masks.visible_box[2]
        assert bottom - top == one.masks.visible_box[3]
    # From above, boxes do not stand upright in the picture, which KITTI's lines cannot say.
    scene.cameras = [bilux.cameras.perspective(position=(0, 9, 0), look_at=(0, 0, 0), up=(0, 0, -1), fov=60)]
    with pytest.warns(UserWarning, match="leans by 90 degrees there"):
        labels.kitti(tmp_path / "b.txt", labels.instances(scene, size=SIZE), scene.cameras[0], SIZE)
    with pytest.raises(ValueError, match="forward: .* no direction along x or z"):
        labels.kitti(tmp_path / "a.txt", seen, scene.cameras[0], SIZE, forward=(0, 1, 0))


def test_boxes_of_kitti_are_as_large_as_scaled_objects(tmp_path):
    """Height along y of the mesh, length along its front, and the width across, each scaled on its own, before it is turned."""
    corners = np.array([[x, y, z] for x in (-0.4, 0.4) for y in (0, 0.5) for z in (-1, 1)], float)
    sine, cosine = np.sin(0.6), np.cos(0.6)
    place = np.eye(4)
    place[:3, :3] = np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]]) @ np.diag([0.5, 4, 1.5])
    scene = bilux.Scene()
    faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
    scene.add_mesh(corners, faces, transform=place, category="Car")
    scene.add_camera(bilux.cameras.opencv(K, eye((0, 0.4, 7), (0, 0.4, 0)), size=SIZE))
    seen = labels.instances(scene, size=SIZE)
    for forward, sides in (((0, 0, 1), [2.0, 0.4, 3.0]), ((-1, 0, 0), [2.0, 3.0, 0.4])):
        labels.kitti(tmp_path / "a.txt", seen, scene.cameras[0], SIZE, forward=forward)
        found = [float(word) for word in (tmp_path / "a.txt").read_text().split()[8:11]]
        assert found == pytest.approx(sides, abs=1e-4), forward


def rigid():
    """The scene with objects that are turned and moved, not scaled."""
    scene = scene_of()
    for number in range(1, len(scene)):
        place = scene.objects[number].transform
        place[:3, :3] /= np.cbrt(np.linalg.det(place[:3, :3]))
        scene.set_transform(number, place)
    return scene


@pytest.fixture(scope="module")
def bop(tmp_path_factory):
    folder = tmp_path_factory.mktemp("bop") / "train_pbr/000000"
    scene = rigid()
    writer = labels.Bop(folder, {"star": 3, "moon": 5}, depth_scale=0.25)
    for number in range(2):
        scene.set_transform(1, scene.objects[1 + number].transform)
        picture = scene.render(size=SIZE, spp=2, seed=number, integrator="path", labels=True)
        writer.add(picture, labels.instances(scene, size=SIZE, margin=96), camera())
    writer.save()
    return folder, scene, picture


def test_bop_has_poses_and_masks(bop):
    folder, scene, picture = bop
    [cameras, poses, info] = [json.loads((folder / f"scene_{name}.json").read_text()) for name in ("camera", "gt", "gt_info")]
    assert list(cameras) == list(poses) == list(info) == ["0", "1"] and len(poses["1"]) == len(info["1"]) == 6
    np.testing.assert_allclose(np.reshape(cameras["1"]["cam_K"], (3, 3)), K, atol=1e-3)
    depth = png(folder / "depth/000001.png") * cameras["1"]["depth_scale"]
    hit = np.isfinite(picture["z_depth"])
    np.testing.assert_allclose(depth[hit], picture["z_depth"][hit] * 1e3, atol=0.1251)
    assert not depth[~np.isfinite(picture["z_depth"])].any()
    whole = 0
    for number, (pose, known) in enumerate(zip(poses["1"], info["1"], strict=True), 1):
        assert pose["obj_id"] == {"star": 3, "moon": 5}[scene.objects[number].category]
        mask, visible = (png(folder / kind / f"000001_{number - 1:06}.png") > 0 for kind in ("mask", "mask_visib"))
        np.testing.assert_array_equal(visible, picture["ids"][..., 0] == number + 1)
        assert not (visible & ~mask).any() and visible.sum() == known["px_count_visib"]
        assert known["visib_fract"] == known["px_count_visib"] / known["px_count_all"]
        rows, columns = visible.nonzero()
        # As bop_toolkit_lib.misc.calc_2d_bbox has it: the width is that from the first column to the last.
        box = [columns.min(), rows.min(), np.ptp(columns), np.ptp(rows)] if len(rows) else [-1] * 4
        assert known["bbox_visib"] == box
        rows, columns = mask.nonzero()
        if len(rows) and rows.min() > 0 and columns.min() > 0 and rows.max() < SIZE[1] - 1 and columns.max() < SIZE[0] - 1:
            assert known["bbox_obj"] == [columns.min(), rows.min(), np.ptp(columns), np.ptp(rows)]
            whole += 1
        # A valid depth may be that of what hides the object.
        assert known["px_count_valid"] == np.count_nonzero(depth[mask])
        # The points of the visible surface, taken back into the model by the pose, are on its triangles.
        points = picture["position"][visible] @ eye((1.0, 1.6, 5.0))[:3, :3].T + eye((1.0, 1.6, 5.0))[:3, 3]
        rotation, shift = np.reshape(pose["cam_R_m2c"], (3, 3)), np.array(pose["cam_t_m2c"])
        models = (points * 1e3 - shift) @ rotation
        mesh = scene.mesh(number)
        near = bilux.Accel(mesh.vertices, mesh.triangles).nearest_point(models / 1e3)
        assert near.distance.max(initial=0) < 1e-5
    assert any(known["px_count_valid"] > known["px_count_visib"] > 0 for known in info["1"])
    assert whole > 0


def test_the_bop_toolkit_reads_it(bop):
    inout = pytest.importorskip("bop_toolkit_lib.inout")
    misc = pytest.importorskip("bop_toolkit_lib.misc")
    visibility = pytest.importorskip("bop_toolkit_lib.visibility")
    folder, _, picture = bop
    cameras = inout.load_scene_camera(str(folder / "scene_camera.json"))
    poses = inout.load_scene_gt(str(folder / "scene_gt.json"))
    info = inout.load_json(str(folder / "scene_gt_info.json"), keys_to_int=True)
    np.testing.assert_allclose(cameras[1]["cam_K"], K, atol=1e-3)
    assert poses[1][0]["cam_R_m2c"].shape == (3, 3) and poses[1][0]["cam_t_m2c"].shape == (3, 1)
    depth = inout.load_depth(str(folder / "depth/000001.png")) * cameras[1]["depth_scale"]
    distances = misc.depth_im_to_dist_im_fast(depth, cameras[1]["cam_K"])
    hit = depth > 0
    np.testing.assert_allclose(distances[hit], picture["depth"][hit] * 1e3, atol=0.2)
    for index, known in enumerate(info[1]):
        mask = inout.load_im(str(folder / f"mask/000001_{index:06}.png")) > 0
        visible = inout.load_im(str(folder / f"mask_visib/000001_{index:06}.png")) > 0
        own = np.where(mask, distances, 0)
        if visible.any():
            rows, columns = visible.nonzero()
            assert [int(side) for side in misc.calc_2d_bbox(columns, rows, SIZE)] == known["bbox_visib"]
            found = visibility.estimate_visib_mask_gt(distances, np.where(visible, own, 0), 15, visib_mode="bop19")
            np.testing.assert_array_equal(found, visible)


def test_bop_refuses_what_it_cannot_say(tmp_path):
    scene = scene_of()
    picture = scene.render(size=SIZE, spp=1, integrator="path", labels=True)
    writer = labels.Bop(tmp_path / "a", ["star", "moon"])
    with pytest.raises(ValueError, match="the transform of 'a' is no rotation"):
        writer.add(picture, labels.instances(scene, size=SIZE), camera())
    with pytest.raises(ValueError, match="no layer 'z_depth'"):
        writer.add(scene.render(size=SIZE, spp=1, integrator="path"), [], camera())
