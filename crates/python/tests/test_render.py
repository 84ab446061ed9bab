"""Pictures: the same as those of the command line, and as numpy arrays."""

import base64
import copy
import json
import pathlib
import pickle
import warnings

import numpy as np
import pytest

import bilux


def test_a_saved_picture_has_the_bytes_of_the_command_line(folder, command_line):
    bilux.load("model.glb").render(size=(80, 60), spp=4).save("ours.png")
    command_line("render", "model.glb", "-o", "theirs.png", "--size", "80x60", "--spp", 4)
    assert (folder / "ours.png").read_bytes() == (folder / "theirs.png").read_bytes()


@pytest.mark.parametrize(
    ("kind", "arguments", "words"),
    [
        ("cornell", dict(spp=3, aov=["albedo", "normal", "depth", "ids"]), ["--spp", 3, "--aov", "albedo,normal,depth,ids"]),
        ("cornell", dict(spp=4, seed=7, integrator="bdpt", max_depth=3), ["--spp", 4, "--seed", 7, "-i", "bdpt", "--max-depth", 3]),
        ("trio", dict(spp=2, background="transparent"), ["--spp", 2, "--background", "transparent"]),
        ("trio", dict(spp=1, background="#336699"), ["--spp", 1, "--background", "#336699"]),
        ("trio", dict(integrator="whitted"), ["-i", "whitted"]),
        ("cornell", dict(noise=0.3, integrator="path"), ["--noise", 0.3, "-i", "path", "--denoise=auto"]),
    ],
)
@pytest.mark.parametrize("extension", ["exr", "png"])
def test_settings_mean_what_flags_mean(folder, command_line, kind, arguments, words, extension):
    bilux.generate(kind).save("scene.toml")
    # Limits of the call take precedence over samples of the scene.
    text = (folder / "scene.toml").read_text()
    (folder / "scene.toml").write_text(text.replace("[render]\n", "[render]\nspp = 1\n") if "[render]" in text else "[render]\nspp = 1\n" + text)
    bilux.load("scene.toml").render(size=(48, 40), **arguments).save(f"ours.{extension}")
    command_line("render", "scene.toml", "-o", f"theirs.{extension}", "--size", "48x40", *words)
    assert (folder / f"ours.{extension}").read_bytes() == (folder / f"theirs.{extension}").read_bytes()


def test_exposure_and_tone_curve_are_those_of_the_command_line(folder, command_line):
    picture = bilux.load("model.glb").render(size=48, spp=2, exposure="auto", tonemap="agx")
    picture.save("ours.png", bits=16)
    command_line("render", "model.glb", "-o", "theirs.png", "--size", "48x48", "--spp", 2, "--exposure", "auto", "--tonemap", "agx", "--bits", 16)
    assert (folder / "ours.png").read_bytes() == (folder / "theirs.png").read_bytes()


def test_threads_and_crops_change_nothing():
    scene = bilux.generate("cornell")
    whole = scene.render(size=(64, 48), spp=4)
    assert np.array_equal(whole.pixels, scene.render(size=(64, 48), spp=4, threads=1).pixels)
    crop = scene.render(size=(64, 48), spp=4, integrator="path", crop=(8, 16, 24, 12))
    assert np.array_equal(scene.render(size=(64, 48), spp=4, integrator="path").pixels[16:28, 8:32], crop.pixels)
    assert not np.array_equal(whole.pixels, scene.render(size=(64, 48), spp=4, seed=1).pixels)


def test_layers_are_arrays_and_never_copied():
    picture = bilux.generate("cornell").render(size=(40, 30), spp=2, aov=["depth", "ids", "albedo", "variance"])
    assert picture.pixels.shape == (30, 40, 3) and picture.pixels.dtype == np.float32
    assert picture["depth"].shape == (30, 40) and np.isfinite(picture["depth"]).any()
    assert picture["id"].dtype == np.uint32 and picture["id"].shape == (30, 40, 2)
    assert picture["albedo"].shape == (30, 40, 3) and picture["albedo"].max() <= 1
    assert set(picture.layers) >= {"depth", "ids", "albedo"} and "normal" not in picture

    def address(array):
        return array.__array_interface__["data"][0]

    assert address(picture.pixels) == address(picture.pixels) == address(np.asarray(picture))
    assert address(picture["depth"]) == address(picture["depth"])
    assert picture.pixels.flags.c_contiguous and picture.pixels.flags.writeable
    mine = np.ones((4, 5, 3), np.float32)
    assert address(bilux.Picture(mine).pixels) == address(mine)
    with pytest.raises(KeyError, match="no layer 'normal'"):
        picture["normal"]


