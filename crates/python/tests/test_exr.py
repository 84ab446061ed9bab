"""EXR files as compositors read them: by the OpenEXR and OpenImageIO packages, with ids by another implementation."""

import json
import struct

import numpy as np
import pytest

OpenEXR = pytest.importorskip("OpenEXR", reason="the package OpenEXR is not installed")
oiio = pytest.importorskip("OpenImageIO", reason="the package OpenImageIO is not installed")
mmh3 = pytest.importorskip("mmh3", reason="the package mmh3 is not installed")

WIDTH, HEIGHT = 64, 48

# A ball in front of a wall, which fills the picture; a second ball of the same name aside; two lights in one group.
SCENE = """
[[material]]
name = 'Glas "klar" \\ ✓'
kind = "diffuse"
reflectance = [0.2, 0.5, 0.7]

[[model]]
shape = "sphere"
name = 'Teekanne "groß" \\ 🫖'
material = 'Glas "klar" \\ ✓'
scale = 0.8

[[model]]
shape = "sphere"
name = 'Teekanne "groß" \\ 🫖'
material = "clay"
scale = 0.3
keyframes = [{ time = 0, translate = [1.4, 0, 0] }, { time = 1, translate = [1.4, 1.2, 0] }]

[[light]]
name = "left"
kind = "point"
group = "key lights"
position = [-3, 3, 5]
intensity = 60

[[light]]
name = "right"
kind = "point"
group = "key lights"
position = [3, 3, 5]
intensity = 30

[[light]]
name = "sky"
kind = "environment"
radiance = [0.1, 0.2, 0.4]
"""

LAYERS = (
    "albedo,normal,depth,ids,variance,position,uv,motion,crypto_object,crypto_material,crypto_instance,"
    "direct,indirect,groups,samples,rays,path_length,nodes,tests"
)
BALL = 'Teekanne "groß" \\ 🫖'


@pytest.fixture(scope="module")
def files(tmp_path_factory, command_line, wall):
    """A picture with all layers, and one of its pixels by other means."""
    folder = tmp_path_factory.mktemp("exr")
    scene = folder / "scene.toml"
    scene.write_text(wall + SCENE, encoding="utf-8")
    picture = folder / "all.exr"
    size = ["--size", f"{WIDTH}x{HEIGHT}", "--spp", "16", "-i", "path", "-q"]
    command_line("render", scene, "-o", picture, *size, "--aov", LAYERS)
    return folder


@pytest.fixture(scope="module")
def opened(files):
    """The header and the planes, by OpenEXR."""
    with OpenEXR.File(str(files / "all.exr"), separate_channels=True) as file:
        return dict(file.header()), {name: channel.pixels for name, channel in file.channels().items()}


def float_id(name):
    """The id of a name, as the specification says, by an implementation that is not ours."""
    hashed = mmh3.hash(name.encode("utf-8"), 0, signed=False)
    exponent = min(max(hashed >> 23 & 255, 1), 254)
    bits = hashed & 0x80000000 | exponent << 23 | hashed & 0x7FFFFF
    return struct.unpack("<f", struct.pack("<I", bits))[0], f"{bits:08x}"


def manifests(header):
    """The manifest of each matte, found by the keys of the header alone."""
    found = {}
    for key, value in header.items():
        if key.startswith("cryptomatte/") and key.endswith("/name"):
            stem = key[: -len("name")]
            assert stem.split("/")[1] == float_id(value)[1][:7]
            assert header[stem + "hash"] == "MurmurHash3_32"
            assert header[stem + "conversion"] == "uint32_to_float32"
            found[value] = json.loads(header[stem + "manifest"])
    return found


def coverage(planes, layer, pixel, name):
    """The part of a pixel that a name covers."""
    wanted, share = np.float32(float_id(name)[0]), 0.0
    for rank in range(3):
        for ident, part in (("red", "green"), ("blue", "alpha")):
            if planes[f"{layer}{rank:02}.{ident}"][pixel] == wanted:
                share += planes[f"{layer}{rank:02}.{part}"][pixel]
    return share


