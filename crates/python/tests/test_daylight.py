"""Light that points receive, skies, and daylight over a year: against closed forms, and against Radiance where it is installed."""

import datetime
import doctest
import importlib.util
import inspect
import math
import os
import pathlib
import subprocess

import numpy as np
import pytest

import bilux
from bilux import daylight

HEADER = [
    "LOCATION,London,-,GBR,made up,000000,51.15,-0.18,0.0,62.0",
    "DESIGN CONDITIONS,0",
    "TYPICAL/EXTREME PERIODS,0",
    "GROUND TEMPERATURES,0",
    "HOLIDAYS/DAYLIGHT SAVINGS,No,0,0,0",
    "COMMENTS 1,",
    "COMMENTS 2,",
    "DATA PERIODS,1,1,Data,Sunday,1/1,12/31",
]


def records():
    """A year of weather: overcast, hazy and clear days in turn."""
    begin = datetime.datetime(2019, 1, 1)
    lines = []
    for hour in range(8760):
        at = begin + datetime.timedelta(hours=hour)
        up = max(0.0, math.sin(math.pi * (at.hour - 5) / 14)) * (0.55 - 0.35 * math.cos(2 * math.pi * hour / 8760))
        direct = [0, 300, 800][at.day % 3] * (up > 0.1)
        diffuse = [220, 180, 90][at.day % 3] * up
        light = ["9999"] * 4 + [f"{direct:.0f}", f"{diffuse:.0f}"]
        fields = [at.year, at.month, at.day, at.hour + 1, 60, "?9", 10.0, 6.0, 70, 101000, *light, 0, 0, 0, 0, 180, 3.0]
        lines.append(",".join(map(str, fields)))
    return lines


RECORDS = records()


def epw(folder, lines=None, header=None):
    path = folder / "london.epw"
    path.write_text("\n".join((header or HEADER) + (lines or RECORDS)) + "\n")
    return path


@pytest.mark.parametrize("name", [name for name, thing in vars(daylight).items() if not name.startswith("_") and inspect.getmodule(thing) is daylight])
def test_everything_is_documented_and_its_examples_run(name, folder):
    epw(folder)
    text = inspect.getdoc(getattr(daylight, name))
    assert text
    space = {"bilux": bilux, "np": np, "datetime": datetime}
    test = doctest.DocTestParser().get_doctest(text, space, name, None, None)
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
    runner.run(test)
    assert runner.failures == 0


# What points receive


def quad(scene, corner, u, v, material):
    corner, u, v = map(np.asarray, (corner, u, v))
    scene.add_mesh([corner, corner + u, corner + u + v, corner + v], [[0, 1, 2], [0, 2, 3]], material=material)


def room(window=True):
    """A room of 4 by 6 by 3 metres, with a window to the south (+z); nothing outside reflects."""
    scene = bilux.Scene()
    grey = lambda value: bilux.materials.diffuse(reflectance=value)  # noqa: E731
    x, y, z = np.diag([4.0, 3.0, 6.0])
    quad(scene, (0, 0, 0), z, x, grey(0.2))
    quad(scene, (0, 3, 0), x, z, grey(0.7))
    quad(scene, (0, 0, 0), x, y, grey(0.5))
    quad(scene, (0, 0, 0), y, z, grey(0.5))
    quad(scene, (4, 0, 0), z, y, grey(0.5))
    if window:
        for corner, u, v in [((0, 0, 6), (0, 3, 0), (0.5, 0, 0)), ((3.5, 0, 6), (0, 3, 0), (0.5, 0, 0)),
                             ((0.5, 0, 6), (0, 1, 0), (3, 0, 0)), ((0.5, 2.5, 6), (0, 0.5, 0), (3, 0, 0))]:  # fmt: skip
            quad(scene, corner, u, v, grey(0.5))
    return scene


POINTS = np.array([[2.0, 0.8, 5.0], [2.0, 0.8, 3.0], [1.0, 0.8, 1.0]])


def test_lamps_of_all_kinds_have_their_lux():
    scene = bilux.Scene()
    quad(scene, (-3, 0, -3), (0, 0, 6), (6, 0, 0), bilux.materials.diffuse(reflectance=0))
    scene.add_light(bilux.lights.point(position=(0, 2, 0), intensity="100 cd"))
    points = [[0, 0, 0], [1, 0, 0], [0, 4, 0]]
    values, errors = scene.illuminance(points, spp=16)
    assert np.allclose(values, [25, 100 * 2 / 5**1.5, 0], rtol=1e-5) and errors.max() < 1e-3
    watts, _ = scene.irradiance(points, spp=16)
    assert np.allclose(watts * 683, values[:, None], rtol=1e-5)
    # A lumen for a candela would be a factor of 4π, a missing cosine 12%.
    scene.lights = [bilux.lights.point(position=(0, 2, 0), intensity="100 lm")]
    lumens, _ = scene.illuminance(points, spp=16)
    assert np.allclose(lumens * 4 * np.pi, values, rtol=1e-5)
    facing, _ = scene.illuminance(points[1:2], [[-1, 2, 0]], spp=16)
    assert facing[0] == pytest.approx(100 / 5 / (4 * np.pi), rel=1e-5)


