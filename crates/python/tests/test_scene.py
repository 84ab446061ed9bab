"""Scenes from arrays, and what can be changed in them."""

import copy
import pickle

import numpy as np
import pytest

import bilux


def view():
    return bilux.cameras.orthographic(position=(0.5, 0.5, 2), look_at=(0.5, 0.5, 0), up=(0, 1, 0), height=1)


def glow(emission, **keywords):
    """A black material that gives off light: its pixels have no noise."""
    return bilux.materials.diffuse(reflectance=0.0, emission=emission, **keywords)


def seen(square, **keywords):
    """The unit square from above."""
    scene = bilux.Scene()
    scene.add_mesh(*square, **keywords)
    scene.add_camera(view())
    return scene


def render(scene, **keywords):
    return scene.render(size=16, spp=16, integrator="path", tonemap="none", **keywords).pixels


def test_a_diffuse_square_reflects_its_reflectance(square):
    scene = seen(square, material=bilux.materials.diffuse(reflectance=(0.8, 0.2, 0.1)))
    scene.add_light(bilux.lights.environment(radiance=1.0))
    assert np.allclose(render(scene).mean((0, 1)), [0.8, 0.2, 0.1], atol=0.01)


def test_layouts_and_types_of_arrays_do_not_matter(square):
    vertices, triangles = square
    wanted = render(seen(square))
    readonly = vertices.astype(np.float64)
    readonly.flags.writeable = False
    strided = np.repeat(vertices, 2, axis=0)[::2]
    assert not strided.flags.c_contiguous
    for other in [readonly, np.asfortranarray(vertices), strided, vertices.tolist()]:
        for indices in [triangles.astype(np.uint32), triangles.astype(np.int16), triangles.tolist()]:
            assert np.array_equal(render(seen((other, indices))), wanted)


def test_instances_share_a_mesh_and_stand_where_they_are_put(square):
    places = np.tile(np.eye(4), (4, 1, 1))
    places[:, :3, :3] *= 0.5
    places[:, :2, 3] = [[0, 0], [0.5, 0], [0, 0.5], [0.5, 0.5]]
    scene = bilux.Scene()
    assert scene.add_instances(*square, places, material=glow(0.5)) == range(4)
    scene.add_camera(view())
    assert np.allclose(render(scene), 0.5)
    assert np.array_equal(scene.objects[3].transform, places[3])
    scene.set_transform(3, places[0])
    ids = scene.render(size=16, spp=1, aov=["ids"])["id"][..., 0]
    assert ids[2, 12] == 0 and ids[12, 2] in (1, 4)
    with pytest.raises(ValueError, match="add_instances"):
        scene.add_mesh(*square, transform=places)
    assert len(scene) == 4


def test_textures_come_from_arrays(square):
    uvs = square[0][:, :2]
    colours = np.array([[[1, 0, 0], [0, 1, 0]], [[0, 0, 1], [1, 1, 1]]], float)
    for pixels in [colours, (colours * 255).astype(np.uint8)]:
        texture = bilux.Texture(pixels, filter="nearest", wrap="clamp")
        picture = render(seen(square, uvs=uvs, material=glow(texture)), texture_filter="none")
        for row, column, at in [(0, 0, (4, 4)), (0, 1, (4, 12)), (1, 0, (12, 4)), (1, 1, (12, 12))]:
            assert np.allclose(picture[at], colours[row, column])
    grey = bilux.Texture(np.full((2, 2), 128, np.uint8))
    assert np.allclose(render(seen(square, uvs=uvs, material=glow(grey))), 0.2158605)
    number = bilux.Texture(np.full((2, 2), 128, np.uint8), data=True)
    assert np.allclose(render(seen(square, uvs=uvs, material=glow(number))), 128 / 255)


def test_textures_come_from_files(folder, square):
    bilux.Picture(np.full((4, 4, 3), 0.5)).save("grey.png")
    material = glow(bilux.Texture.read("grey.png"))
    assert np.allclose(render(seen(square, uvs=square[0][:, :2], material=material)), 0.5, atol=0.003)
    with pytest.raises(FileNotFoundError):
        bilux.Texture.read("none.png")


