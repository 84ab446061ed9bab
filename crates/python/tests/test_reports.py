"""What people reported about other libraries in Python, with inputs of our own and answers that are known otherwise."""

import io
import pickle
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest

import bilux


def ramp():
    """An array without symmetry."""
    return np.arange(5 * 7 * 3, dtype=np.float32).reshape(5, 7, 3) / 105


LAYOUTS = {
    "flipped": lambda a: np.flip(np.flip(a, 0).copy(), 0),
    "mirrored": lambda a: np.flip(np.flip(a, 1).copy(), 1),
    "channels reversed": lambda a: a[..., ::-1].copy()[..., ::-1],
    "channels first": lambda a: np.ascontiguousarray(a.transpose(2, 0, 1)).transpose(1, 2, 0),
    "Fortran order": lambda a: np.asfortranarray(a),
    "every second": lambda a: np.repeat(np.repeat(a, 2, 0), 2, 1)[::2, ::2],
    "read only": lambda a: np.frombuffer(a.tobytes(), a.dtype).reshape(a.shape),
    "big-endian": lambda a: a.astype(">f4"),
    "double": lambda a: a.astype(np.float64),
}


@pytest.mark.parametrize("layout", list(LAYOUTS))
def test_arrays_of_any_layout_are_what_they_show(layout):
    """mitsuba3#639 and #611: pictures from arrays with negative or permuted strides were something else."""
    array = LAYOUTS[layout](ramp())
    np.testing.assert_array_equal(array, ramp())
    np.testing.assert_array_equal(bilux.Picture(array).pixels, ramp())
    layered = bilux.Picture(ramp(), layers={"normal": array})
    written = io.BytesIO()
    layered.save(written, format="exr")
    np.testing.assert_array_equal(bilux.read_picture(written.getvalue())["normal"], ramp())
    scenes = [card(texture=bilux.Texture(texels, filter="nearest")) for texels in (array, ramp())]
    np.testing.assert_array_equal(*[scene.render(size=16, spp=1, integrator="path").pixels for scene in scenes])