def test_what_is_changed_in_an_array_is_saved(folder):
    picture = bilux.generate("cornell").render(size=16, spp=1)
    picture.pixels[:] = 0.25
    picture.pixels[3, 5] = [1, 0, 0]
    picture.save("changed.exr")
    read = bilux.read_picture("changed.exr").pixels
    assert np.array_equal(read, picture.pixels) and read[3, 5].tolist() == [1, 0, 0]


def test_pictures_are_written_read_and_compared(folder):
    ramp = np.linspace(0, 1, 32 * 16 * 3, dtype=np.float32).reshape(16, 32, 3)
    picture = bilux.Picture(ramp, layers={"depth": ramp[..., 0], "id": np.arange(512, dtype=np.uint32).reshape(16, 32)})
    picture.save("ramp.exr")
    read = bilux.read_picture("ramp.exr")
    assert np.array_equal(read.pixels, ramp) and np.array_equal(read["depth"], ramp[..., 0])
    assert read["id"].dtype == np.uint32 and read["id"][15, 31] == 511
    picture.save("ramp.png")
    shown = bilux.read_picture("ramp.png")
    assert np.abs(shown.pixels - ramp).max() < 0.005
    assert bilux.compare(read, picture)["rmse"] == 0 and bilux.compare(read, picture)["psnr"] == np.inf
    assert 0 < bilux.compare(shown, ramp)["flip"] < 0.01
    with pytest.raises(bilux.PictureError, match="32"):
        bilux.compare(ramp, ramp[:8])


def test_all_layers_survive_a_file_with_their_channels_in_order(folder):
    picture = bilux.generate("trio").render(size=16, spp=2, aov=["albedo", "normal", "ids"], background="transparent")
    picture.save("layers.exr")
    read = bilux.read_picture("layers.exr")
    assert np.array_equal(read.pixels, picture.pixels) and read.pixels.shape == (16, 16, 4)
    for layer in ["albedo", "normal", "id"]:
        assert np.array_equal(read[layer], picture[layer]), layer


def test_what_a_display_shows():
    grey = bilux.Picture(np.full((2, 3, 3), 0.5, np.float32))
    assert np.allclose(grey.tonemapped(), 0.7353569) and grey.tonemapped().shape == (2, 3, 3)
    assert np.allclose(grey.tonemapped(exposure=1), 1)
    assert grey.to_uint8().shape == (2, 3, 4) and grey.to_uint8()[0, 0].tolist() == [188, 188, 188, 255]
    assert grey._repr_png_().startswith(b"\x89PNG")
    with pytest.raises(bilux.PictureError, match="agx"):
        grey.tonemapped("agxx")
    for wrong in [dict(quality=0), dict(bits=7), dict(exposure=100), dict(exposure="bright")]:
        with pytest.raises((ValueError, TypeError), match=next(iter(wrong))):
            grey.save("never.png", **wrong)


def test_noise_ends_a_picture_and_it_is_denoised(folder):
    picture = bilux.generate("cornell").render(size=48, noise=0.2, integrator="path")
    assert picture.info["noise"] <= 0.2 and picture.info["denoiser"] and "noisy" in picture.layers
    noisy = bilux.generate("cornell").render(size=48, noise=0.2, integrator="path", denoise=False)
    assert np.array_equal(noisy.pixels, picture["noisy"]) and noisy.info["denoiser"] is None
    smooth = noisy.denoised("builtin")
    assert smooth.pixels.shape == noisy.pixels.shape and not np.array_equal(smooth.pixels, noisy.pixels)


def test_a_scene_says_what_it_does_not_know():
    scene = bilux.generate("cornell")
    with pytest.raises(bilux.SceneError, match="did you mean 'path'"):
        scene.render(integrator="pth")
    with pytest.raises(ValueError, match="roulette_depth"):
        scene.render(roulete_depth=3)
    with pytest.raises(ValueError, match="spp"):
        scene.render(spp=-1)
    with pytest.raises(ValueError, match="size"):
        scene.render(size=(0, 10))
    with pytest.raises(TypeError, match="size"):
        scene.render(size=(10, 10, 10))
    with pytest.raises(ValueError, match="layer 'depht'"):
        scene.render(spp=1, aov=["depht"])
    with pytest.raises(ValueError, match="crop"):
        scene.render(size=32, spp=1, crop=(30, 0, 8, 8))
    for crop in [(-1, 0, 8, 8), (0, 0, 1 << 40, 8)]:
        with pytest.raises(ValueError, match="crop"):
            scene.render(size=32, spp=1, crop=crop)
    with pytest.raises(TypeError, match="crop"):
        scene.render(size=32, spp=1, crop=(1, 2, 3))
    with pytest.raises(ValueError, match="seed: 1000"):
        scene.render(size=32, spp=1, seed=10**30)
    with pytest.raises(ValueError, match="max_memory"):
        scene.render(size=32, spp=1, max_memory=-1)
    with pytest.raises(bilux.RenderError, match="memory"):
        scene.render(size=4096, spp=1, max_memory=1000)
    with pytest.raises(TypeError, match="fast"):
        scene.render(fast=True, spp=3)
    with pytest.raises(TypeError, match="progress"):
        scene.render(spp=1, progress="yes")