def test_anything_changes_between_renders(square):
    scene = seen(square, material=glow(0.5))
    scene.set_material(0, glow(0.25))
    assert np.allclose(render(scene), 0.25)
    scene.materials = [material.with_(emission=2.0) for material in scene.materials]
    assert np.allclose(render(scene), 2)
    scene.lights = [bilux.lights.environment(radiance=3.0)]
    other = scene.copy()
    other.remove(0)
    assert (len(scene), len(other), len(copy.deepcopy(scene))) == (1, 0, 1)
    scene.set_transform(0, np.diag([0.5, 0.5, 1, 1]))
    picture = render(scene)
    assert np.allclose(picture[12, 4], 2) and np.allclose(picture[4, 12], 3)
    scene.cameras = [view().with_(height=0.25)]
    assert np.allclose(render(scene)[8, 4], 2)
    for number in [5, -1, 10**30]:
        with pytest.raises(IndexError, match=f"no object {number}"):
            scene.set_material(number, bilux.materials.mirror())


def test_scenes_are_pickled_with_all_that_they_hold(folder, square):
    scene = bilux.load("model.glb")
    scene.add_mesh(*square, material=bilux.materials.diffuse(reflectance=bilux.Texture(np.eye(4))))
    back = pickle.loads(pickle.dumps(scene))
    assert type(back) is bilux.Scene and repr(back) == repr(scene) and back.materials[:-1] == scene.materials[:-1]
    sizes = [len(pickle.dumps(scene))]
    for index in range(3):
        scene.add_instances(*scene.mesh(0)[:2], np.tile(np.eye(4), (50, 1, 1)))
        sizes.append(len(pickle.dumps(scene)))
    assert sizes[2] - sizes[1] == sizes[3] - sizes[2] and np.array_equal(render(back), render(pickle.loads(pickle.dumps(back))))
    restore, (kind, document, blobs, time) = back.__reduce__()
    with pytest.raises(bilux.SceneError, match="another version of Bilux .form 9"):
        restore(kind, document[:12] + b"\x09" + document[13:], blobs, time)
    with pytest.raises(bilux.SceneError, match="damaged"):
        restore(kind, document[:-40] + bytes(40), blobs, time)
    with pytest.raises(bilux.SceneError, match="missing: send it too"):
        restore(kind, document, {}, time)


def test_what_is_in_a_scene_can_be_read(folder, square):
    scene = seen(square, name="tile", material=bilux.materials.diffuse(name="clay", reflectance=(0.8, 0.4, 0.2)))
    [tile] = scene.objects
    assert (tile.name, tile.vertices, tile.triangles, tile.material.name) == ("tile", 4, 2, "clay")
    assert tile.material.parameters["reflectance"] == pytest.approx([0.8, 0.4, 0.2])
    assert np.array_equal(scene.mesh(0).vertices, square[0]) and np.array_equal(scene.mesh(0).triangles, square[1])
    assert scene.mesh(0).normals is None and scene.bounds == [(0, 0, 0), (1, 1, 0)]
    assert scene.cameras[0].kind == "orthographic" and scene.lights == []
    scene.save("scene.toml")
    assert np.array_equal(render(bilux.load("scene.toml")), render(scene))


@pytest.mark.parametrize("maker", [bilux.materials, bilux.lights, bilux.cameras], ids=lambda maker: maker._name)
def test_every_row_of_the_tables_has_its_function_and_its_documentation(maker):
    for entry in maker():
        function = getattr(maker, entry.name)
        assert entry.summary[1:] in function.__doc__
        for parameter in entry.parameters:
            assert parameter.name in function.__doc__ and parameter.summary in function.__doc__
    with pytest.raises(AttributeError, match=entry.name):
        maker.nonsense
    assert entry.name in dir(maker) and entry.name in repr(maker)


