"""Layers: every one that the table lists comes, under the name that was asked for, and with its channels in order."""

import numpy as np
import pytest

import bilux

SIZE = (24, 16)

# Two lamps and a ball before a wall, so that no layer is empty; it moves.
SCENE = """
[[model]]
shape = "sphere"
name = "ball"
material = "clay"
category = "toy"
keyframes = [{ time = 0, translate = [0, 0, 0] }, { time = 1, translate = [1.2, 0.6, 0] }]

[[light]]
name = "left"
kind = "point"
group = "key"
position = [-3, 3, 5]
intensity = [60, 0, 0]

[[light]]
name = "right"
kind = "point"
group = "fill"
position = [3, 3, 5]
intensity = [0, 0, 30]
"""

SHAPES = {
    "albedo": (3,), "normal": (3,), "camera_normal": (3,), "depth": (), "z_depth": (), "ids": (2,),
    "instance": (), "category": (), "primitive": (), "barycentric": (2,), "backward_motion": (2,), "occluded": (2,), "guides": (7,), "variance": (3,), "interval": (3,), "position": (3,),
    "uv": (2,), "motion": (2,), "crypto_object": (12,), "crypto_material": (12,), "crypto_instance": (12,),
    "direct": (3,), "indirect": (3,), "samples": (), "rays": (), "path_length": (), "nodes": (), "tests": (),
}  # fmt: skip
"""The channels of each layer; "groups" and "strategies" are stacks of pictures."""


@pytest.fixture(scope="module")
def scene(tmp_path_factory, wall):
    path = tmp_path_factory.mktemp("layers") / "scene.toml"
    path.write_text(wall + SCENE)
    return bilux.load(path)


def rendered(scene, *names, **settings):
    settings = {"size": SIZE, "spp": 4, "integrator": "path"} | settings
    return scene.render(aov=list(names), **settings)


@pytest.mark.parametrize("name", list(bilux.aovs))
def test_every_layer_of_the_table_comes_under_its_name(scene, name, tmp_path):
    picture = rendered(scene, name, integrator="bdpt" if name == "strategies" else "path", time=0.5, fps=2)
    assert name in picture and picture.info["warnings"] == []
    array = picture[name]
    if name in ("groups", "strategies"):
        assert array.shape[1:] == (SIZE[1], SIZE[0], 3)
        # What each light, or each strategy, gives adds up to the picture; whole steps of the film are rounded.
        np.testing.assert_allclose(array.sum(0), picture.pixels, rtol=2e-3, atol=1e-4)
    else:
        assert array.shape == (SIZE[1], SIZE[0], *SHAPES[name])
        assert name in picture.layers
    assert np.any(array != 0) or name == "indirect"
    picture.save(tmp_path / "all.exr")
    again = bilux.read_picture(tmp_path / "all.exr")
    assert again.layers == sorted(picture.layers) or set(again.layers) == set(picture.layers)
    np.testing.assert_array_equal(again[name], array)


def test_a_layer_that_the_table_does_not_list_is_refused(scene):
    with pytest.raises(bilux.SceneError, match="no layer 'albdo'; did you mean 'albedo'"):
        rendered(scene, "albdo")


