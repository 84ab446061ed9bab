"""Files of all kinds: paths, bytes, and open files."""

import io
import pickle
import re
import struct
import subprocess
import sys
import zipfile
import zlib

import numpy as np
import pytest

import bilux

TRIANGLE = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


def test_scenes_from_paths_bytes_and_open_files(folder):
    data = (folder / "model.glb").read_bytes()
    wanted = bilux.load("model.glb").render(size=16, spp=1).pixels
    with zipfile.ZipFile(folder / "all.zip", "w") as archive:
        archive.write(folder / "model.glb", "inside/model.glb")
    with open("model.glb", "rb") as opened, open("model.glb", "rb", buffering=0) as unbuffered:
        with zipfile.ZipFile("all.zip").open("inside/model.glb") as zipped:
            array = np.frombuffer(data, np.uint8)
            for file in (folder / "model.glb", data, bytearray(data), memoryview(data), array, io.BytesIO(data),
                         opened, unbuffered, zipped):  # fmt: skip
                np.testing.assert_array_equal(bilux.load(file).render(size=16, spp=1).pixels, wanted)


def test_the_format_of_bytes(folder):
    assert len(bilux.load(TRIANGLE, format="obj")) == 1
    (folder / "model.dat").write_bytes(TRIANGLE)
    assert len(bilux.load("model.dat", format="obj")) == 1
    (folder / "named.obj").write_bytes(TRIANGLE)
    with open("named.obj", "rb") as file:
        assert len(bilux.load(file)) == 1
    with pytest.raises(bilux.FormatError, match=re.escape('such as format="obj"')):
        bilux.load(b"\x00\x01\x02 nothing that anybody knows")
    with pytest.raises(bilux.FormatError, match="objj.*did you mean 'obj'"):
        bilux.load(TRIANGLE, format="objj")
    with pytest.raises(bilux.FormatError, match=r"\(bytes\):4:1.*only 3"):
        bilux.load(TRIANGLE.replace(b"f 1 2 3", b"f 1 2 9"), format="obj")


def test_files_that_a_scene_refers_to(folder, tmp_path):
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "red.mtl").write_text("newmtl red\nKd 1 0 0\n")
    text = b"mtllib red.mtl\nusemtl red\n" + TRIANGLE
    (tmp_path / "sub" / "red.obj").write_bytes(text)

    def colour(scene):
        return scene.objects[0].material

    wanted = colour(bilux.load("sub/red.obj"))
    with open("sub/red.obj", "rb") as file:
        assert colour(bilux.load(file)) == wanted
    assert colour(bilux.load(text, format="obj", folder="sub")) == wanted
    with pytest.warns(bilux.SceneWarning, match="red.mtl"):
        assert colour(bilux.load(text, format="obj")) != wanted


def test_what_is_no_file_is_refused(folder):
    (folder / "text.obj").write_bytes(TRIANGLE)
    with open("text.obj") as file, pytest.raises(TypeError, match="binary mode"):
        bilux.load(file)
    with pytest.raises(TypeError, match="binary mode"):
        bilux.load(io.StringIO("v 0 0 0"))
    with pytest.raises(TypeError, match="give text.encode"):
        bilux.load(TRIANGLE.decode())
    with pytest.raises(TypeError, match="a list is no file"):
        bilux.load([1, 2])
    at_end = io.BytesIO(TRIANGLE)
    at_end.read()
    with pytest.raises(ValueError, match="seek"):
        bilux.load(at_end, format="obj")
    with pytest.raises(FileNotFoundError):
        bilux.load("missing.obj")
    with pytest.raises(FileNotFoundError):
        bilux.load("missing.dat", format="obj")

    class Raising:
        def read(self, _):
            raise OSError("the network is down")

    with pytest.raises(OSError, match="the network is down"):
        bilux.load(Raising())