def test_tables_list_what_there_is():
    assert {"auto", "path", "bdpt"} <= set(bilux.integrators)
    assert bilux.integrators["path"] in bilux.integrators()
    for table in [bilux.accels, bilux.aovs, bilux.denoisers, bilux.filters, bilux.formats, bilux.generators]:
        assert len(table) > 0 and all(entry.summary for entry in table())
    assert "spp" in [parameter.name for parameter in bilux.settings["render"].parameters]


def test_wrong_parameters_are_named():
    with pytest.raises(bilux.SceneError, match="did you mean 'reflectance'"):
        bilux.materials.diffuse(color=(1, 0, 0))
    with pytest.raises(ValueError, match=r"diffuse.reflectance is 3, but must be"):
        bilux.materials.diffuse(reflectance=3)
    with pytest.raises(TypeError, match="reflectance"):
        bilux.materials.diffuse(reflectance={"red": 1})
    with pytest.raises(ValueError, match="no built-in scene 'cornel'"):
        bilux.generate("cornel")
    with pytest.raises(TypeError, match="bilux.materials"):
        bilux.Scene().add_light(bilux.materials.mirror())


def test_specs_are_values():
    red = bilux.materials.diffuse(reflectance=(1, 0, 0), name="red")
    assert red == bilux.materials.diffuse(name="red", reflectance=(1, 0, 0)) != red.with_(reflectance=0.5)
    assert pickle.loads(pickle.dumps(red)) == red and "reflectance=(1, 0, 0)" in repr(red)
    numpy = bilux.materials.diffuse(reflectance=np.float32([1, 0, 0]), roughness=np.float64(0.5))
    mixed = bilux.materials.mix(a=red, b=numpy, amount=np.int64(1))
    scene = bilux.Scene()
    scene.add_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], material=mixed)
    assert len(scene.materials) == 3 and scene.materials[2].parameters["a"].name == "red"


@pytest.mark.parametrize(
    ("changes", "error", "words"),
    [
        (dict(vertices=np.ones((4, 2))), ValueError, r"vertices: its shape is \(4, 2\), but must be \(n, 3\)"),
        (dict(vertices=np.ones((3, 4))), ValueError, "vertices.T"),
        (dict(vertices=np.full((4, 3), np.nan)), ValueError, "vertices: row 0 is .*not finite"),
        (dict(vertices=np.full((4, 3), 1e300)), ValueError, "not finite as 32-bit"),
        (dict(vertices=np.full((4, 3), "x")), TypeError, "vertices: .*array of"),
        (dict(vertices=[[0, 0, 0], [1]]), TypeError, "vertices: "),
        (dict(triangles=[[0, 1, 4]]), ValueError, r"triangles: row 0 has the index 4, but there are 4 vertices: use 0 to 3"),
        (dict(triangles=[[0, 1, -1]]), ValueError, "index -1"),
        (dict(triangles=[[0.0, 1.0, 2.0]]), TypeError, r"triangles: .*astype\('int64'\)"),
        (dict(triangles=np.zeros((0, 3), int)), ValueError, "mesh without triangles"),
        (dict(triangles=[0, 1, 2]), ValueError, r"its shape is \(3,\)"),
        (dict(normals=np.ones((3, 3))), ValueError, "normals: there are 3 rows for 4 vertices"),
        (dict(uvs=np.ones((4, 3))), ValueError, "uvs: its shape"),
        (dict(transform=np.eye(3)), ValueError, r"\(3, 3\), but must be \(4, 4\)"),
        (dict(transform=np.zeros((4, 4))), ValueError, "matrix 0 is not affine"),
        (dict(transform=np.diag([1, 1, 0, 1])), ValueError, "has no inverse"),
        (dict(material="red"), TypeError, "material"),
    ],
)
def test_meshes_refuse_wrong_arrays(square, changes, error, words):
    keywords = dict(zip(["vertices", "triangles"], square)) | changes
    scene = bilux.Scene()
    with pytest.raises(error, match=words):
        scene.add_mesh(**keywords)
    assert len(scene) == 0