def test_names_types_and_windows(opened):
    header, planes = opened
    assert header["dataWindow"][1].tolist() == [WIDTH - 1, HEIGHT - 1]
    assert header["displayWindow"][1].tolist() == [WIDTH - 1, HEIGHT - 1]
    assert header["pixelAspectRatio"] == 1.0
    floats = (
        "R G B albedo.R normal.X normal.Z depth.Z position.X position.Y position.Z uv.U uv.V motion.X motion.Y "
        "direct.R indirect.B group_key_lights.G group_sky.G samples.count variance.R CryptoObject00.red"
    )
    for name in floats.split():
        assert planes[name].dtype == np.float32 and planes[name].shape == (HEIGHT, WIDTH), name
    assert planes["id.object"].dtype == np.uint32


def test_openimageio_reads_the_same(files, opened):
    _, planes = opened
    picture = oiio.ImageBuf(str(files / "all.exr"))
    spec = picture.spec()
    assert (spec.width, spec.height, spec.nchannels) == (WIDTH, HEIGHT, len(planes))
    assert set(spec.channelnames) == set(planes)
    pixels = picture.get_pixels(oiio.FLOAT)
    for name in ("R", "position.Y", "CryptoObject00.red", "CryptoInstance01.alpha"):
        plane = pixels[:, :, spec.channelnames.index(name)]
        assert plane.tobytes() == planes[name].tobytes(), name
    assert spec.getattribute("Software").startswith("Bilux ")
    assert json.loads(spec.getattribute("cryptomatte/" + float_id("CryptoObject")[1][:7] + "/manifest"))


def test_metadata_tell_how_the_picture_was_made(opened):
    header, _ = opened
    assert header["software"].startswith("Bilux ")
    assert len(header["bilux.fingerprint"]) == 32
    for option in ("integrator=path", f"size={WIDTH}x{HEIGHT}", "spp=16", "seed=0"):
        assert f"--set {option}" in header["bilux.settings"]
    assert header["bilux.group_key_lights"] == "key lights"
    primaries = np.array(header["chromaticities"]).ravel()
    np.testing.assert_allclose(primaries, [0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290], atol=1e-6)