def test_errors_are_honest():
    scene = room()
    scene.add_light(bilux.lights.cie_sky(irradiance="10 klx"))
    points = POINTS[:2]
    truth, _ = scene.illuminance(points, spp=65536)
    runs = [scene.illuminance(points, spp=1024, seed=seed) for seed in range(20)]
    off = np.array([run.values - truth for run in runs]) / np.array([run.errors for run in runs])
    assert 0.6 < np.sqrt((off**2).mean()) < 1.7


def test_wrong_points_are_refused():
    scene = room()
    with pytest.raises(bilux.SceneError, match="no light of its own"):
        scene.illuminance(POINTS)
    scene.add_light(bilux.lights.point())
    for points, normals, message in [
        (np.zeros((0, 3)), (0, 1, 0), "there are none"),
        (POINTS, [[0, 1, 0]] * 2, "2 rows for 3 points"),
        (POINTS, (0, 0, 0), "must not be zero"),
        (POINTS * np.nan, (0, 1, 0), "not finite"),
        (POINTS[:, :2], (0, 1, 0), r"must be \(n, 3\)"),
    ]:
        with pytest.raises(ValueError, match=message):
            scene.illuminance(points, normals)
    with pytest.raises(bilux.Error, match="only path and auto"):
        scene.illuminance(POINTS, integrator="bdpt")
    with pytest.raises(TypeError, match="size: this is a setting of pictures"):
        scene.illuminance(POINTS, size=64)


def test_a_plan_shows_what_points_receive():
    scene = room()
    scene.add_light(bilux.lights.cie_sky(irradiance="10 klx", standard=5))
    # Seen from above, the window (+z) at the bottom.
    scene.add_camera(bilux.cameras.irradiance(position=(2, 0.8, 3), look_at=(2, 3, 3), height=6))
    picture = scene.render(size=(8, 12), spp=256, integrator="path", denoise=False)
    columns, rows = np.meshgrid((np.arange(8) + 0.5) / 2, (np.arange(12) + 0.5) / 2)
    points = np.stack([columns, np.full_like(rows, 0.8), rows], axis=-1).reshape(-1, 3)
    values, _ = scene.illuminance(points, spp=256)
    found = picture.pixels.mean(axis=2) * np.pi * 683
    assert found.sum() == pytest.approx(values.sum(), rel=0.05)
    assert np.corrcoef(found.reshape(-1), values)[0, 1] > 0.98
    mirrored = np.corrcoef(found[::-1].reshape(-1), values)[0, 1]
    assert mirrored < 0.5
    assert found[-2].mean() > 5 * found[0].mean()


# The sky in patches


@pytest.mark.parametrize("parts", [1, 2, 4])
def test_patches_cover_the_sky_once(parts):
    patches = daylight.SkyPatches(parts)
    assert len(patches) == 2 + 144 * parts**2
    assert patches.solid_angles.sum() == pytest.approx(4 * np.pi)
    assert patches.level.sum() == pytest.approx(np.pi)
    assert np.array_equal(patches.numbers(patches.directions), np.arange(len(patches)))
    # The middle of a patch sees its cosine; one row off would be noticed.
    middles = patches.directions[1:, 1] * patches.solid_angles[1:]
    assert np.allclose(middles[: -parts * 6], patches.level[1 : -parts * 6], rtol=0.01)
    random = np.random.default_rng(1).normal(size=(200_000, 3))
    counts = np.bincount(patches.numbers(random), minlength=len(patches)) / len(random)
    assert np.abs(counts - patches.solid_angles / (4 * np.pi)).max() < 0.005


@pytest.mark.parametrize("type", [1, 5, 12])
def test_coefficients_times_a_sky_is_its_light(type):
    """The light of a room from a sky, measured directly, and by its patches."""
    scene, patches = room(), daylight.SkyPatches(2)
    table = daylight.coefficients(scene, POINTS, patches=patches, spp=8192)
    sky = bilux.lights.cie_sky(standard=type, elevation=40, azimuth=135, irradiance="10 klx", ground=0.2)
    scene.add_light(sky)
    values, errors = scene.illuminance(POINTS, spp=8192)
    luminances = np.zeros(len(patches))
    a, b, c, d, e = {1: (4, -0.7, 0, -1, 0), 5: (0, -1, 0, -1, 0), 12: (-1, -0.32, 10, -3, 0.45)}[type]
    up, sun = patches.directions[1:, 1], np.array([math.sin(math.radians(135)), 0, -math.cos(math.radians(135))])
    sun = sun * math.cos(math.radians(40)) + [0, math.sin(math.radians(40)), 0]
    angle = np.arccos(np.clip(patches.directions[1:] @ sun, -1, 1))
    gradation = 1 + a * np.exp(b / np.maximum(up, 0.01))
    luminances[1:] = gradation * (1 + c * (np.exp(d * angle) - np.exp(d * np.pi / 2)) + e * np.cos(angle) ** 2)
    luminances *= 10_000 / (luminances @ patches.level)
    luminances[0] = 0.2 * 10_000 / np.pi
    found = table @ luminances
    assert np.all(np.abs(found - values) < 0.03 * values + 5 * errors), (found, values)
    if type == 12:
        # An azimuth turned round, and numbers off by one row, would be noticed.
        turned = np.append(luminances[0], luminances[1:][patches.numbers(patches.directions[1:] * [-1, 1, -1]) - 1])
        assert np.abs(table @ turned / values - 1).max() > 0.1
        assert np.abs(table @ np.roll(luminances, 1) / values - 1).max() > 0.03