def test_a_picture_shows_itself_in_a_notebook(folder):
    assert bilux.load("model.glb")._repr_png_().startswith(b"\x89PNG")
    assert bilux.Scene()._repr_png_() is None


@pytest.mark.parametrize(
    ("pixels", "error", "words"),
    [
        (np.ones(5), ValueError, r"pixels: its shape is \(5,\)"),
        (np.ones((0, 5)), ValueError, "pixels"),
        (np.ones((2, 2, 7)), ValueError, "1 to 4 channels"),
        (np.ones((2, 2), complex), TypeError, "complex128"),
        ("picture", TypeError, "pixels"),
    ],
)
def test_a_picture_refuses_other_arrays(pixels, error, words):
    with pytest.raises(error, match=words):
        bilux.Picture(pixels)


def test_files_that_are_missing_or_wrong(folder):
    with pytest.raises(FileNotFoundError):
        bilux.read_picture("nothing.png")
    with pytest.raises(FileNotFoundError):
        bilux.load("nothing.glb")
    (folder / "broken.png").write_bytes(b"\x89PNG\r\n\x1a\nrest")
    with pytest.raises(bilux.PictureError, match="broken.png"):
        bilux.read_picture("broken.png")
    (folder / "broken.glb").write_bytes(b"glTFrest")
    with pytest.raises(bilux.FormatError, match="broken.glb"):
        bilux.load("broken.glb")
    with pytest.raises(bilux.PictureError, match="picture.xyz"):
        bilux.Picture(np.ones((2, 2))).save("picture.xyz")
    with pytest.raises(bilux.FormatError, match="xyzzy"):
        bilux.generate("trio").save("model.xyzzy")


@pytest.mark.parametrize("integrator", ["auto", "path", "bdpt", "vcm", "sppm"])
def test_progressive_pictures_end_in_that_of_render(integrator):
    if integrator not in bilux.integrators:
        pytest.skip(f"there is no {integrator}")
    scene = bilux.generate("cornell")
    wanted = scene.render(size=24, spp=6, integrator=integrator).pixels
    pictures = list(scene.progressive(size=24, spp=6, integrator=integrator))
    assert [picture.info["spp"] for picture in pictures] == [1, 2, 4, 6]
    assert np.array_equal(pictures[-1].pixels, wanted)
    errors = [bilux.compare(picture, wanted)["rmse"] for picture in pictures]
    assert errors[0] > errors[1] > errors[2] > errors[3] == 0


def test_progressive_pictures_may_be_left():
    pictures = bilux.generate("cornell").progressive(size=24, spp=1 << 20)
    assert next(pictures).info["spp"] == 1 and next(pictures).info["spp"] == 2
    with pytest.raises(TypeError, match="leave the loop"):
        next(bilux.generate("cornell").progressive(noise=0.1))


def test_pictures_are_pickled_and_copied_with_all_that_they_hold(folder):
    picture = bilux.generate("trio").render(size=24, spp=1, aov=["ids", "depth"], background="#336699", exposure=0.5)
    for other in [pickle.loads(pickle.dumps(picture)), copy.deepcopy(picture)]:
        assert np.array_equal(other.pixels, picture.pixels) and np.array_equal(other["id"], picture["id"])
        assert (other.layers, other.info, other.metadata) == (picture.layers, picture.info, picture.metadata)
        for extension in ["png", "exr"]:
            picture.save(f"one.{extension}")
            other.save(f"other.{extension}")
            assert (folder / f"one.{extension}").read_bytes() == (folder / f"other.{extension}").read_bytes()
    values = list(picture.__reduce__()[1][0])
    with pytest.raises(ValueError, match="another version"):
        bilux.Picture._restored(tuple([values[0] + 1, *values[1:]]))


def test_a_format_without_alpha_warns(folder):
    picture = bilux.generate("trio").render(size=8, spp=1, background="transparent")
    picture.pixels[..., 3] = 0.5
    with pytest.warns(bilux.SceneWarning, match="does not support transparency"):
        picture.save("opaque.jpg")