def test_an_empty_scene_says_so():
    with pytest.raises(TypeError, match="argument"):
        bilux.Scene("model.glb")
    with pytest.raises(bilux.SceneError, match="nothing|empty"):
        bilux.Scene().render(size=16, spp=1)


def test_a_picture_surrounds_a_scene(folder):
    sky = bilux.Picture(np.full((8, 16, 3), [0.25, 0.5, 1.0], np.float32))
    sky.save("sky.hdr")
    scene = bilux.Scene()
    scene.add_mesh([[0, 0, -9], [1, 0, -9], [0, 1, -9]], [[0, 1, 2]])
    scene.add_camera(bilux.cameras.perspective(position=(0, 0, 0), look_at=(0, 0, 1)))
    scene.surround("sky.hdr")
    assert np.allclose(render(scene), [0.25, 0.5, 1.0], rtol=0.01)
    scene.lights = [bilux.lights.environment(radiance=bilux.Texture(sky.pixels * 2))]
    assert np.allclose(render(scene), [0.5, 1.0, 2.0], rtol=0.01)
    with pytest.raises(FileNotFoundError, match="none.hdr: cannot open it"):
        scene.surround("none.hdr")
    with pytest.raises(bilux.PictureError, match="model.glb"):
        scene.surround("model.glb")


def test_a_layer_of_a_picture_surrounds_a_scene_or_is_a_texture(folder):
    glow = np.full((8, 16, 3), [0.75, 0.5, 0.25], np.float32)
    bilux.Picture(np.zeros((8, 16, 3)), layers={"glow": glow, "dim": glow / 4}).save("layers.exr")
    scene = bilux.Scene()
    scene.add_mesh([[0, 0, -9], [1, 0, -9], [0, 1, -9]], [[0, 1, 2]])
    scene.add_camera(bilux.cameras.perspective(position=(0, 0, 0), look_at=(0, 0, 1)))
    for layer, wanted in [("glow", glow), ("dim", glow / 4), (None, glow * 0)]:
        scene.surround("layers.exr", layer)
        np.testing.assert_allclose(render(scene), np.broadcast_to(wanted[0, 0], render(scene).shape), rtol=0.01)
        # A texture of the same layer, seen by light of the surroundings.
        scene.lights = [bilux.lights.environment(radiance=bilux.Texture.read("layers.exr", layer=layer))]
        np.testing.assert_allclose(render(scene), np.broadcast_to(wanted[0, 0], render(scene).shape), rtol=0.01)
    for wrong in (lambda: scene.surround("layers.exr", "glwo"), lambda: bilux.Texture.read("layers.exr", layer="glwo")):
        with pytest.raises(bilux.PictureError, match="no layer 'glwo'.*glow"):
            wrong()


def test_surroundings_that_need_no_file(folder):
    scene = bilux.load("model.glb")
    lamps = [light.kind for light in scene.lights]
    scene.surround("sky")
    assert [light.kind for light in scene.lights] == [*(kind for kind in lamps if kind != "environment"), "sky"]
    scene.surround("studio")
    assert scene.lights == []


def test_what_is_no_material_light_or_camera_is_refused_by_name(square):
    scene = bilux.Scene()
    with pytest.raises(TypeError, match="material: 'red' is no material: give one of bilux.materials"):
        scene.add_mesh(*square, material="red")
    number = scene.add_mesh(*square)
    with pytest.raises(TypeError, match="material: None is no material"):
        scene.set_material(number, None)
    with pytest.raises(TypeError, match="light: 3 is no light: give one of bilux.lights"):
        scene.add_light(3)
    with pytest.raises(TypeError, match="camera: .* is no camera"):
        scene.add_camera((0, 0, 1))


def test_files_that_are_not_there_are_named(folder):
    with pytest.raises(FileNotFoundError, match="nope.png"):
        bilux.Texture.read("nope.png")
    with pytest.raises(FileNotFoundError, match="nope.png"):
        bilux.read_picture("nope.png")