# The sun, and the weather


def test_the_sun_stands_where_almanacs_say():
    # The example of [Reda 2004]: zenith angle 50.11162°, azimuth 194.34024°.
    at = datetime.datetime(2003, 10, 17, 12, 30, 30, tzinfo=datetime.timezone(datetime.timedelta(hours=-7)))
    elevation, azimuth = daylight.sun_position(at, 39.742476, -105.1786)
    assert elevation == pytest.approx(90 - 50.11162, abs=0.02) and azimuth == pytest.approx(194.34024, abs=0.02)
    # South of the equator the sun stands in the north at noon.
    noon = datetime.datetime(2021, 12, 21, 2, tzinfo=datetime.timezone.utc)
    elevation, azimuth = daylight.sun_position(noon, -33.9, 151.2)
    assert 79 < elevation < 80 and min(azimuth, 360 - azimuth) < 15
    with pytest.raises(ValueError, match="no time zone"):
        daylight.sun_position(datetime.datetime(2021, 1, 1), 0, 0)


def test_weather_is_read(tmp_path):
    weather = daylight.read_epw(epw(tmp_path))
    assert (weather.latitude, weather.longitude, weather.time_zone) == (51.15, -0.18, 0)
    assert weather.hour[:2].tolist() == [0.5, 1.5] and weather.month[-1] == 12
    fields = RECORDS[12].split(",")
    assert weather.direct_normal[12] == float(fields[14]) and weather.diffuse_horizontal[12] == float(fields[15])
    assert weather.elevation.max() == pytest.approx(90 - 51.15 + 23.44, abs=0.6)
    assert abs(weather.azimuth[12] - 184) < 6
    assert weather.occupied().sum() == 3650


def test_records_of_half_an_hour_are_of_its_middle(tmp_path):
    """Two records an hour, which end at minutes 30 and 60 (EnergyPlus, Auxiliary Programs): with other light, so that none is the other's."""
    halves = []
    for line in RECORDS:
        fields = line.split(",")
        for minute, part in ((30, 0.25), (60, 0.5)):
            light = [f"{float(value) * part:.2f}" for value in fields[14:16]]
            halves.append(",".join([*fields[:4], str(minute), *fields[5:14], *light, *fields[16:]]))
    header = [*HEADER[:7], "DATA PERIODS,1,2,Data,Sunday,1/1,12/31"]
    half, whole = daylight.read_epw(epw(tmp_path, halves, header)), daylight.read_epw(epw(tmp_path))
    assert len(half.hour) == 2 * 8760 and half.hour[:4].tolist() == [0.25, 0.75, 1.25, 1.75]
    np.testing.assert_allclose(half.direct_normal[::2], 0.25 * whole.direct_normal, atol=0.01)
    np.testing.assert_allclose(half.diffuse_horizontal[1::2], 0.5 * whole.diffuse_horizontal, atol=0.01)
    # The sun of the whole hour's middle is between those of its halves.
    noon = 24 * 180 + 9
    assert half.elevation[2 * noon] < whole.elevation[noon] < half.elevation[2 * noon + 1]
    # Its way is bent downwards, by at most 15 degrees an hour about a point: (15 h)² / 2 of an arc for a quarter of an hour.
    bent = whole.elevation[noon] - half.elevation[2 * noon : 2 * noon + 2].mean()
    assert 0 < bent < np.degrees(np.radians(15 * 0.25) ** 2 / 2)


def changed(line, column, value):
    lines = list(RECORDS)
    fields = lines[line].split(",")
    fields[column] = value
    lines[line] = ",".join(fields)
    return lines


def test_broken_weather_is_refused_by_line(tmp_path):
    for lines, header, message in [
        (RECORDS[:-1], None, "8759 lines of data"),
        (RECORDS[:100] + RECORDS[101:] + RECORDS[:1], None, "line 109: its hour is 6, after 4"),
        (changed(20, 14, "9999"), None, "line 29: the direct normal irradiance.*stands for missing"),
        (changed(21, 15, "-3"), None, "line 30: the diffuse horizontal irradiance.* is -3"),
        (changed(21, 15, "2500"), None, "another unit"),
        (changed(31 * 24 + 5, 2, "30"), None, r"line 758: the day \(entry 3\) is 30, but month 2 of 2019 has 28 days"),
        (changed(22, 15, ""), None, "line 31: .*entry 16.*'' is no number"),
        (changed(23, 3, "25"), None, "line 32: the hour .* is 25, but must be from 1 to 24"),
        ([*RECORDS[:-1], "2019,12,31,24"], None, "line 8768: .*ends before it"),
        (None, ["Location London", *HEADER[1:]], "line 1: weather files"),
        (None, [HEADER[0].replace("51.15", "north"), *HEADER[1:]], "line 1: the latitude .*'north' is no number"),
        (None, [*HEADER[:7], "PERIODS,1,1"], "line 8: .*must be DATA PERIODS"),
    ]:
        with pytest.raises(ValueError, match=message):
            daylight.read_epw(epw(tmp_path, lines, header))
    with pytest.raises(FileNotFoundError):
        daylight.read_epw(tmp_path / "nowhere.epw")
    with pytest.raises(TypeError, match="no file"):
        daylight.read_epw(7)