def test_pictures_from_and_to_open_files(tmp_path):
    pixels = np.linspace(0, 1, 2 * 3 * 3).reshape(2, 3, 3).astype(np.float32)
    picture = bilux.Picture(pixels)
    for name in ("exr", "pfm", "hdr"):
        written = io.BytesIO()
        picture.save(written, format=name)
        picture.save(tmp_path / f"same.{name}")
        assert written.getvalue() == (tmp_path / f"same.{name}").read_bytes()
        with open(tmp_path / f"same.{name}", "rb") as file:
            np.testing.assert_array_equal(
                bilux.read_picture(file).pixels, bilux.read_picture(tmp_path / f"same.{name}").pixels
            )
        assert bilux.read_picture(written.getvalue()).pixels.shape == (2, 3, 3)
    with open(tmp_path / "named.png", "wb") as file:
        picture.save(file)
    assert bilux.read_picture((tmp_path / "named.png").read_bytes()).width == 3
    picture.save(tmp_path / "odd.dat", format="png")
    assert (tmp_path / "odd.dat").read_bytes() == (tmp_path / "named.png").read_bytes()
    with pytest.raises(ValueError, match='format="png"'):
        picture.save(io.BytesIO())
    with pytest.raises(TypeError, match="binary mode"):
        picture.save(io.StringIO(), format="png")
    with pytest.raises(bilux.PictureError, match="pngg"):
        picture.save(io.BytesIO(), format="pngg")
    with pytest.raises(bilux.PictureError):
        bilux.read_picture(b"no picture")


def test_what_is_odd_about_a_picture_is_a_warning(tmp_path):
    whole = io.BytesIO()
    bilux.Picture(np.random.default_rng(1).random((64, 64, 3))).save(whole, format="jpg")
    cut = tmp_path / "cut.jpg"
    cut.write_bytes(whole.getvalue()[: len(whole.getvalue()) // 2])
    scene = bilux.Scene()
    for read in (bilux.read_picture, bilux.Texture.read, scene.surround):
        with pytest.warns(bilux.SceneWarning, match="cut.jpg.*rows"):
            read(cut)
    with pytest.warns(bilux.SceneWarning, match=r"\(bytes\).*rows"):
        bilux.read_picture(cut.read_bytes())


@pytest.mark.parametrize("name", ["a.exr", "a.png"])
def test_textures_of_files_keep_their_alpha(tmp_path, name):
    """What is cut out of a picture is cut out of the one that a scene is written with."""
    alpha = np.array([[1, 0.25, 0], [0.5, 0.75, 1]])
    pixels = np.dstack([np.full((2, 3, 3), 0.5), alpha])
    bilux.Picture(pixels).save(tmp_path / name)
    material = bilux.materials.principled(base_color=bilux.Texture.read(tmp_path / name))
    scene = bilux.Scene()
    scene.add_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], uvs=[[0, 0], [1, 0], [0, 1]], material=material)
    (tmp_path / "written").mkdir()
    scene.save(tmp_path / "written/card.usda")
    (picture,) = (tmp_path / "written").glob("*.png")
    np.testing.assert_allclose(bilux.read_picture(picture).pixels[..., 3], alpha, atol=0.5 / 255)