@pytest.mark.parametrize("layout", list(LAYOUTS))
def test_meshes_and_rays_of_any_layout(layout):
    corners = LAYOUTS[layout](np.array([[[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]]], np.float32).transpose(1, 0, 2))
    vertices = corners[:, 0]
    triangles = np.asfortranarray([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    scene = bilux.Scene()
    scene.add_mesh(vertices, triangles)
    np.testing.assert_array_equal(scene.mesh(0).vertices, vertices)
    np.testing.assert_array_equal(scene.mesh(0).triangles, triangles)
    hits = bilux.Accel(vertices, triangles).closest(vertices.mean(0)[None] - [[0, 0, 9]], [[0, 0, 1]])
    assert hits.primitive[0] == 0 and hits.t[0] == pytest.approx(9 - 0.75)


def card(texture=None, z=0.0, scene=None):
    """A square, its texture upright."""
    scene = bilux.Scene() if scene is None else scene
    corners = np.array([[-1, -1, z], [1, -1, z], [1, 1, z], [-1, 1, z]])
    material = None if texture is None else bilux.materials.diffuse(reflectance=texture)
    uvs = [[0, 0], [1, 0], [1, 1], [0, 1]]
    scene.add_mesh(corners, [[0, 1, 2], [0, 2, 3]], uvs=uvs, material=material)
    if not scene.lights:
        scene.add_light(bilux.lights.environment(radiance=1))
        scene.add_camera(bilux.cameras.orthographic(position=(0, 0, 5), look_at=(0, 0, 0), height=2))
    return scene


def test_masks_of_meshes_that_collide_have_no_ids_between():
    """pyrender#269: where two meshes meet, the mask had mixtures of both colours."""
    scene = card()
    other = np.array([[-1, 0, -1], [1, 0, -1], [1, 0.7, 1], [-1, 0.7, 1]])
    scene.add_mesh(other, [[0, 1, 2], [0, 2, 3]])
    picture = scene.render(size=33, spp=16, integrator="path", aov=["ids", "crypto_object"])
    # The slanted square cuts the other one at y = 0.35: above that it is in front, seen up to y = 0.7.
    rows = 1 - (np.arange(33) + 0.5) / 33 * 2
    ids = picture["ids"][..., 0]
    assert set(np.unique(ids)) == {1, 2}
    clear = np.abs(rows - 0.35) > 0.07, np.abs(rows - 0.7) > 0.07
    wanted = np.where((rows > 0.35) & (rows < 0.7), 2, 1)
    sure = clear[0] & clear[1]
    assert np.all(ids[sure] == wanted[sure][:, None])
    names = np.unique(picture["crypto_object"][..., 0::2])
    assert len(names[names != 0]) == 2


def sum_of(scene):
    return scene.render(size=8, spp=1, integrator="path", threads=1).pixels.sum()


def test_pickled_scenes_work_in_other_processes():
    """raysect#226 and #239: scene graphs could not be pickled, or arrived empty."""
    scene = card(bilux.Texture(ramp()))
    wanted = sum_of(scene)
    assert wanted > 0 and sum_of(pickle.loads(pickle.dumps(scene))) == wanted
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        assert list(pool.map(sum_of, [scene, scene])) == [wanted] * 2


@pytest.mark.parametrize("distance", [1.0, 1e3, 1e6])
def test_hits_are_as_exact_as_the_format_allows(distance):
    """Open3D#5777: points of hits were 3e-5 off a plane of the size 1. Right: t = h / |cos|, to a few units of 2^-24 of it."""
    vertices = np.array([[-4, 0, -4], [4, 0, -4], [4, 0, 4], [-4, 0, 4]]) * distance
    accel = bilux.Accel(vertices, [[0, 1, 2], [0, 2, 3]])
    random = np.random.default_rng(1)
    origins = random.uniform(-1, 1, (500, 3)) * distance
    origins[:, 1] = distance * random.uniform(0.5, 1, 500)
    directions = random.uniform(-0.7, 0.7, (500, 3))
    directions[:, 1] = -1
    hits = accel.closest(origins, directions)
    o, d = origins.astype(np.float32).astype(float), directions.astype(np.float32).astype(float)
    np.testing.assert_allclose(hits.t, o[:, 1] / -d[:, 1], rtol=8 * 2.0**-24)


def test_vertices_that_no_triangle_uses_stay():
    """trimesh#2335: a mesh lost vertices when it was read, though it was asked to be left as it is."""
    text = b"o mesh\nv 1 1 1\nv 2 1 1\nv 1 2 1\nv 7 7 7\nf 1 2 3\n"
    mesh = bilux.load(text, format="obj").mesh(0)
    scene = bilux.Scene()
    scene.add_mesh([[1, 1, 1], [2, 1, 1], [1, 2, 1], [7, 7, 7]], [[0, 1, 2]])
    assert scene.mesh(0).vertices.shape == (4, 3), "what is given as arrays is kept as it is"
    assert mesh.triangles.tolist() == [[0, 1, 2]] and mesh.vertices[:3].tolist() == [[1, 1, 1], [2, 1, 1], [1, 2, 1]]


def test_a_picture_is_saved_with_the_channels_that_it_has():
    """matplotlib#11436: pictures with three channels came back with four."""
    for shape in ((4, 5), (4, 5, 3), (4, 5, 4)):
        for format in ("png", "exr"):
            file = io.BytesIO()
            bilux.Picture(np.full(shape, 0.5)).save(file, format=format)
            assert bilux.read_picture(file.getvalue()).pixels.shape == shape, (shape, format)


def test_a_transparent_background_stays_transparent(tmp_path):
    """BlenderProc#71: pictures with a transparent background were black once saved."""
    scene = bilux.Scene()
    scene.add_mesh([[-0.5, -0.5, 0], [0.5, -0.5, 0], [0.5, 0.5, 0], [-0.5, 0.5, 0]], [[0, 1, 2], [0, 2, 3]])
    scene.add_light(bilux.lights.environment(radiance=1))
    scene.add_camera(bilux.cameras.orthographic(position=(0, 0, 5), look_at=(0, 0, 0), height=2))
    picture = scene.render(size=16, spp=4, integrator="path", background="transparent")
    for name in ("a.png", "a.exr"):
        picture.save(tmp_path / name)
        alpha = bilux.read_picture(tmp_path / name).pixels[..., 3]
        assert alpha[0, 0] == 0 and alpha[8, 8] == 1, name


def test_numbers_of_numpy_are_numbers():
    """SIRF#351: sizes that numpy had computed were no integers."""
    scene = bilux.generate("cornell")
    assert scene.render(size=np.int64(16), spp=np.int32(1), threads=np.uint8(1), camera=np.int64(0)).width == 16
    picture = scene.render(size=np.array([16, 8]), spp=1, denoise=np.bool_(False), aov=None, seed=np.uint32(7))
    assert (picture.width, picture.height, picture.info["seed"]) == (16, 8, 7)
    for size in (16.5, (16.0, 8), "x", (1, 2, 3)):
        with pytest.raises((TypeError, bilux.SceneError), match="size"):
            scene.render(size=size, spp=1)
    with pytest.raises(TypeError, match="max_memory: 2.5 is no number of bytes"):
        scene.render(size=16, max_memory=2.5)


def test_bytes_are_colours_as_a_screen_shows_them():
    """pyopia#173, menpo#516: values from 0 to 255 were taken for fractions, and the picture was white."""
    byte = np.arange(256, dtype=np.uint8).reshape(16, 16)
    # IEC 61966-2-1.
    encoded = byte / 255
    linear = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    np.testing.assert_allclose(bilux.Picture(byte).pixels, linear, atol=2e-6)
    colours = np.stack([byte, byte.T, 255 - byte, np.full_like(byte, 51)], -1)
    for array in (byte, colours[..., :3], colours):
        file = io.BytesIO()
        bilux.Picture(array).save(file, format="png", tonemap="none")
        again = bilux.read_picture(file.getvalue())
        np.testing.assert_allclose(again.pixels, bilux.Picture(array).pixels, atol=2e-3)
    np.testing.assert_allclose(bilux.Picture(colours).pixels[..., 0], linear * 0.2, atol=2e-6)
    assert bilux.Picture(byte.astype(np.float32)).pixels.max() == 255, "other numbers are linear light"


def test_a_colour_can_be_a_background():
    """As tuples are colours everywhere else."""
    scene = bilux.Scene()
    scene.add_mesh([[-0.1, -0.1, 0], [0.1, -0.1, 0], [0, 0.1, 0]], [[0, 1, 2]])
    scene.add_light(bilux.lights.environment(radiance=1))
    scene.add_camera(bilux.cameras.orthographic(position=(0, 0, 5), look_at=(0, 0, 0), height=2))
    for way in ((1, 0, 0), np.array([1.0, 0.0, 0.0]), "1,0,0"):
        file = io.BytesIO()
        scene.render(size=8, spp=1, background=way).save(file, format="png", tonemap="none")
        assert bilux.read_picture(file.getvalue()).pixels[0, 0, :3].tolist() == [1, 0, 0]