def test_the_sky_gives_the_light_of_the_weather(tmp_path):
    weather, patches = daylight.read_epw(epw(tmp_path)), daylight.SkyPatches()
    sky, sun = (daylight.sky_matrix(weather, patches, sky=of_sky, sun=not of_sky) for of_sky in (True, False))
    direct, diffuse, _, _ = daylight._illuminances(weather)
    is_day = weather.elevation > 0
    assert np.allclose(patches.level @ sky, np.where(is_day, diffuse, 0), rtol=1e-4, atol=1)
    assert np.allclose(patches.solid_angles[1:] @ sun[1:], np.where(is_day, direct, 0), rtol=1e-4, atol=1)
    assert np.isfinite(sky).all() and sky.min() >= 0 and 50_000 < direct.max() < 120_000
    # The light of one hour, and the same hour as a scene's light.
    hour = int(np.flatnonzero((weather.day == 2) & (weather.month == 6) & (weather.hour == 12.5))[0])
    scene = room()
    table = daylight.coefficients(scene, POINTS, patches=daylight.SkyPatches(4), spp=4096)
    with pytest.raises(IndexError, match="interval: there is no number 8760: the weather has 8760"):
        daylight.sky_light(weather, 8760)
    # The sun is a disc in one and as large as a patch in the other, so it is left out.
    by_patches = table @ daylight.sky_matrix(weather, daylight.SkyPatches(4), sun=False)[:, hour]
    scene.add_light(daylight.sky_light(weather, hour).with_(direct=0))
    values, errors = scene.illuminance(POINTS, spp=16384)
    assert np.all(np.abs(by_patches - values) < 0.03 * values + 5 * errors), (by_patches, values)


def test_skies_of_every_clearness_are_those_of_gendaylit(folder):
    """Each range of [Perez 1990, table 4], from overcast to clear, as scenes of Radiance have them: by other code and another table."""
    used = set()
    for direct, diffuse in ((4, 100), (26, 150), (24, 60), (89, 110), (180, 120), (405, 140), (696, 140), (890, 110)):
        line = f"!gendaylit 6 21 10 -a 40 -o 0 -m 0 -d 9 -W {direct} {diffuse}\n"
        (folder / "sky.rad").write_text(line + "skyfunc glow sky_glow 0 0 4 1 1 1 0\nsky_glow source sky 0 0 4 0 0 1 180\n")
        (light,) = bilux.load("sky.rad").lights
        theirs = light.parameters
        one = {name: np.array([value], float) for name, value in (
            ("direct_normal", direct), ("diffuse_horizontal", diffuse), ("dew_point", 9), ("hour", 9.5),
            ("elevation", theirs["elevation"]), ("azimuth", theirs["azimuth"]),
        )}  # fmt: skip
        weather = daylight.Weather("", 40.0, 0.0, 0.0, np.array([6]), np.array([21]), **one)
        ours = [float(values[0]) for values in daylight._illuminances(weather)]
        light_of = [683 * theirs[name][0] for name in ("direct", "diffuse")]
        assert ours == pytest.approx([*light_of, theirs["clearness"], theirs["brightness"]], rel=1e-5), (direct, diffuse)
        used.add(int(np.searchsorted([1.065, 1.23, 1.5, 1.95, 2.8, 4.5, 6.2], ours[2], side="right")))
    assert used == set(range(8))


def test_missing_dew_points_are_those_of_usual_air(tmp_path):
    """99.9 stands for missing, in files of EnergyPlus."""
    lines = list(RECORDS)
    for number, dew in ((2, "99.9"), (5, "99.8")):
        fields = lines[number].split(",")
        fields[7] = dew
        lines[number] = ",".join(fields)
    assert daylight.read_epw(epw(tmp_path, lines)).dew_point[:7].tolist() == [6.0, 6.0, 10.0, 6.0, 6.0, 99.8, 6.0]


def test_the_figures_of_a_year():
    illuminance = np.array([[0, 50, 299, 300, 3001, 900], [400, 400, 400, 400, 50, 50]], float)
    occupied = np.array([False, True, True, True, True, True])
    assert daylight.daylight_autonomy(illuminance, occupied=occupied).tolist() == [0.6, 0.6]
    assert daylight.spatial_daylight_autonomy(illuminance) == 1.0
    assert daylight.spatial_daylight_autonomy(illuminance, share=0.55) == 0.5
    useful = daylight.useful_daylight_illuminance(illuminance, occupied=occupied)
    assert np.allclose(useful, [[0.2, 0.6, 0.2], [0.4, 0.6, 0]])
    assert daylight.annual_sun_exposure(illuminance, 300, 2) == 1.0
    assert daylight.annual_sun_exposure(illuminance, 300, 3) == 0.5
    # With two intervals in an hour, four of them are two hours.
    assert [daylight.annual_sun_exposure(illuminance, 300, hours, each=2) for hours in (1, 1.5, 2)] == [1.0, 0.5, 0.0]
    with pytest.raises(ValueError, match="must be"):
        daylight.daylight_autonomy(illuminance, occupied=occupied[1:])