def test_textures_from_open_files_and_as_pickles(tmp_path):
    texels = np.arange(4 * 5 * 4, dtype=np.uint8).reshape(4, 5, 4)
    light = np.linspace(0, 9, 4 * 5 * 3).reshape(4, 5, 3)
    for texture in (
        bilux.Texture(texels, wrap="mirror", filter="nearest", name="bytes"),
        bilux.Texture(light, data=True, wrap="clamp"),
    ):
        again = pickle.loads(pickle.dumps(texture))
        assert (again.shape, again.name) == (texture.shape, texture.name)
        pictures = [textured(each).render(size=24, spp=2, integrator="path").pixels for each in (texture, again)]
        np.testing.assert_array_equal(*pictures)
    # What a file says of its colours does not count for numbers.
    def png(chunks):
        rows = b"".join(b"\0" + struct.pack(">12H", *(1500 * i + 9000 * y for i in range(12))) for y in range(3))
        parts = [(b"IHDR", struct.pack(">IIBBBBB", 4, 3, 16, 2, 0, 0, 0)), *chunks, (b"IDAT", zlib.compress(rows)), (b"IEND", b"")]
        packed = [struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in parts]
        return b"\x89PNG\r\n\x1a\n" + b"".join(packed)

    straight = png([(b"gAMA", struct.pack(">I", 100_000))])
    shown = {
        (data, chunks): textured(bilux.Texture.read(chunks, data=data)).render(size=24, spp=2, integrator="path").pixels
        for data in (True, False)
        for chunks in (png([]), straight)
    }
    np.testing.assert_array_equal(shown[True, png([])], shown[True, straight])
    assert np.abs(shown[False, png([])] - shown[False, straight]).max() > 0.01
    bilux.Picture(light).save(tmp_path / "light.pfm")
    with open(tmp_path / "light.pfm", "rb") as file:
        assert bilux.Texture.read(file).shape == (4, 5)
    assert bilux.Texture.read((tmp_path / "light.pfm").read_bytes()).shape == (4, 5)
    # What has a texture in it pickles, too.
    material = bilux.materials.diffuse(reflectance=bilux.Texture(texels))
    assert pickle.loads(pickle.dumps(material)).parameters["reflectance"].shape == (4, 5)


def textured(texture):
    """A card with a texture, in a white world."""
    scene = bilux.Scene()
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    uvs = np.array([[-0.3, -0.3], [1.4, -0.3], [1.4, 1.4], [-0.3, 1.4]])
    material = bilux.materials.diffuse(reflectance=texture)
    scene.add_mesh(corners, [[0, 1, 2], [0, 2, 3]], uvs=uvs, material=material)
    scene.add_light(bilux.lights.environment(radiance=1))
    scene.add_camera(bilux.cameras.perspective(position=(0, 0, 3), look_at=(0, 0, 0)))
    return scene


def advised(error):
    """The limit of memory that a message advises."""
    found = re.search(r"\(max_memory=(\d+) << (\d+)\)$", str(error.value))
    assert found, error.value
    return int(found[1]) << int(found[2])


def test_the_advised_memory_suffices(folder):
    """What reading and rendering ask for, when they are refused, is enough the next time."""
    with pytest.raises(bilux.FormatError, match="reading this takes more") as error:
        bilux.load("model.glb", max_memory=1000)
    scene = bilux.load("model.glb", max_memory=advised(error))
    with pytest.raises(bilux.RenderError, match="would take about") as error:
        scene.render(size=512, spp=1, max_memory=1 << 20)
    most = advised(error)
    # The estimate itself: 200 bytes a pixel are 53 MB; the advice is no more than a few of those in addition.
    assert 512 * 512 * 200 <= most <= 512 * 512 * 200 + (30 << 20)
    assert scene.render(size=512, spp=1, max_memory=most).width == 512
    with pytest.raises(bilux.RenderError) as error:
        scene.render(size=4096, spp=1, max_memory=1 << 30)
    assert advised(error) >= 4096 * 4096 * 200 and advised(error) % (1 << 30) == 0
    with pytest.raises(bilux.RenderError, match="would take about.*is the limit"):
        scene.render(size=65_000, spp=1)