def test_values_of_layers(scene):
    names = ("ids", "position", "depth", "uv", "motion", "samples", "groups", "direct", "indirect", "crypto_object")
    picture = rendered(scene, *names, time=0.0, fps=10)
    corner, middle = (0, 0), (SIZE[1] // 2, SIZE[0] // 2)
    # The wall is the first object and the ball the second; both are of the first material.
    assert picture["ids"][corner].tolist() == [1, 1] and picture["ids"][middle].tolist() == [2, 1]
    assert picture["id"] is picture["ids"] or np.array_equal(picture["id"], picture["ids"])
    assert picture["position"][corner][2] == pytest.approx(-2, abs=1e-4)
    assert 0.9 < picture["position"][middle][2] <= 1.0 + 1e-4
    assert np.all(picture["samples"] == 4)
    # The wall stands still; in a tenth of a second the ball moves by (0.12, 0.06). In the distance of the ball's front, 5,
    # a picture of 16 rows is 2 * 5 * tan(15 degrees) high.
    pixels = 16 / (2 * 5 * np.tan(np.radians(15)))
    assert np.abs(picture["motion"][corner]).max() < 1e-4
    np.testing.assert_allclose(picture["motion"][middle], [0.12 * pixels, 0.06 * pixels], rtol=0.02)
    # Red light is of one group, blue light of the other.
    assert set(picture.layers) >= {"group_key", "group_fill"}
    assert picture["group_key"][..., 2].max() == 0 and picture["group_fill"][..., 0].max() == 0
    np.testing.assert_allclose(
        picture["direct"] + picture["indirect"], picture.pixels, rtol=2e-3, atol=1e-4
    )
    # Pairs of an id and the part that it covers, the largest first.
    matte = picture["crypto_object"]
    np.testing.assert_allclose(matte[..., 1::2].sum(-1), 1, atol=1e-6)
    assert np.all(np.diff(matte[..., 1::2], axis=-1) <= 1e-6)
    assert matte[corner][0] != matte[middle][0]


def test_channels_come_back_in_their_order(scene, tmp_path):
    """EXR lists channels by the alphabet: alpha, blue, green, red; material, object."""
    names = ("ids", "normal", "position", "motion", "uv", "crypto_object", "albedo")
    picture = rendered(scene, *names, background="transparent")
    picture.save(tmp_path / "all.exr")
    again = bilux.read_picture(tmp_path / "all.exr")
    for name in names:
        assert again[name].dtype == picture[name].dtype
        np.testing.assert_array_equal(again[name], picture[name], err_msg=name)
    np.testing.assert_array_equal(again.pixels, picture.pixels)
    assert not np.array_equal(picture["ids"][..., 0], picture["ids"][..., 1])


def test_own_layers_by_the_names_of_the_table(tmp_path):
    own = {
        "ids": np.arange(12, dtype=np.uint32).reshape(2, 3, 2),
        "crypto_object": np.arange(48, dtype=np.float32).reshape(2, 3, 8),
        "uv": np.arange(12, dtype=np.float32).reshape(2, 3, 2),
        "mine": np.arange(18, dtype=np.float32).reshape(2, 3, 3),
    }
    bilux.Picture(np.zeros((2, 3, 3)), layers=own).save(tmp_path / "own.exr")
    again = bilux.read_picture(tmp_path / "own.exr")
    assert set(again.layers) == set(own)
    for name, array in own.items():
        np.testing.assert_array_equal(again[name], array, err_msg=name)


def test_a_stopped_render_says_which_layers_are_missing(scene):
    with pytest.warns(bilux.SceneWarning, match="layers are missing: direct$"):
        picture = scene.render(
            size=(200, 150),
            spp=1 << 20,
            integrator="path",
            aov=["position", "direct"],
            progress=lambda progress: progress.samples == 0,
        )
    # Labels need no samples: they are there.
    assert not picture.info["complete"] and "direct" not in picture and picture["position"].any()


def test_layers_that_an_integrator_cannot_give_are_refused(scene):
    with pytest.raises(bilux.SceneError, match="'path' has no separate strategies: choose one of bdpt"):
        rendered(scene, "strategies")


def test_layers_follow_an_edit(scene, square):
    """After an edit, layers are those of the scene as it is now, and so are those of the next picture."""
    edited = scene.copy()
    first = rendered(edited, "ids", "position", "crypto_object")
    card = edited.add_mesh(square[0] * 4 - [2, 2, 0] + [0, 0, 3], square[1], name="card")
    second = rendered(edited, "ids", "position", "crypto_object")
    middle = (SIZE[1] // 2, SIZE[0] // 2)
    assert second["ids"][middle][0] == card + 1 and first["ids"][middle][0] == 2
    assert second["position"][middle][2] == pytest.approx(3, abs=1e-4)
    assert second["crypto_object"][middle][0] != first["crypto_object"][middle][0]
    edited.set_transform(card, [[1, 0, 0, 50], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    third = rendered(edited, "ids", "position", "crypto_object")
    for name in ("ids", "position", "crypto_object"):
        np.testing.assert_array_equal(third[name][middle], first[name][middle], err_msg=name)


def test_motion_of_meshes_that_move_by_themselves(tmp_path):
    """A morph target moves a card by 1 m a second, evenly."""
    path = tmp_path / "card.gltf"
    path.write_text(morphing_card())
    scene = bilux.load(path)
    scene.add_camera(bilux.cameras.perspective(position=(0, 0, 5), look_at=(0, 0, 0), fov=30))
    picture = scene.render(size=16, spp=1, integrator="path", aov=["motion", "ids"], fps=10)
    seen = picture["ids"][..., 0] == 1
    pixels = 16 / (2 * 5 * np.tan(np.radians(15)))
    np.testing.assert_allclose(picture["motion"][seen], [[0.1 * pixels, 0]] * seen.sum(), atol=1e-3)
    # From bytes, too; but not once the file is forgotten.
    again = bilux.load(path.read_bytes(), format="gltf")
    again.cameras = scene.cameras
    np.testing.assert_array_equal(
        again.render(size=16, spp=1, integrator="path", aov=["motion"], fps=10)["motion"], picture["motion"]
    )
    import pickle

    with pytest.raises(bilux.SceneError, match="bilux.load"):
        pickle.loads(pickle.dumps(scene)).render(size=16, spp=1, aov=["motion"])


def morphing_card():
    """A glTF file with a square whose morph target is 1 m to the right, reached after a second."""
    import base64
    import json

    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], "<f4")
    shift = np.tile(np.array([1, 0, 0], "<f4"), (4, 1))
    arrays = [corners, shift, np.array([0, 1, 2, 0, 2, 3], "<u2"), np.array([0, 1], "<f4"), np.array([0, 1], "<f4")]
    kinds = [("VEC3", 5126, 4), ("VEC3", 5126, 4), ("SCALAR", 5123, 6), ("SCALAR", 5126, 2), ("SCALAR", 5126, 2)]
    data, views, accessors = b"", [], []
    for array, (kind, component, count) in zip(arrays, kinds):
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": array.nbytes})
        accessor = {"bufferView": len(accessors), "componentType": component, "count": count, "type": kind}
        if kind == "VEC3":
            accessor |= {"min": array.min(0).tolist(), "max": array.max(0).tolist()}
        elif component == 5126:
            accessor |= {"min": [0], "max": [1]}
        accessors.append(accessor)
        data += array.tobytes()
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    primitive = {"attributes": {"POSITION": 0}, "indices": 2, "targets": [{"POSITION": 1}]}
    return json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [primitive], "weights": [0]}],
        "animations": [{"samplers": [{"input": 3, "output": 4}],
                        "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}]}],
        "buffers": [{"uri": uri, "byteLength": len(data)}], "bufferViews": views, "accessors": accessors,
    })  # fmt: skip