def test_the_sun_is_a_point_whose_shadows_are_exact(tmp_path):
    """Through the hole of the window, which is the only way in: where the ray to the sun crosses its plane, z = 6."""
    weather = daylight.read_epw(epw(tmp_path))
    points = np.array([[x, 0.8, z] for x in (0.6, 2.0, 3.4) for z in (1.0, 3.0, 5.5)])
    found = daylight.direct_sunlight(room(), points, weather)
    turned, raised = np.radians(weather.azimuth), np.radians(weather.elevation)
    sun = np.stack([np.cos(raised) * np.sin(turned), np.sin(raised), -np.cos(raised) * np.cos(turned)])
    normal, _, _, _ = daylight._illuminances(weather)
    outdoors = normal * np.clip(sun[1], 0, None)
    with np.errstate(divide="ignore", invalid="ignore"):
        along = (6 - points[:, 2, None]) / sun[2]
        x, y = points[:, 0, None] + along * sun[0], points[:, 1, None] + along * sun[1]
    inside = (sun[2] > 0) & (sun[1] > 0) & (x > 0.5) & (x < 3.5) & (y > 1) & (y < 2.5)
    # Within a rounding of the edge either is right.
    near = np.minimum(np.abs(np.stack([x - 0.5, x - 3.5])).min(0), np.abs(np.stack([y - 1, y - 2.5])).min(0)) < 1e-4
    assert inside.sum() > 1000 and near.sum() < 20
    np.testing.assert_allclose(found[~near], (inside * outdoors)[~near], rtol=1e-4, atol=0.1)
    assert (found <= outdoors * (1 + 1e-6)).all()
    # The share of points with more than 250 hours of 1000 lx, counted by the same geometry: no number is random.
    occupied = weather.occupied()
    share = (((inside * outdoors)[:, occupied] >= 1000).sum(1) > 250).mean()
    assert daylight.annual_sun_exposure(found, occupied=occupied) == share and 0 < share < 1


def test_a_year_is_its_sky_and_its_sun(tmp_path):
    """Two hours of a year, measured by lights that stand for them: with sun and without."""
    weather, scene = daylight.read_epw(epw(tmp_path)), room()
    points = np.array([[2.0, 0.8, 5.0], [1.0, 0.8, 2.0]])
    year = daylight.annual_illuminance(scene, points, weather, spp=16384)
    outdoors, _, _, _ = daylight._illuminances(weather)
    direct = daylight.direct_sunlight(scene, points, weather)
    sunny = int(np.argmax(np.where(direct[0] > 0, outdoors, 0)))
    dull = int(np.flatnonzero((weather.direct_normal == 0) & (weather.diffuse_horizontal > 150))[0])
    for hour, tolerance in ((sunny, 0.1), (dull, 0.03)):
        scene.lights = [daylight.sky_light(weather, hour)]
        values, errors = scene.illuminance(points, spp=16384)
        off = np.abs(year.values[:, hour] - values)
        assert (off < tolerance * values + 4 * (errors + year.errors[:, hour])).all(), (hour, year.values[:, hour], values)
    # What comes straight has no error: the point in the sun is known better than by patches alone.
    assert direct[0, sunny] > 0.5 * year.values[0, sunny] and year.errors[0, sunny] < 0.1 * year.values[0, sunny]


def test_the_errors_of_a_year_are_honest(tmp_path):
    weather, scene, hours = daylight.read_epw(epw(tmp_path)), room(), slice(4000, 4100)
    points = [[2.0, 0.8, 4.0], [1.0, 0.8, 1.5]]
    runs = [daylight.annual_illuminance(scene, points, weather, spp=256, seed=seed) for seed in range(12)]
    values = np.array([run.values[:, hours] for run in runs])
    errors = np.array([run.errors[:, hours] for run in runs])
    lit = values.mean(0) > 50
    ratio = np.sqrt((errors**2).mean(0)[lit].mean() / values.var(0, ddof=1)[lit].mean())
    assert 0.6 < ratio < 1.7, ratio
    # And those of the figures.
    threshold = float(np.median(values.mean(0)[lit]))
    autonomies = [daylight.daylight_autonomy(run, threshold, weather.occupied()) for run in runs]
    spread = np.std([found.values for found in autonomies], axis=0, ddof=1)
    known = np.mean([found.errors for found in autonomies], axis=0)
    assert (known < 4 * spread + 0.01).all() and (spread < 4 * known + 0.01).all(), (spread, known)


