"""Scenes of Radiance, by the lux on their floors: against closed forms, at the 179 lm of a watt that Radiance takes."""

import math

import numpy as np
import pytest

import bilux

LUMENS = 179.0
"""Of a watt, in Radiance."""


def lux(folder, text, point, normal=(0.0, 1.0, 0.0), spp=4096):
    """What arrives at a point, which is (x, z, -y) of Radiance."""
    path = folder / "room.rad"
    path.write_text(text)
    scene = bilux.load(path)
    values, errors = scene.illuminance([point], [normal], spp=spp)
    return float(values[0]), float(errors[0])


def corner(a, b, h):
    """The view factor from an element to a parallel rectangle of a by b, a corner of which is h above it. [Howell C-11]"""
    x, y = a / h, b / h
    first = x / math.hypot(1, x) * math.atan(y / math.hypot(1, x))
    second = y / math.hypot(1, y) * math.atan(x / math.hypot(1, y))
    return (first + second) / (2 * math.pi)


FLOOR = """
void plastic dark 0 0 5 0 0 0 0 0
dark polygon floor 0 0 12  -9 -9 0  9 -9 0  9 9 0  -9 9 0
"""

PANEL = """
void light panel 0 0 3 10 30 20
panel polygon lamp 0 0 12  {points}
"""


def test_a_panel_lights_what_is_below_by_its_corners_and_nothing_above(folder):
    # 3 m to the east, 2 m to the north, 1.5 m up, seen from its southwest corner.
    down = PANEL.format(points="0 0 1.5  0 2 1.5  3 2 1.5  3 0 1.5")
    luminance = LUMENS * (0.2126 * 10 + 0.7152 * 30 + 0.0722 * 20)
    expected = math.pi * luminance * corner(3, 2, 1.5)
    assert lux(folder, FLOOR + down, (0, 0, 0))[0] == pytest.approx(expected, rel=5e-3)
    # North is -z.
    south = lux(folder, FLOOR + down, (0, 0, 2))[0]
    expected = math.pi * luminance * (corner(3, 4, 1.5) - corner(3, 2, 1.5))
    assert south == pytest.approx(expected, rel=1e-2)
    up = PANEL.format(points="3 0 1.5  3 2 1.5  0 2 1.5  0 0 1.5")
    assert lux(folder, FLOOR + up, (0, 0, 0)) == (0.0, 0.0)


def test_rings_and_spheres_shine_as_large_as_they_are(folder):
    ring = "void light lamp 0 0 3 40 40 40\nlamp ring hoop 0 0 8  1 2 3  0 0 -1  .4 1.5\n"
    expected = math.pi * 40 * LUMENS * (1.5**2 / (1.5**2 + 9) - 0.4**2 / (0.4**2 + 9))
    assert lux(folder, FLOOR + ring, (1, 0, -2))[0] == pytest.approx(expected, rel=5e-3)
    ball = "void light lamp 0 0 3 40 40 40\nlamp sphere ball 0 0 4  1 2 3 .5\n"
    expected = math.pi * 40 * LUMENS * 0.25 / 13 * 3 / math.sqrt(13)
    assert lux(folder, FLOOR + ball, (1, 0, 0))[0] == pytest.approx(expected, rel=5e-3)


def test_a_sun_comes_from_where_it_stands_and_a_sky_from_everywhere(folder):
    # 30 degrees above the east, half a degree wide.
    sun = "void light sun 0 0 3 5e6 5e6 5e6\nsun source disc 0 0 4  .8660254 0 .5  .5\n"
    solid_angle = 2 * math.pi * (1 - math.cos(math.radians(0.25)))
    facing = 5e6 * LUMENS * solid_angle
    assert lux(folder, FLOOR + sun, (0, 0, 0))[0] == pytest.approx(facing / 2, rel=2e-3)
    assert lux(folder, FLOOR + sun, (0, 1, 0), (1, 0, 0))[0] == pytest.approx(facing * 0.8660254, rel=2e-3)
    assert lux(folder, FLOOR + sun, (0, 1, 0), (-1, 0, 0))[0] == 0
    sky = "void glow sky 0 0 4 1 1 1 0\nsky source dome 0 0 4  0 0 1 180\n"
    assert lux(folder, FLOOR + sky, (0, 0, 0))[0] == pytest.approx(math.pi * LUMENS, rel=2e-3)


def through(transmissivity):
    """What passes a pane of Radiance under an even sky, of index 1.52, with all reflections within."""
    cos = (np.arange(20000) + 0.5) / 20000
    inside = np.sqrt(1 - (1 - cos**2) / 1.52**2)
    across, along = (cos - 1.52 * inside) / (cos + 1.52 * inside), (1.52 * cos - inside) / (1.52 * cos + inside)
    passed = transmissivity ** (1 / inside)
    each = [(1 - r**2) ** 2 * passed / (1 - (r**2 * passed) ** 2) for r in (across, along)]
    return float(np.mean(2 * cos * sum(each) / 2))


def test_a_clear_pane_passes_as_much_of_a_sky_as_in_radiance(folder):
    sky = "void glow sky 0 0 4 1 1 1 0\nsky source dome 0 0 4  0 0 1 180\n"
    pane = "void glass pane 0 0 3 .96 .96 .96\npane polygon window 0 0 12  -90 -90 .02  90 -90 .02  90 90 .02  -90 90 .02\n"
    passed = lux(folder, FLOOR + sky + pane, (0, 0, 0), spp=16384)[0] / (math.pi * LUMENS)
    assert passed == pytest.approx(through(0.96), rel=1e-2)