LITTLE_MEMORY = """
import resource, sys
import numpy as np, bilux
own = next(int(line.split()[1]) << 10 for line in open("/proc/self/status") if line.startswith("VmSize"))
limit = own + (int(sys.argv[1]) << 20)
resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
try:
    picture = bilux.generate("cornell").render(size=int(sys.argv[2]), spp=1, integrator="path")
except (bilux.RenderError, MemoryError) as error:
    print(error)
else:
    print("done", picture.width)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="limits are read as Linux says them")
def test_too_little_memory_is_an_exception():
    """Rust aborts where memory runs out: the interpreter would be gone, with all that it holds."""

    def answer(megabytes, size):
        command = [sys.executable, "-c", LITTLE_MEMORY, str(megabytes), str(size)]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, (megabytes, size, done.returncode, done.stderr)
        return done.stdout

    for megabytes in (150, 250, 400):
        assert "ulimit -v is the limit" in answer(megabytes, 3000), "a picture of 1.8 GB"
    assert answer(1500, 64) == "done 64\n"


def test_a_number_with_a_point_is_no_whole_number():
    with pytest.raises(bilux.SceneError, match="spp is 2.0, but must be a whole number"):
        bilux.generate("cornell").render(size=16, spp=2.0)


def test_messages_speak_of_arguments(folder):
    """No message of the package names an option of the command line or a key of a scene file."""
    scene = bilux.load("model.glb")
    messages = []

    def refused(call):
        with pytest.raises((bilux.Error, ValueError, TypeError, OSError)) as error:
            call()
        messages.append(str(error.value))

    for settings in (
        {"spp": -3}, {"sppp": 3}, {"size": "12"}, {"integrator": "pth"}, {"accel": "bhv"}, {"noise": -1.0},
        {"background": "sky.hdr"}, {"orbit": (1, 200)}, {"ground": "grass"}, {"tonemap": "agxx"}, {"camera": 7},
        {"denoise": "best"}, {"aov": ["groups"], "integrator": "sppm"}, {"aov": ["nodess"]}, {"up": "w"},
        {"up": "x", "front": "-x"}, {"crop": (0, 0, 600, 600)}, {"max_depth": 1 << 40}, {"filter": "lanczoss"},
        {"aov": ["interval"], "integrator": "whitted"}, {"time_limit": -1.0},
    ):  # fmt: skip
        refused(lambda settings=settings: scene.render(**{"size": 16} | settings))
    refused(lambda: bilux.Scene().render(size=16))
    refused(lambda: bilux.materials.diffuse(reflectance="red"))
    refused(lambda: bilux.load("missing.obj"))
    refused(lambda: bilux.load(io.BytesIO(b"\x89PNG\r\n\x1a\n")))
    (folder / "sub").mkdir()
    (folder / "sub" / "out.toml").write_text('[[model]]\nfile = "../model.glb"\n')
    refused(lambda: bilux.load("sub/out.toml"))
    for message in messages:
        assert "--" not in message and "`" not in message and "render." not in message, message
        assert "texture =" not in message and "os error" not in message, message
        assert "command line" not in message and "scene file" not in message, message
    assert messages[-1].endswith("(allow_outside=True)")
    assert messages[0].startswith("spp is -3") and messages[1].startswith("sppp: there is no setting 'sppp'")
    assert messages[2].startswith("size: '12' is not a size")
    for table in (bilux.aovs, bilux.settings, bilux.integrators, bilux.lights, bilux.materials, bilux.cameras):
        for entry in table():
            assert "--" not in entry.describe(), entry.describe()


def test_warnings_speak_of_arguments(square):
    scene = bilux.Scene()
    scene.add_mesh(*square)
    with pytest.warns(bilux.SceneWarning, match='^ground="mirror" is opaque.*use ground="shadow"'):
        picture = scene.render(size=16, spp=1, ground="mirror", background="transparent")
    assert picture.info["warnings"][0].startswith('ground="mirror"')


def test_files_that_give_a_few_bytes_at_a_time_are_read_to_their_end(folder):
    """`RawIOBase.read` may give fewer bytes than it is asked for, as sockets and pipes do; only none is the end."""

    class Slow(io.RawIOBase):
        def __init__(self, data):
            self.data = io.BytesIO(data)

        def read(self, size=-1):
            return self.data.read(min(size, 7) if size > 0 else size)

    assert len(bilux.load(Slow(TRIANGLE), format="obj")) == 1
    picture = io.BytesIO()
    bilux.Picture(np.full((5, 4, 3), 0.5)).save(picture, format="png")
    assert bilux.read_picture(Slow(picture.getvalue())).pixels.shape == (5, 4, 3)


def test_textures_of_numbers_are_not_decoded(tmp_path):
    """Of sRGB 188 of 255, the light is a half; as a number, it is 188 / 255."""
    bilux.Picture(np.full((2, 2, 3), 0.5)).save(tmp_path / "grey.png", bits=16)
    colour, number = (bilux.Texture.read(tmp_path / "grey.png", data=data) for data in (False, True))
    light = [textured(each).render(size=8, spp=64, integrator="path", denoise=False).pixels for each in (colour, number)]
    curve = 1.055 * 0.5 ** (1 / 2.4) - 0.055
    np.testing.assert_allclose(light[0][4, 4], 0.5, rtol=0.1)
    np.testing.assert_allclose(light[1][4, 4], curve, rtol=0.1)


def test_grids_are_computed_by_the_formulas_of_the_table(square, tmp_path):
    for name in bilux.densities:
        assert bilux.Grid.computed(name, resolution=8, to=(1, 1, 1)).name == name
    fog = bilux.Grid.computed("height", falloff=2, to=(4, 8, 4))
    assert fog.shape == (1, 128, 1) and fog.name == "height"
    scene = bilux.Scene()
    scene.add_mesh(*square, material=bilux.materials.interface(scattering=1, density=fog))
    scene.save(tmp_path / "fog.toml")
    text = (tmp_path / "fog.toml").read_text()
    assert 'density = { kind = "height", falloff = 2, to = [4, 8, 4] }' in text
    with pytest.raises(bilux.SceneError, match="no density 'hieght'; did you mean 'height'"):
        bilux.Grid.computed("hieght")
    with pytest.raises(bilux.SceneError, match="height.falloff is 0"):
        bilux.Grid.computed("height", falloff=0)
    with pytest.raises(bilux.SceneError, match="voxels are more than"):
        bilux.Grid.computed("cloud", resolution=1024)


def test_grids_are_read_from_files_and_bytes(tmp_path):
    values = np.arange(24, dtype=np.float32).reshape(2, 3, 4)
    np.save(tmp_path / "smoke.npy", values)
    for file in (tmp_path / "smoke.npy", (tmp_path / "smoke.npy").read_bytes()):
        grid = bilux.Grid.read(file)
        assert grid.shape == values.shape
        bilux.materials.interface(scattering=2, density=grid)
    with pytest.raises(bilux.FormatError, match="no file of grids"):
        bilux.Grid.read(b"nothing")
    np.save(tmp_path / "negative.npy", values - 1)
    with pytest.warns(match="1 voxels are negative"):
        bilux.Grid.read(tmp_path / "negative.npy")


def test_lamps_are_read_from_files_and_made_of_arrays(tmp_path):
    angles = np.linspace(0, 90, 91)
    candela = 1000 * np.cos(np.radians(angles)).clip(0)
    lamp = bilux.IntensityDistribution([0], angles, [candela], name="lambertian")
    assert lamp.lumens == pytest.approx(1000 * np.pi, rel=1e-4) and lamp.at(60, 123) == pytest.approx(500)
    scene = bilux.Scene()
    scene.add_light(bilux.lights.luminaire(distribution=lamp, position=(0, 2, 0)))
    scene.save(tmp_path / "lamp.toml")
    for file in (tmp_path / "lamp-lamp-1.ies", (tmp_path / "lamp-lamp-1.ies").read_bytes()):
        assert bilux.IntensityDistribution.read(file).lumens == pytest.approx(lamp.lumens)
    assert pickle.loads(pickle.dumps(lamp)).lumens == lamp.lumens
    with pytest.raises(ValueError, match=r"its shape is \(1, 91\), but must be .*\(2, 91\)"):
        bilux.IntensityDistribution([0, 90], angles, [candela])
    with pytest.raises(ValueError, match="polar angles do not ascend"):
        bilux.IntensityDistribution([0], angles[::-1], [candela])
    with pytest.raises(bilux.FormatError, match="no file of a lamp"):
        bilux.IntensityDistribution.read(b"nothing")