def test_figures_have_the_errors_of_what_they_are_found_from():
    values = np.array([[100.0, 290, 310, 500], [310.0, 330, 340, 350], [100.0, 305, 320, 400]])
    year = bilux.Measured(values, np.array([[20.0], [1.0], [8.0]]) * np.ones(4))
    found = daylight.daylight_autonomy(year)
    # By 20 lx two hours of the first pass or fail, by 8 lx one of the third, by 1 lx none of the second.
    assert found.values.tolist() == [0.5, 1, 0.75] and found.errors.tolist() == [0.25, 0, 0.125]
    share = daylight.spatial_daylight_autonomy(year, share=0.75)
    chance = 0.5 * math.erfc(1 / math.sqrt(2)), 0.5
    assert share.values == pytest.approx(2 / 3)
    assert share.errors == pytest.approx(np.sqrt(chance[0] * (1 - chance[0]) + chance[1] * (1 - chance[1])) / 3)
    exact = daylight.daylight_autonomy(bilux.Measured(values, np.zeros_like(values)))
    assert np.array_equal(exact.values, daylight.daylight_autonomy(values)) and not exact.errors.any()
    assert daylight.annual_sun_exposure(year, 300, 2).values == pytest.approx(2 / 3)
    assert daylight.useful_daylight_illuminance(year).errors.shape == (3, 3)


def test_errors_of_sky_and_sun_in_one_patch_add_up(monkeypatch):
    """The same samples gave both, so that they are off together; other patches are off on their own."""
    sky = np.array([[0.0, 0.0], [3.0, 1.0], [0.0, 2.0]])
    sun = np.array([[0.0, 0.0], [4.0, 0.0], [0.0, 5.0]])
    whole = bilux.Measured(np.array([[0.0, 0.5, 0.25]]), np.array([[0.0, 0.1, 0.2]]))
    reflected = bilux.Measured(np.array([[0.0, 0.3, 0.125]]), np.array([[0.0, 0.2, 0.05]]))
    monkeypatch.setattr(daylight, "_coefficients", lambda *_: (whole, reflected))
    monkeypatch.setattr(daylight, "sky_matrix", lambda *_, sky=True, sun=True, albedo: tables[sky])
    monkeypatch.setattr(daylight, "direct_sunlight", lambda *_, **__: np.array([[7.0, 9.0]]))
    tables = {True: sky, False: sun}
    year = daylight.annual_illuminance(bilux.Scene(), [[0, 0, 0]], None)
    np.testing.assert_allclose(year.values, [[0.5 * 3 + 0.3 * 4 + 7, 0.5 + 0.25 * 2 + 0.125 * 5 + 9]])
    np.testing.assert_allclose(year.errors, [[0.1 * 3 + 0.2 * 4, np.hypot(0.1, 0.2 * 2 + 0.05 * 5)]])


# Glare


def glare_picture(radius=0.05):
    """A bright disc above the line of sight in an even room, by a fisheye lens."""
    camera = bilux.cameras.fisheye(position=(0, 0, 0), look_at=(0, 0, -1), fov=180)
    size = 200
    y, x = np.mgrid[0:size, 0:size]
    rays = camera.rays(np.stack([x, y], -1).reshape(-1, 2), size=(size, size))[1]
    towards = np.array([0.2, 0.35, -1]) / np.linalg.norm([0.2, 0.35, -1])
    near = np.arccos(np.clip(np.nan_to_num(rays) @ towards, -1, 1)) < radius
    light = np.where(np.isfinite(rays[:, 0]), np.where(near, 20_000.0, 150.0), 0.0)
    return camera, light.reshape(size, size), towards


def test_glare_is_that_of_the_formula():
    camera, light, towards = glare_picture()
    solid = 2 * np.pi * (1 - math.cos(0.05))
    eye = 150 * np.pi + (20_000 - 150) * solid * -towards[2]
    [index] = daylight.position_index(towards[None], (0, 0, -1))
    expected = 5.87e-5 * eye + 9.18e-2 * math.log10(1 + 20_000**2 * solid / (eye**1.87 * index**2)) + 0.16
    assert daylight.glare_probability(light, camera) == pytest.approx(expected, abs=0.004)
    # At the line of sight the index is 1; behind, nothing glares.
    ahead, behind = daylight.position_index([[0, 0, -1], [0, 0, 1]], (0, 0, -1))
    assert ahead == pytest.approx(1) and behind == np.inf
    # 20° above it, straight up: tau = 0.
    up = daylight.position_index([[0, math.sin(math.radians(20)), -math.cos(math.radians(20))]], (0, 0, -1))
    assert up[0] == pytest.approx(math.exp((35.2 - 1.22) * 0.02 + 21 * 0.004), rel=1e-6)


#: Position indices of lamps right above the line of sight, by their height over their distance R. [CIE 117, table 1]
ABOVE = {0.0: 1.00, 0.5: 2.86, 1.0: 7.00, 1.5: 13.15}