def test_matrices_put_positions_where_they_are_seen(opened):
    header, planes = opened
    position = np.stack([planes[f"position.{axis}"] for axis in "XYZ"] + [np.ones((HEIGHT, WIDTH))], axis=-1)
    seen = position @ np.array(header["worldToNDC"]).reshape(4, 4)
    seen = seen[..., :2] / seen[..., 3:]
    columns, rows = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
    # Somewhere within the pixel.
    np.testing.assert_allclose(seen[..., 0] * WIDTH, columns + 0.5, atol=0.501)
    np.testing.assert_allclose(seen[..., 1] * HEIGHT, rows + 0.5, atol=0.501)
    depth = (position @ np.array(header["worldToCamera"]).reshape(4, 4))[..., 2]
    np.testing.assert_allclose(depth[HEIGHT // 2, WIDTH // 2], 5.2, atol=0.01)


def test_manifests_name_everything_once(opened):
    header, _ = opened
    found = manifests(header)
    assert set(found) == {"CryptoObject", "CryptoMaterial", "CryptoInstance"}
    assert set(found["CryptoObject"]) == {"wall", BALL}
    assert set(found["CryptoMaterial"]) == {"clay", 'Glas "klar" \\ ✓'}
    assert set(found["CryptoInstance"]) == {"wall#1", BALL + "#1", BALL + "#2"}
    for manifest in found.values():
        for name, ident in manifest.items():
            assert float_id(name)[1] == ident


def test_ids_name_what_is_there(opened):
    _, planes = opened
    middle, corner = (HEIGHT // 2, WIDTH // 2), (0, 0)
    assert coverage(planes, "CryptoObject", middle, BALL) == 1.0
    assert coverage(planes, "CryptoMaterial", middle, 'Glas "klar" \\ ✓') == 1.0
    assert coverage(planes, "CryptoInstance", middle, BALL + "#1") == 1.0
    assert coverage(planes, "CryptoObject", corner, "wall") == 1.0
    ids = [planes[f"CryptoObject00.{channel}"] for channel in ("red", "blue")]
    assert all(np.isfinite(plane).all() for plane in ids)
    # The ids of a pixel's edge: both, in their order.
    shares = planes["CryptoObject00.green"], planes["CryptoObject00.alpha"]
    mixed = shares[1] > 0
    assert mixed.sum() > 20 and (shares[0][mixed] >= shares[1][mixed]).all()


@pytest.mark.parametrize("layer", ["CryptoObject", "CryptoMaterial", "CryptoInstance"])
def test_coverage_adds_up_to_one(opened, layer):
    _, planes = opened
    total = sum(planes[f"{layer}{rank:02}.{part}"] for rank in range(3) for part in ("green", "alpha"))
    np.testing.assert_allclose(total, 1.0, atol=1e-6)


def test_parts_of_light_add_up_to_the_picture(opened):
    _, planes = opened
    for channel in "RGB":
        picture = planes[channel]
        for parts in (["direct", "indirect"], ["group_key_lights", "group_sky"]):
            total = sum(planes[f"{part}.{channel}"] for part in parts)
            np.testing.assert_allclose(total, picture, rtol=1e-4, atol=1e-5)
    assert planes["indirect.G"].mean() > 0 and planes["group_sky.B"].mean() > planes["group_sky.R"].mean()


def test_motion_is_in_pixels_upwards(opened):
    _, planes = opened
    wall, ball = (0, 0), (HEIGHT // 2, WIDTH // 2)
    assert planes["motion.X"][wall] == planes["motion.Y"][wall] == planes["motion.Y"][ball] == 0
    # 1.2 m upwards in a second, at 24 frames a second, 6 m away.
    expected = 1.2 / 24 / (2 * 6 * np.tan(np.radians(15))) * HEIGHT
    moving = planes["motion.Y"].max()
    assert expected * 0.95 < moving < expected * 1.1


def test_a_crop_has_its_place_in_the_picture(files, command_line, opened):
    x, y, width, height = 11, 7, 30, 29
    part, base = files / "part.exr", ["--size", f"{WIDTH}x{HEIGHT}", "--spp", "16", "-i", "path", "-q"]
    command_line("render", files / "scene.toml", "-o", part, *base, "--crop", f"{x},{y},{width},{height}", "--aov", "depth")
    with OpenEXR.File(str(part), separate_channels=True) as file:
        header, planes = dict(file.header()), {name: channel.pixels for name, channel in file.channels().items()}
    window = [corner.tolist() for corner in header["dataWindow"]]
    assert window == [[x, y], [x + width - 1, y + height - 1]]
    assert [corner.tolist() for corner in header["displayWindow"]] == [[0, 0], [WIDTH - 1, HEIGHT - 1]]
    _, whole = opened
    for name in ("R", "G", "B", "depth.Z"):
        assert planes[name].tobytes() == whole[name][y : y + height, x : x + width].tobytes(), name
    spec = oiio.ImageBuf(str(part)).spec()
    assert (spec.x, spec.y, spec.width, spec.height) == (x, y, width, height)
    assert (spec.full_x, spec.full_y, spec.full_width, spec.full_height) == (0, 0, WIDTH, HEIGHT)
    # Another program's file with such windows is read as the whole picture, and crops are merged to it.
    other = files / "other.exr"
    oiio.ImageBuf(str(part)).write(str(other))
    command_line("convert", other, "-o", files / "other.pfm", "-q")
    assert oiio.ImageBuf(str(files / "other.pfm")).spec().width == width
    rest = [(0, 0, WIDTH, y), (0, y, x, height), (x + width, y, WIDTH - x - width, height)]
    rest.append((0, y + height, WIDTH, HEIGHT - y - height))
    parts = [part]
    for i, crop in enumerate(rest):
        parts.append(files / f"rest{i}.exr")
        crop = ",".join(map(str, crop))
        command_line("render", files / "scene.toml", "-o", parts[-1], *base, "--crop", crop, "--aov", "depth")
    command_line("merge", *parts, "-o", files / "merged.exr", "-q")
    merged = oiio.ImageBuf(str(files / "merged.exr"))
    assert (merged.spec().x, merged.spec().width, merged.spec().height) == (0, WIDTH, HEIGHT)
    pixels = merged.get_pixels(oiio.FLOAT)
    for name in ("R", "G", "B", "depth.Z"):
        assert pixels[:, :, merged.spec().channelnames.index(name)].tobytes() == whole[name].tobytes(), name


def test_costs_are_counted(opened):
    _, planes = opened
    assert (planes["rays.mean"] >= 1).all() and (planes["path_length.mean"] >= 1).all()
    assert (planes["nodes.mean"] >= planes["rays.mean"]).all() and planes["tests.mean"].max() > 0


def test_samples_are_counted(opened):
    _, planes = opened
    assert (planes["samples.count"] == 16).all()