def test_what_moves_is_shown_at_the_time_for_which_it_was_read(folder, command_line):
    write_moving_triangle(folder / "moving.gltf")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        still, moved = bilux.load("moving.gltf"), bilux.load("moving.gltf", time=1)
        picture = moved.render(size=32, spp=2)
        assert not np.array_equal(picture.pixels, still.render(size=32, spp=2).pixels)
        picture.save("ours.png")
        with pytest.raises(bilux.SceneError, match=r"time=0.5"):
            moved.render(size=32, spp=2, time=0.5)
        assert np.array_equal(moved.copy().render(size=32, spp=2).pixels, picture.pixels)
    command_line("render", "moving.gltf", "-o", "theirs.png", "--size", "32x32", "--spp", 2, "--at", 1, "-q")
    assert (folder / "ours.png").read_bytes() == (folder / "theirs.png").read_bytes()


def write_moving_triangle(path):
    """A glTF of two triangles, one of which moves by 3 m in 1 s."""
    parts = [np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.float32([0, 1]), np.float32([[0, 0, 0], [3, 0, 0]])]
    buffer = b"".join(part.tobytes() for part in parts)
    offsets = np.cumsum([0] + [part.nbytes for part in parts])
    kinds = ["VEC3", "SCALAR", "VEC3"]
    accessors = [
        {"bufferView": i, "componentType": 5126, "count": len(part), "type": kind}
        | ({"min": part.min(0).tolist(), "max": part.max(0).tolist()} if kind == "VEC3" else {"min": [0], "max": [1]})
        for i, (part, kind) in enumerate(zip(parts, kinds))
    ]
    views = [{"buffer": 0, "byteOffset": int(at), "byteLength": part.nbytes} for at, part in zip(offsets, parts)]
    channel = {"sampler": 0, "target": {"node": 0, "path": "translation"}}
    gltf = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0}, {"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "buffers": [{"byteLength": len(buffer), "uri": "data:application/octet-stream;base64," + base64.b64encode(buffer).decode()}],
        "bufferViews": views,
        "accessors": accessors,
        "animations": [{"samplers": [{"input": 1, "output": 2}], "channels": [channel]}],
    }
    path.write_text(json.dumps(gltf))


def test_a_turntable_is_that_of_the_command_line(folder, command_line, square):
    scene = bilux.Scene()
    scene.add_mesh(*square)
    scene.save("square.ply")
    command_line("render", "square.ply", "-o", "there-{frame}.png", "--turntable", 3, "--size", "24x20", "--spp", 2, "-i", "path")
    scene = bilux.load("square.ply")
    pictures = scene.turntable(3, size=(24, 20), spp=2, integrator="path")
    for number, picture in enumerate(pictures):
        picture.save("here.png")
        assert pathlib.Path("here.png").read_bytes() == pathlib.Path(f"there-000{number}.png").read_bytes()
        # What changes on the way is not in it.
        scene.lights = [bilux.lights.environment(radiance=number)]
    assert number == 2
    built = [picture.info["trees_built"] for picture in bilux.generate("trio").turntable(3, size=16, spp=1)]
    assert built[0] > 0 and built[1:] == [0, 0]
    with pytest.raises(ValueError, match="count"):
        scene.turntable(0)
    with pytest.raises(TypeError, match="crop"):
        scene.turntable(3, crop=(0, 0, 1, 1))
    with pytest.raises(bilux.SceneError, match="max_depth"):
        next(scene.turntable(3, max_dept=1))
    with pytest.raises(RuntimeError, match="enough"):
        next(scene.turntable(3, size=64, spp=10_000, progress=stop))


def stop(progress):
    raise RuntimeError("enough")


def test_a_crop_fits_into_the_height_whatever_the_width_is():
    scene = bilux.generate("cornell")
    settings = dict(size=(32, 16), spp=1, integrator="path")
    assert scene.render(crop=(24, 8, 8, 8), **settings).pixels.shape == (8, 8, 3)
    for crop in ((0, 10, 8, 8), (26, 0, 8, 8)):
        with pytest.raises(bilux.SceneError, match=r"crop: the window .* lie within the picture, which is 32x16"):
            scene.render(crop=crop, **settings)


def test_the_samples_that_were_asked_for_are_unknown_where_noise_decides():
    scene = bilux.generate("cornell")
    assert scene.render(size=8, spp=3, integrator="path").info["spp_asked"] == 3
    by_noise = scene.render(size=8, noise=0.5, integrator="path", denoise=False).info
    assert by_noise["spp_asked"] is None and by_noise["spp"] > 0