def test_the_unified_rating_is_that_of_its_formula():
    for height, index in ABOVE.items():
        assert daylight.position_index([[0, height, -1]], (0, 0, -1))[0] == pytest.approx(index, rel=0.01)
    # Two lamps of different luminance and size, at places whose indices the table has, before an even background.
    camera = bilux.cameras.fisheye(position=(0, 0, 0), look_at=(0, 0, -1), fov=180)
    size = 600
    y, x = np.mgrid[0:size, 0:size]
    rays = np.nan_to_num(camera.rays(np.stack([x, y], -1).reshape(-1, 2), size=(size, size))[1])
    light, total = np.where(np.linalg.norm(rays, axis=1) > 0, 40.0, 0.0), 0.0
    for height, bright, radius in ((0.5, 9000.0, 0.06), (1.0, 20_000.0, 0.09)):
        towards = np.array([0, height, -1]) / math.hypot(1, height)
        light[np.arccos(np.clip(rays @ towards, -1, 1)) < radius] = bright
        total += bright**2 * 2 * np.pi * (1 - math.cos(radius)) / ABOVE[height] ** 2
    lamps = sum(40.0 * np.pi * math.sin(r) ** 2 / math.hypot(1, h) for h, r in ((0.5, 0.06), (1.0, 0.09)))
    background = 40.0 - lamps / np.pi
    expected = 8 * math.log10(0.25 / background * total)
    found = daylight.unified_glare_rating(light.reshape(size, size), camera, threshold=1000)
    assert found == pytest.approx(expected, abs=0.15) and 15 < expected < 30
    # The default threshold finds the same lamps; twice the background is a step of 8 log 2 less.
    assert daylight.unified_glare_rating(light.reshape(size, size), camera) == found
    dimmer = np.where(light == 40, 80.0, light).reshape(size, size)
    assert daylight.unified_glare_rating(dimmer, camera, 1000) == pytest.approx(found - 8 * math.log10(2), abs=1e-6)
    assert daylight.unified_glare_rating(np.where(light > 0, 40.0, 0).reshape(size, size), camera) == -math.inf
    with pytest.raises(ValueError, match="no background"):
        daylight.unified_glare_rating(np.where(light > 40, light, 0).reshape(size, size), camera, 1000)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda light, eye: ((light / light.max() * 255).astype(np.uint8), eye), "numbers of a picture file"),
        (lambda light, eye: (light, bilux.cameras.perspective(fov=90)), r"it sees \d+% of what is ahead"),
        (lambda light, eye: (light, bilux.cameras.orthographic()), "it sees 0% of what is ahead"),
        (lambda light, eye: (light, bilux.cameras.fisheye(fov=140)), r"it sees \d+% of what is ahead"),
    ],
)
def test_glare_of_other_pictures_is_refused(change, message):
    camera, light, _ = glare_picture()
    with pytest.raises(ValueError, match=message):
        daylight.glare_probability(*change(light, camera))


@pytest.mark.parametrize("factor", [1 / 683, 0, 683])
def test_glare_in_other_units_is_said(factor):
    camera, light, _ = glare_picture()
    with pytest.warns(UserWarning, match="at the eye"):
        daylight.glare_probability(light * factor, camera)


# Radiance


#: Over the zenith, at elevations of 5, 30 and 60 degrees: what `gensky -ang 40 0 -c` describes, by Radiance 5.4.
GENSKY_OVERCAST = {5: 0.39144, 30: 0.66667, 60: 0.91068}


@pytest.mark.filterwarnings("ignore:the camera sees none")
def test_the_overcast_sky_is_that_of_gensky():
    scene = room(window=False)
    scene.add_light(bilux.lights.cie_sky(standard=16, irradiance="10 klx", ground=0))
    # Level ground receives 7π/9 of the zenith's luminance. [Moon 1942]
    zenith = 10_000 / (7 * np.pi / 9)
    for elevation, share in GENSKY_OVERCAST.items():
        up, flat = math.sin(math.radians(elevation)), math.cos(math.radians(elevation))
        scene.cameras = [bilux.cameras.perspective(position=(0, 9, 20), look_at=(flat, 9 + up, 20), fov=1)]
        seen = scene.render(size=2, spp=1, denoise=False, integrator="path").pixels.mean() * 683
        assert seen == pytest.approx(share * zenith, rel=5e-3), elevation


def test_gensky_still_describes_that_sky(tmp_path):
    run = radiance()
    text = run(["gensky", "-ang", 40, 0, "-c", "-B", 10_000 / 179]).decode()
    # The last numbers are 2 for overcast, the brightness of the zenith, and that of the ground.
    kind, zenith, _ = (float(word) for word in text.split()[-3:])
    assert kind == 2 and zenith * 179 == pytest.approx(10_000 / (7 * np.pi / 9), rel=1e-3)


def radiance():
    """Runs the programs of Radiance, as the package pyradiance brings them; skips where it is not installed."""
    found = importlib.util.find_spec("pyradiance")
    if found is None:
        pytest.skip("pyradiance is not installed, so Radiance is no witness here")
    package = pathlib.Path(found.origin).parent
    library = os.pathsep.join([".", *(str(package / name) for name in ("lib", "cal"))])

    def run(words, given=b"", folder=None):
        program, *rest = map(str, words)
        environment = os.environ | {"RAYPATH": library, "PATH": f"{package / 'bin'}{os.pathsep}{os.environ['PATH']}"}
        done = subprocess.run(
            [package / "bin" / program, *rest], input=given, capture_output=True, cwd=folder, env=environment, check=False
        )
        assert done.returncode == 0, done.stderr.decode()
        return done.stdout

    return run


def as_radiance(scene):
    """The objects of a scene in Radiance's coordinates: z up, y to the north."""
    lines = []
    for index, thing in enumerate(scene.objects):
        value = thing.material.parameters["reflectance"]
        red, green, blue = np.broadcast_to(value, 3)
        lines.append(f"void plastic m{index} 0 0 5 {red} {green} {blue} 0 0")
        mesh = scene.mesh(index)
        for number, triangle in enumerate(mesh.triangles):
            corners = " ".join(f"{x} {-z} {y}" for x, y, z in mesh.vertices[triangle].tolist())
            lines.append(f"m{index} polygon p{index}.{number} 0 0 9 {corners}")
    return "\n".join(lines) + "\n"


def by_rtrace(run, folder, description, points, options):
    (folder / "scene.rad").write_text(description)
    (folder / "scene.oct").write_bytes(run(["oconv", "scene.rad"], folder=folder))
    rays = "".join(f"{x} {-z} {y} 0 0 1\n" for x, y, z in points).encode()
    text = run(["rtrace", "-h", "-I", *options, "scene.oct"], rays, folder).decode()
    return np.array([line.split() for line in text.splitlines()], float) @ [0.265, 0.670, 0.065]


def test_radiance_finds_the_same_light_in_a_room(tmp_path):
    run, scene = radiance(), room()
    sky = "void glow even 0 0 4 1 1 1 0\neven source sky 0 0 4 0 0 1 180\n"
    options = "-ab 12 -ad 8192 -lw 1e-7 -aa 0 -lr -14".split()
    points = np.array([[2.0, 0.8, 5.0], [2.0, 0.8, 3.0], [1.0, 0.8, 2.5]])
    theirs = np.mean([by_rtrace(run, tmp_path, as_radiance(scene) + sky, points, options) for _ in range(3)], axis=0)
    scene.add_light(bilux.lights.cie_sky(standard=5, zenith=1, ground=0))
    ours, errors = scene.irradiance(points, spp=65536)
    assert np.abs(ours[:, 1] / theirs - 1).max() < 0.02, (ours, errors, theirs)


def test_radiance_has_the_same_skies(tmp_path):
    run = radiance()
    weather = daylight.read_epw(epw(tmp_path))
    hours = [hour for hour in (1932, 3564, 3588, 3612, 5000) if weather.elevation[hour] > 5]
    assert len(hours) >= 3
    _, _, clearness, brightness = daylight._illuminances(weather)
    for hour in hours:
        turned = weather.azimuth[hour] - 180
        words = ["gendaylit", "-ang", weather.elevation[hour], turned, "-P", clearness[hour], brightness[hour], "-g", 0.2]
        text = run(words).decode()
        perez = np.array(text.split("brightfunc")[1].split()[5:], float)
        ours = bilux._bilux.perez_coefficients(clearness[hour], brightness[hour], np.radians(90 - weather.elevation[hour]))
        assert np.allclose(perez[3:8], ours, rtol=1e-3, atol=2e-3), (perez, ours)


def test_evalglare_finds_the_same_glare(tmp_path):
    run = radiance()
    camera, light, _ = glare_picture()
    height, width = light.shape
    # As pixels with a common exponent; 179 lm/W is how Radiance converts.
    values = np.repeat(light[..., None] / 179, 3, axis=-1)
    exponent = np.floor(np.log2(np.maximum(values[..., :1], 1e-30))) + 1
    pixels = np.concatenate([np.clip(values * 256 / 2.0**exponent, 0, 255), exponent + 128], axis=-1)
    pixels[light <= 0] = 0
    head = f"#?RADIANCE\nVIEW= -vta -vh 180 -vv 180\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n"
    (tmp_path / "glare.hdr").write_bytes(head.encode() + pixels.astype(np.uint8).tobytes())
    text = run(["evalglare", "glare.hdr"], folder=tmp_path).decode()
    names, numbers = text.split(":")[0].split(","), text.split(":")[1].split()
    theirs = {name.strip(): float(number) for name, number in zip(names, numbers, strict=False)}
    assert daylight.glare_probability(light, camera) == pytest.approx(theirs["dgp"], abs=0.005)
    assert daylight.unified_glare_rating(light, camera) == pytest.approx(theirs["ugr"], abs=0.3)


def test_lights_alone_and_the_sun_through_a_pane_are_measured():
    scene = bilux.Scene()
    scene.add_light(bilux.lights.point(position=(1, 2, 0), intensity="500 cd"))
    values, errors = scene.illuminance([[0, 0, 0], [1, 0, 0]], spp=16)
    assert values == pytest.approx([500 * 2 / 5**1.5, 125], rel=1e-5) and np.all(errors < 1e-3)
    sunny = bilux.Scene()
    sunny.add_light(bilux.lights.directional(direction=(0, -4, -3), irradiance="1000 lx"))
    pane = bilux.materials.dielectric(thin=True, tint=0.8)
    sunny.add_mesh([[-50, 2, 50], [50, 2, 50], [50, 2, -50], [-50, 2, -50]], [[0, 1, 2], [0, 2, 3]], material=pane)
    values, errors = sunny.illuminance([[0, 0, 0]], spp=16)
    inside = math.sqrt(1 - 0.36 / 2.25)
    across, along = (0.8 - 1.5 * inside) / (0.8 + 1.5 * inside), (1.5 * 0.8 - inside) / (1.5 * 0.8 + inside)
    reflected = (across**2 + along**2) / 2
    wanted = 1000 * 0.8 * 0.8 * (1 - reflected) / (1 + reflected)
    assert values == pytest.approx([wanted], rel=1e-4) and np.all(errors < 1e-3 * wanted)
