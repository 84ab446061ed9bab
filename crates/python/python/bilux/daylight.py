"""Daylight over a year: how much of the light of each part of the sky reaches each point, and what comes of it hour by hour.

`coefficients` measures once how points see the sky, part by part ([Tregenza 1983]); `read_epw` reads the weather of a year, and
`sky_matrix` says how bright each part is in every hour ([Perez 1993]). Their product is the illuminance of each point in each
hour, from which follow the usual figures: `daylight_autonomy`, `useful_daylight_illuminance`, `annual_sun_exposure`.

In scenes up is +y, north is -z and east is +x. Angles are in degrees, azimuths from the north to the east.

Example:
    >>> scene = bilux.Scene()
    >>> ground = scene.add_mesh([[-9, 0, 9], [9, 0, 9], [9, 0, -9], [-9, 0, -9]], [[0, 1, 2], [0, 2, 3]])
    >>> patches = bilux.daylight.SkyPatches()
    >>> dc = bilux.daylight.coefficients(scene, [[0, 0, 0]], patches=patches, spp=256)
    >>> dc.shape, bool(abs(dc[0, 1:].sum() - np.pi) < 0.05)
    ((1, 146), True)

Sources:
    [CIE 117] CIE. Discomfort Glare in Interior Lighting. CIE 117, 1995.
    [IES 2000] IES. Lighting Handbook. 9th edition.
    [IES LM-83-12] IES. Spatial Daylight Autonomy and Annual Sunlight Exposure. LM-83-12, 2012.
    [Iwata 1997] T. Iwata, M. Tokura. Position index for a glare source located below the line of vision. Lighting Research and
        Technology 29(3).
    [Michalsky 1988] J. J. Michalsky. The Astronomical Almanac's algorithm for approximate solar position (1950-2050). Solar
        Energy 40(3).
    [Nabil 2006] A. Nabil, J. Mardaljevic. Useful daylight illuminances: a replacement for daylight factors. Energy and
        Buildings 38(7).
    [Perez 1990] R. Perez and others. Modeling daylight availability and irradiance components from direct and global
        irradiance. Solar Energy 44(5).
    [Perez 1993] R. Perez, R. Seals, J. Michalsky. All-weather model for sky luminance distribution. Solar Energy 50(3).
    [Reinhart 2000] C. F. Reinhart, S. Herkel. The simulation of annual daylight illuminance distributions. Energy and
        Buildings 32(2).
    [Reinhart 2006] C. F. Reinhart, J. Mardaljevic, Z. Rogers. Dynamic daylight performance metrics for sustainable building
        design. Leukos 3(1).
    [Tregenza 1983] P. R. Tregenza, I. M. Waters. Daylight coefficients. Lighting Research and Technology 15(2).
    [Tregenza 1987] P. R. Tregenza. Subdivision of the sky hemisphere for luminance measurements. Lighting Research and
        Technology 19(1).
    [Wienold 2006] J. Wienold, J. Christoffersen. Evaluation methods and development of a new glare prediction model for daylight
        environments with the use of CCD cameras. Energy and Buildings 38(7).
"""

from __future__ import annotations

import calendar
import io
import math
import operator
import os
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime, timedelta, timezone
from typing import Any, Literal, TextIO, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _bilux
from ._bilux import Spec
from ._progress import following
from ._scene import Scene, _sensors
from ._types import Measured, Progress

Floats = NDArray[np.float64]

TREGENZA = (30, 30, 24, 24, 18, 12, 6)
"""Patches in each row of the sky, from the horizon up; one more is at the zenith. [Tregenza 1987]"""

SOLAR_CONSTANT = 1367.0
"""Irradiance by the sun above the atmosphere, in W/m²."""


class SkyPatches:
    """The sky in patches, and the ground: 145 of them [Tregenza 1987], or each of these cut into `parts` times `parts`
    [Reinhart 2000]: 577 for 2, 2,305 for 4.

    Number 0 is the ground. The others begin at the horizon; the middle of the first in each row is in the north, the next is
    to the east of it. The last is the zenith. This is the order of Radiance's sky vectors.

    Example:
        >>> len(bilux.daylight.SkyPatches(4))
        2306
    """

    def __init__(self, parts: int = 1) -> None:
        if not 1 <= parts <= 16:
            raise ValueError(f"parts: {parts} is no number from 1 to 16")
        self.parts = parts
        counts = [count * parts for count in TREGENZA for _ in range(parts)]
        step = 90 / (len(counts) + 0.5)
        low = step * np.arange(len(counts) + 1)
        self._counts = np.array([*counts, 1])
        self._edges = np.radians(np.append(low, 90.0))

    def __len__(self) -> int:
        """The number of patches, with the ground."""
        return 1 + int(self._counts.sum())

    @property
    def _rows(self) -> list[tuple[float, int]]:
        """The sine of the elevation at which each row begins, and its patches."""
        return [(float(np.sin(low)), int(count)) for low, count in zip(self._edges, self._counts, strict=False)]

    def _each(self, of_row: Floats, ground: float) -> Floats:
        """A number of each patch, from those of the rows."""
        return np.append(ground, np.repeat(of_row, self._counts))

    @property
    def solid_angles(self) -> Floats:
        """(n,) solid angles in sr; they add up to 4π."""
        heights = np.diff(np.sin(self._edges))
        return self._each(2 * np.pi * heights / self._counts, 2 * np.pi)

    @property
    def level(self) -> Floats:
        """(n,) illuminances in lx of level ground by patches of 1 cd/m²: cosine times solid angle; they add up to π."""
        squares = np.diff(np.sin(self._edges) ** 2)
        return self._each(np.pi * squares / self._counts, 0.0)

    @property
    def directions(self) -> Floats:
        """(n, 3) unit vectors to the middles."""
        middles = (self._edges[:-1] + self._edges[1:]) / 2
        middles[-1] = np.pi / 2
        elevation = self._each(middles, -np.pi / 2)
        turns = [np.arange(count) / count for count in self._counts]
        azimuth = 2 * np.pi * np.concatenate([[0.0], *turns])
        flat = np.cos(elevation)
        return np.stack([flat * np.sin(azimuth), np.sin(elevation), -flat * np.cos(azimuth)], axis=1)

    def numbers(self, directions: ArrayLike) -> NDArray[np.int64]:
        """(k,) numbers of the patches in (k, 3) directions."""
        return _bilux.patch_numbers(self._rows, directions)


def sun_position(when: datetime, latitude: float, longitude: float) -> tuple[float, float]:
    """Where the sun stands, with refraction, to 0.01° in the years 1950 to 2050. [Michalsky 1988]

    Args:
        when: a time with its time zone.
        latitude, longitude: in degrees, to the north and to the east.

    Returns:
        elevation and azimuth in degrees; the azimuth from 0 to 360, from the north to the east.

    Raises:
        ValueError: if the time has no time zone.

    Example:
        >>> noon = datetime.datetime(2024, 6, 21, 12, tzinfo=datetime.timezone.utc)
        >>> [round(angle, 1) for angle in bilux.daylight.sun_position(noon, 51.5, 0.0)]
        [61.9, 179.1]
    """
    if when.tzinfo is None:
        raise ValueError("when: the time has no time zone: give it one, such as tzinfo=datetime.timezone.utc")
    since = when - datetime(2000, 1, 1, 12, tzinfo=timezone.utc)
    elevation, azimuth = _sun(np.array([since / timedelta(days=1)]), latitude, longitude)
    return float(elevation[0]), float(azimuth[0])


def _sun(days: Floats, latitude: float, longitude: float) -> tuple[Floats, Floats]:
    """The same of days since noon of the first of January 2000 (UTC). [Michalsky 1988]"""
    anomaly = np.radians(357.528 + 0.9856003 * days)
    mean = 280.460 + 0.9856474 * days
    ecliptic = np.radians(mean + 1.915 * np.sin(anomaly) + 0.020 * np.sin(2 * anomaly))
    oblique = np.radians(23.439 - 4e-7 * days)
    ascension = np.arctan2(np.cos(oblique) * np.sin(ecliptic), np.cos(ecliptic))
    declination = np.arcsin(np.sin(oblique) * np.sin(ecliptic))
    hours = (days + 0.5) % 1 * 24
    sidereal = 6.697375 + 0.0657098242 * days + hours + longitude / 15
    angle = np.radians(15 * sidereal) - ascension
    north = np.radians(latitude)
    up = np.sin(declination) * np.sin(north) + np.cos(declination) * np.cos(north) * np.cos(angle)
    east = -np.cos(declination) * np.sin(angle)
    along = np.sin(declination) * np.cos(north) - np.cos(declination) * np.sin(north) * np.cos(angle)
    degrees = np.degrees(np.arcsin(np.clip(up, -1, 1)))
    bent = 3.51561 * (0.1594 + 0.0196 * degrees + 2e-5 * degrees**2) / (1 + 0.505 * degrees + 0.0845 * degrees**2)
    refraction = np.where(degrees > -0.56, bent, 0.56)
    return degrees + refraction, np.degrees(np.arctan2(east, along)) % 360


@dataclass(frozen=True, eq=False)
class Weather:
    """The weather of a place, hour by hour (or more often).

    Attributes:
        place: its name.
        latitude, longitude: in degrees, to the north and to the east.
        time_zone: hours ahead of UTC.
        month, day: (n,) of each interval.
        hour: (n,) the middle of each interval, in hours of the place's standard time, from 0 to 24.
        direct_normal: (n,) irradiances by the sun of a surface that faces it, in W/m².
        diffuse_horizontal: (n,) irradiances of level ground by the sky, in W/m².
        dew_point: (n,) in °C.
        elevation, azimuth: (n,) of the sun in the middle of each interval, in degrees.
    """

    place: str
    latitude: float
    longitude: float
    time_zone: float
    month: NDArray[np.int64]
    day: NDArray[np.int64]
    hour: Floats
    direct_normal: Floats
    diffuse_horizontal: Floats
    dew_point: Floats
    elevation: Floats
    azimuth: Floats

    def __len__(self) -> int:
        return len(self.hour)

    def occupied(self, begin: float = 8.0, end: float = 18.0) -> NDArray[np.bool_]:
        """(n,) which intervals lie within these hours of the day, on all days, as the IES counts them [IES LM-83-12]."""
        return (self.hour > begin) & (self.hour < end)


_COLUMNS = {"dew point": 7, "direct normal irradiance": 14, "diffuse horizontal irradiance": 15}
_MOST = 1500.0


def read_epw(file: str | os.PathLike[str] | TextIO) -> Weather:
    """Reads the weather of a year from a file of EnergyPlus (`.epw`).

    Args:
        file: a path, or a file that is open as text.

    Raises:
        FileNotFoundError: if there is no such file.
        ValueError: if it is no such file, a line lacks something, or an irradiance is missing or impossible. The message says in
            which line.

    Example:
        >>> weather = bilux.daylight.read_epw("london.epw")
        >>> len(weather), weather.place
        (8760, 'London')
    """
    if isinstance(file, (str, os.PathLike)):
        name = os.fspath(file)
        with open(file, encoding="utf-8", errors="replace") as opened:
            lines = opened.read().splitlines()
    elif isinstance(file, io.TextIOBase) or hasattr(file, "read"):
        name, lines = str(getattr(file, "name", "the file")), file.read().splitlines()
    else:
        raise TypeError(f"file: {file!r} is no file: give a path, or one that is open as text")
    place, latitude, longitude, time_zone, each = _header(name, lines)
    rows = [(number, line.split(",")) for number, line in enumerate(lines, 1) if number > 8 and line.strip()]
    expected = [days * 24 * each for days in (365, 366)]
    if len(rows) not in expected:
        raise ValueError(
            f"{name}: there are {len(rows)} lines of data after line 8, but a year with {each} in an hour has {expected[0]}, or "
            f"{expected[1]} with a 29th of February: the file is cut short, or has more than a year"
        )
    table = np.array([_record(name, number, fields, each) for number, fields in rows])
    _check_order(name, rows, table, each)
    year, month, day, hour = table[:, 0], table[:, 1].astype(int), table[:, 2].astype(int), table[:, 3]
    begin = [datetime(int(y), int(m), int(d), tzinfo=timezone.utc) for y, m, d in zip(year, month, day, strict=True)]
    noon = datetime(2000, 1, 1, 12, tzinfo=timezone.utc)
    days = np.array([(at - noon) / timedelta(days=1) for at in begin]) + (hour - time_zone) / 24
    elevation, azimuth = _sun(days, latitude, longitude)
    return Weather(
        place, latitude, longitude, time_zone, month, day, hour,
        table[:, 5], table[:, 6], table[:, 4], elevation, azimuth,
    )  # fmt: skip


def _header(name: str, lines: list[str]) -> tuple[str, float, float, float, int]:
    """Place, latitude, longitude, time zone, and records in an hour."""
    if len(lines) < 8 or not lines[0].upper().startswith("LOCATION,"):
        raise ValueError(f"{name}, line 1: weather files of EnergyPlus begin with eight lines, of which the first is LOCATION,…")
    location, periods = lines[0].split(","), lines[7].split(",")
    if len(location) < 10 or not periods[0].upper().startswith("DATA PERIODS"):
        line = 1 if len(location) < 10 else 8
        what = "LOCATION with ten entries" if line == 1 else "DATA PERIODS"
        raise ValueError(f"{name}, line {line}: this is '{lines[line - 1][:40]}', but must be {what}")
    latitude, longitude, time_zone = (
        _number(name, 1, location, column, what, *bounds)
        for column, what, bounds in ((6, "latitude", (-90, 90)), (7, "longitude", (-180, 180)), (8, "time zone", (-12, 14)))
    )
    each = int(_number(name, 8, periods, 2, "number of records in an hour", 1, 60))
    return location[1].strip(), latitude, longitude, time_zone, each


def _number(name: str, line: int, fields: list[str], column: int, what: str, least: float, most: float) -> float:
    """A number of a line."""
    try:
        value = float(fields[column])
    except (IndexError, ValueError):
        found = f"'{fields[column].strip()}' is no number" if column < len(fields) else "the line ends before it"
        raise ValueError(f"{name}, line {line}: the {what} (entry {column + 1}) is missing: {found}") from None
    if not least <= value <= most:
        raise ValueError(f"{name}, line {line}: the {what} (entry {column + 1}) is {value:g}, but must be from {least:g} to {most:g}")
    return value


def _record(name: str, line: int, fields: list[str], each: int) -> list[float]:
    """Year, month, day, the middle of the interval, dew point, direct and diffuse irradiance."""
    year, month, day, hour = (
        _number(name, line, fields, column, what, least, most)
        for column, (what, least, most) in enumerate(
            (("year", 1900, 2200), ("month", 1, 12), ("day", 1, 31), ("hour", 1, 24))
        )
    )
    days = calendar.monthrange(int(year), int(month))[1]
    if day > days:
        raise ValueError(f"{name}, line {line}: the day (entry 3) is {day:g}, but month {month:g} of {year:g} has {days} days")
    minute = _number(name, line, fields, 4, "minute", 0, 60) if each > 1 else 60.0
    dew = _number(name, line, fields, _COLUMNS["dew point"], "dew point in °C", -99.9, 99.9)
    light = []
    for what in ("direct normal irradiance", "diffuse horizontal irradiance"):
        column = _COLUMNS[what]
        value = _number(name, line, fields, column, f"{what} in W/m²", -1e9, 1e9)
        if value >= 9999:
            raise ValueError(
                f"{name}, line {line}: the {what} (entry {column + 1}) is {value:g}, which stands for missing: fill the gap in the "
                "file, for example from the same hour of a day beside it"
            )
        if not 0 <= value <= _MOST:
            raise ValueError(
                f"{name}, line {line}: the {what} (entry {column + 1}) is {value:g}, but the sun gives 0 to {_MOST:g} W/m²: is it in "
                "another unit?"
            )
        light.append(value)
    # 99.9 stands for missing; 10 °C is about 2 cm of water in the air.
    return [year, month, day, hour - 1 + (minute - 30 / each) / 60, 10.0 if dew >= 99.9 else dew, *light]


def _check_order(name: str, rows: list[tuple[int, list[str]]], table: Floats, each: int) -> None:
    """Refuses gaps and repetitions."""
    at = table[:, 3] * each
    steps = (np.diff(at) - 1) % (24 * each)
    wrong = np.flatnonzero((steps > 0.01) & (steps < 24 * each - 0.01))
    if len(wrong):
        row = int(wrong[0]) + 1
        raise ValueError(
            f"{name}, line {rows[row][0]}: its hour is {rows[row][1][3].strip()}, after {rows[row - 1][1][3].strip()} in the line "
            "before: lines are missing, repeated, or out of order"
        )


def _illuminances(weather: Weather) -> tuple[Floats, Floats, Floats, Floats]:
    """Direct normal and diffuse horizontal illuminance in lx, clearness and brightness of each interval. [Perez 1990]"""
    zenith = np.radians(np.clip(90 - weather.elevation, 0, 90))
    diffuse, direct = weather.diffuse_horizontal, weather.direct_normal
    cube = 1.041 * zenith**3
    with np.errstate(divide="ignore", invalid="ignore"):
        clearness = np.where(diffuse > 0, ((diffuse + direct) / diffuse + cube) / (1 + cube), 1.0)
    clearness = np.clip(clearness, 1.0, 12.0)
    degrees = np.degrees(zenith)
    mass = 1 / (np.cos(zenith) + 0.15 * (93.885 - degrees) ** -1.253)
    day = 2 * np.pi * (_day_of_year(weather) - 1) / 365
    nearer = 1.00011 + 0.034221 * np.cos(day) + 0.00128 * np.sin(day) + 0.000719 * np.cos(2 * day) + 7.7e-5 * np.sin(2 * day)
    brightness = np.clip(diffuse * mass / (SOLAR_CONSTANT * nearer), 0.01, 0.6)
    water = np.exp(0.07 * weather.dew_point - 0.075)
    row = np.searchsorted(_RANGES, clearness, side="right")
    a, b, c, d = _DIFFUSE_EFFICACY[row].T
    of_sky = a + b * water + c * np.cos(zenith) + d * np.log(brightness)
    a, b, c, d = _DIRECT_EFFICACY[row].T
    of_sun = np.maximum(a + b * water + c * np.exp(5.73 * zenith - 5) + d * brightness, 0)
    return direct * of_sun, diffuse * np.maximum(of_sky, 0), clearness, brightness


def _day_of_year(weather: Weather) -> Floats:
    before = np.cumsum([0, 31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30])
    number: Floats = before[weather.month - 1] + weather.day.astype(float)
    return number


_RANGES = np.array([1.065, 1.23, 1.5, 1.95, 2.8, 4.5, 6.2])
_DIFFUSE_EFFICACY = np.array([
    (97.24, -0.46, 12.00, -8.91),
    (107.22, 1.15, 0.59, -3.95),
    (104.97, 2.96, -5.53, -8.77),
    (102.39, 5.59, -13.95, -13.90),
    (100.71, 5.94, -22.75, -23.74),
    (106.42, 3.83, -36.15, -28.83),
    (141.88, 1.90, -53.24, -14.03),
    (152.23, 0.35, -45.27, -7.98),
])  # fmt: skip
"""Of each range of clearness: lm/W of the sky. [Perez 1990, table 4]"""
_DIRECT_EFFICACY = np.array([
    (57.20, -4.55, -2.98, 117.12),
    (98.99, -3.46, -1.21, 12.38),
    (109.83, -4.90, -1.71, -8.81),
    (110.34, -5.84, -1.99, -4.56),
    (106.36, -3.97, -1.75, -6.16),
    (107.19, -1.25, -1.51, -26.73),
    (105.75, 0.77, -1.26, -34.44),
    (101.18, 1.58, -1.10, -8.29),
])  # fmt: skip
"""The same of the sun."""


def sky_light(weather: Weather, interval: int) -> Spec:
    """The light of one interval, for `Scene.add_light`: a `perez-sky` with its sun.

    Args:
        weather: from `read_epw`.
        interval: its number, from 0.
    """
    number = operator.index(interval)
    if not 0 <= number < len(weather):
        raise IndexError(f"interval: there is no number {number}: the weather has {len(weather)} of them, counted from 0")
    direct, diffuse, clearness, brightness = (values[number] for values in _illuminances(weather))
    if weather.elevation[number] <= 0:
        direct = diffuse = 0.0
    return Spec("lights", "perez-sky", {
        "elevation": float(weather.elevation[number]), "azimuth": float(weather.azimuth[number]),
        "direct": f"{direct} lx", "diffuse": f"{diffuse} lx",
        "clearness": float(clearness), "brightness": float(brightness),
    })  # fmt: skip


def sky_matrix(
    weather: Weather, patches: SkyPatches, *, sky: bool = True, sun: bool = True, albedo: float = 0.2
) -> NDArray[np.float32]:
    """How bright each patch is in each interval, by the all-weather sky. [Perez 1993]

    Level ground receives of the patches of the sky just the diffuse illuminance of the weather. The sun is spread over the patch
    in which it stands, with its whole direct normal illuminance. Illuminances follow from irradiances and dew points by
    [Perez 1990].

    Args:
        weather: from `read_epw`.
        patches: as for `coefficients`.
        sky, sun: whether their light counts.
        albedo: of the ground below the horizon.

    Returns:
        luminances in cd/m², an array (patches, intervals); 0 while the sun is below the horizon.
    """
    direct, diffuse, clearness, brightness = _illuminances(weather)
    directions, level, solid = patches.directions, patches.level, patches.solid_angles
    above = directions[1:, 1]
    found = np.zeros((len(patches), len(weather)), np.float32)
    raised, suns = np.radians(weather.elevation), _suns(weather)
    numbers = patches.numbers(suns)
    for hour in np.flatnonzero((weather.elevation > 0) & (direct + diffuse > 0)):
        column = np.zeros(len(patches))
        if sky and diffuse[hour] > 0:
            zenith = np.pi / 2 - raised[hour]
            a, b, c, d, e = _bilux.perez_coefficients(clearness[hour], brightness[hour], zenith)
            cos = np.clip(directions[1:] @ suns[hour], -1, 1)
            relative = (1 + a * np.exp(b / np.maximum(above, 0.01))) * (1 + c * np.exp(d * np.arccos(cos)) + e * cos**2)
            column[1:] = np.maximum(relative, 0)
            column *= diffuse[hour] / max(column @ level, 1e-30)
        ground = sky * diffuse[hour]
        if sun:
            column[numbers[hour]] += direct[hour] / solid[numbers[hour]]
            ground += direct[hour] * suns[hour, 1]
        column[0] = albedo * ground / np.pi
        found[:, hour] = column
    return found


@overload
def coefficients(
    scene: Scene, points: ArrayLike, normals: ArrayLike = ..., *, errors: Literal[False] = False,
    patches: SkyPatches | None = None, spp: int = 4096, progress: bool | Callable[[Progress], object] = False, **settings: Any,
) -> NDArray[np.float32]: ...  # fmt: skip
@overload
def coefficients(
    scene: Scene, points: ArrayLike, normals: ArrayLike = ..., *, errors: Literal[True],
    patches: SkyPatches | None = None, spp: int = 4096, progress: bool | Callable[[Progress], object] = False, **settings: Any,
) -> Measured: ...  # fmt: skip
def coefficients(
    scene: Scene,
    points: ArrayLike,
    normals: ArrayLike = (0.0, 1.0, 0.0),
    *,
    errors: bool = False,
    patches: SkyPatches | None = None,
    spp: int = 4096,
    progress: bool | Callable[[Progress], object] = False,
    **settings: Any,
) -> NDArray[np.float32] | Measured:
    """Measures how much each point receives of the light of each patch of the sky: directly, and after reflections.

    The scene's own lights do not count. The sky is sampled evenly, whatever the windows are.

    Args:
        scene: the scene.
        points, normals: as for `Scene.illuminance`.
        errors: whether to give the standard errors too.
        patches: by default, the 145 of Tregenza.
        spp: samples of each point.
        progress: as for `Scene.render`.
        **settings: as for `Scene.illuminance`, such as `max_depth`: 0 for what comes directly.

    Returns:
        coefficients in sr, an array (points, patches): the illuminance in lx where a patch has 1 cd/m². Multiply it by
        `sky_matrix`, `dc @ sky`, for illuminances in lx. With `errors`, a `Measured` of them and their standard errors.
    """
    patches = SkyPatches() if patches is None else patches
    everything, _ = _coefficients(scene, points, normals, patches, spp, progress, settings)
    return everything if errors else everything.values.astype(np.float32)


def _coefficients(
    scene: Scene,
    points: ArrayLike,
    normals: ArrayLike,
    patches: SkyPatches,
    spp: int,
    progress: bool | Callable[[Progress], object],
    settings: dict[str, Any],
) -> tuple[Measured, Measured]:
    """The coefficients of all light, and of what does not come straight."""
    given, most = scene._measuring(settings | {"spp": spp, "noise": 0, "time_limit": 0})
    points, normals = _sensors(points, normals)
    with following(progress) as callback:
        both = _bilux.daylight_coefficients(scene, points, normals, patches._rows, given, most, callback)
    everything, reflected = (Measured(*(part.astype(np.float64) for part in parts)) for parts in both)
    return everything, reflected


def direct_sunlight(
    scene: Scene,
    points: ArrayLike,
    weather: Weather,
    normals: ArrayLike = (0.0, 1.0, 0.0),
    *,
    progress: bool | Callable[[Progress], object] = False,
    **settings: Any,
) -> Floats:
    """The illuminance of each point by the sun alone, without reflections, in each interval: what `annual_sun_exposure` takes.
    [IES LM-83-12]

    The sun is a point where it stands in the middle of the interval, so that its shadows are exact: no number is random, and none
    is more than the sun gives outdoors. Smooth panes of glass, thin or with parallel faces, let their part of it through.

    Args:
        scene: the scene; its lights do not count.
        points, normals: as for `Scene.illuminance`.
        weather: from `read_epw`.
        progress: as for `Scene.render`.
        **settings: as for `Scene.illuminance`.

    Returns:
        illuminances in lx, an array (points, intervals); 0 while the sun is below the horizon.

    Example:
        >>> scene, weather = bilux.generate("cornell"), bilux.daylight.read_epw("london.epw")
        >>> bilux.daylight.direct_sunlight(scene, [[0.2, 0.1, -0.2]], weather).shape
        (1, 8760)
    """
    direct, _, _, _ = _illuminances(weather)
    shining = np.flatnonzero((weather.elevation > 0) & (direct > 0))
    points, normals = _sensors(points, normals)
    found = np.zeros((len(points), len(weather)))
    given, most = scene._measuring(settings | {"spp": 1, "noise": 0, "time_limit": 0})
    if len(shining):
        with following(progress) as callback:
            parts = _bilux.sunlight(scene, points, normals, _suns(weather)[shining], given, most, callback)
        found[:, shining] = parts * direct[shining]
    return found


def annual_illuminance(
    scene: Scene,
    points: ArrayLike,
    weather: Weather,
    normals: ArrayLike = (0.0, 1.0, 0.0),
    *,
    patches: SkyPatches | None = None,
    spp: int = 4096,
    albedo: float = 0.2,
    progress: bool | Callable[[Progress], object] = False,
    **settings: Any,
) -> Measured:
    """The illuminance of each point in each interval, by sky and sun, and how certain it is.

    What comes straight from the sun is exact, as by `direct_sunlight`. All else is measured by `coefficients` and multiplied by
    `sky_matrix`; only the light of the sun that is reflected comes from a sun as large as its patch. The figures of a year take
    what this returns, and then have standard errors too.

    Args:
        scene, points, normals, patches, spp, progress, **settings: as for `coefficients`; by default there are 577 patches.
        weather: from `read_epw`.
        albedo: of the ground below the horizon.

    Returns:
        illuminances in lx, (points, intervals), and their standard errors.

    Example:
        >>> scene, weather = bilux.Scene(), bilux.daylight.read_epw("london.epw")
        >>> ground = scene.add_mesh([[-9, 0, 9], [9, 0, 9], [9, 0, -9], [-9, 0, -9]], [[0, 1, 2], [0, 2, 3]])
        >>> year = bilux.daylight.annual_illuminance(scene, [[0, 1, 0]], weather, spp=64)
        >>> bilux.daylight.daylight_autonomy(year, occupied=weather.occupied()).errors.shape
        (1,)
    """
    patches = SkyPatches(2) if patches is None else patches
    everything, reflected = _coefficients(scene, points, normals, patches, spp, progress, settings)
    sky = sky_matrix(weather, patches, sun=False, albedo=albedo).astype(np.float64)
    sun = sky_matrix(weather, patches, sky=False, albedo=albedo).astype(np.float64)
    # Of the ground, number 0, all light counts.
    of_sun = Measured(*(np.hstack([a[:, :1], b[:, 1:]]) for a, b in zip(everything, reflected, strict=True)))
    values = everything.values @ sky + of_sun.values @ sun + direct_sunlight(scene, points, weather, normals, **settings)
    # The same samples gave both, so that their errors in one patch add up; those of different patches are independent.
    a, b = everything.errors, of_sun.errors
    variances = a**2 @ sky**2 + 2 * (a * b) @ (sky * sun) + b**2 @ sun**2
    return Measured(values, np.sqrt(variances))


def _suns(weather: Weather) -> Floats:
    """(n, 3) unit vectors to the sun."""
    turned, raised = np.radians(weather.azimuth), np.radians(weather.elevation)
    return np.stack([np.cos(raised) * np.sin(turned), np.sin(raised), -np.cos(raised) * np.cos(turned)], axis=1)


def _hours(illuminance: ArrayLike, occupied: ArrayLike | None) -> Floats:
    """Illuminances, (points, intervals), in the intervals that count."""
    values = np.atleast_2d(np.asarray(illuminance))
    if values.ndim != 2 or 0 in values.shape:
        raise ValueError(f"illuminance: its shape is {values.shape}, but must be (points, intervals), with at least one of each")
    if occupied is None:
        return values
    mask = np.asarray(occupied, bool)
    if mask.shape != values.shape[1:]:
        raise ValueError(f"occupied: its shape is {mask.shape}, but must be {values.shape[1:]}, one for each interval")
    if not mask.any():
        raise ValueError("occupied: no interval counts")
    return values[:, mask]


def _of_points(illuminance: ArrayLike | Measured, occupied: ArrayLike | None, figure: Callable[[Floats], Floats]) -> Measured:
    """A figure of each point, and its error: by what a point is off in one hour, it is off in all, in the same direction."""
    if not isinstance(illuminance, Measured):
        found = figure(_hours(illuminance, occupied))
        return Measured(found, np.zeros_like(found))
    values, errors = _hours(illuminance.values, occupied), _hours(illuminance.errors, occupied)
    apart = figure(values + errors) - figure(np.maximum(values - errors, 0))
    return Measured(figure(values), np.abs(apart) / 2)


def _share(found: Measured, passes: NDArray[np.bool_], limit: float) -> Measured:
    """The fraction of points that pass a limit, and its error: each may belong on the other side of it, by some chance."""
    off = np.abs(found.values - limit)
    pairs = zip(off.tolist(), found.errors.tolist(), strict=True)
    wrong = np.array([0.5 * math.erfc(one / error / math.sqrt(2)) if error > 0 else 0.0 for one, error in pairs])
    return Measured(passes.mean(), np.sqrt((wrong * (1 - wrong)).sum()) / len(wrong))


def _autonomy(illuminance: ArrayLike | Measured, threshold: float, occupied: ArrayLike | None) -> Measured:
    return _of_points(illuminance, occupied, lambda values: (values >= threshold).mean(axis=1))


@overload
def daylight_autonomy(illuminance: Measured, threshold: float = 300.0, occupied: ArrayLike | None = None) -> Measured: ...
@overload
def daylight_autonomy(illuminance: ArrayLike, threshold: float = 300.0, occupied: ArrayLike | None = None) -> Floats: ...
def daylight_autonomy(
    illuminance: ArrayLike | Measured, threshold: float = 300.0, occupied: ArrayLike | None = None
) -> Floats | Measured:
    """(points,) fractions of the time in which daylight alone gives the threshold, in lx. [Reinhart 2006]

    Args:
        illuminance: (points, intervals) in lx, or what `annual_illuminance` returns.
        threshold: in lx.
        occupied: (intervals,) which count; by default all. `Weather.occupied` has the usual hours.

    Returns:
        the fractions; of what has standard errors, a `Measured` of them and theirs.
    """
    found = _autonomy(illuminance, threshold, occupied)
    return found if isinstance(illuminance, Measured) else found.values


@overload
def spatial_daylight_autonomy(
    illuminance: Measured, threshold: float = 300.0, share: float = 0.5, occupied: ArrayLike | None = None
) -> Measured: ...
@overload
def spatial_daylight_autonomy(
    illuminance: ArrayLike, threshold: float = 300.0, share: float = 0.5, occupied: ArrayLike | None = None
) -> float: ...
def spatial_daylight_autonomy(
    illuminance: ArrayLike | Measured, threshold: float = 300.0, share: float = 0.5, occupied: ArrayLike | None = None
) -> float | Measured:
    """The fraction of points with the threshold for this share of the time: sDA(300/50%). [IES LM-83-12]

    Of what has standard errors, as `annual_illuminance` returns it, a `Measured` of it and its own.
    """
    of_points = _autonomy(illuminance, threshold, occupied)
    found = _share(of_points, of_points.values >= share, share)
    return found if isinstance(illuminance, Measured) else float(found.values)


@overload
def useful_daylight_illuminance(
    illuminance: Measured, low: float = 100.0, high: float = 3000.0, occupied: ArrayLike | None = None
) -> Measured: ...
@overload
def useful_daylight_illuminance(
    illuminance: ArrayLike, low: float = 100.0, high: float = 3000.0, occupied: ArrayLike | None = None
) -> Floats: ...
def useful_daylight_illuminance(
    illuminance: ArrayLike | Measured, low: float = 100.0, high: float = 3000.0, occupied: ArrayLike | None = None
) -> Floats | Measured:
    """(points, 3) fractions of the time with less than `low`, from `low` to `high`, and more, in lx. [Nabil 2006]

    Of what has standard errors, as `annual_illuminance` returns it, a `Measured` of them and theirs.
    """

    def figure(values: Floats) -> Floats:
        below, above = (values < low).mean(axis=1), (values > high).mean(axis=1)
        return np.stack([below, 1 - below - above, above], axis=1)

    found = _of_points(illuminance, occupied, figure)
    return found if isinstance(illuminance, Measured) else found.values


@overload
def annual_sun_exposure(
    direct: Measured, threshold: float = 1000.0, hours: float = 250.0, occupied: ArrayLike | None = None, each: int = 1
) -> Measured: ...
@overload
def annual_sun_exposure(
    direct: ArrayLike, threshold: float = 1000.0, hours: float = 250.0, occupied: ArrayLike | None = None, each: int = 1
) -> float: ...
def annual_sun_exposure(
    direct: ArrayLike | Measured,
    threshold: float = 1000.0,
    hours: float = 250.0,
    occupied: ArrayLike | None = None,
    each: int = 1,
) -> float | Measured:
    """The fraction of points that get the threshold, in lx, from the sun directly for more than so many hours: ASE(1000,250).
    [IES LM-83-12]

    Args:
        direct: (points, intervals) illuminances by the sun alone, without reflections: of `direct_sunlight`, which is exact.
        threshold: in lx.
        hours: of the year.
        occupied: as for `daylight_autonomy`.
        each: intervals in an hour.

    Returns:
        the fraction; of what has standard errors, a `Measured` of it and its own.
    """
    of_points = _of_points(direct, occupied, lambda values: (values >= threshold).sum(axis=1).astype(float))
    found = _share(of_points, of_points.values > hours * each, hours * each)
    return found if isinstance(direct, Measured) else float(found.values)


def position_index(directions: ArrayLike, forward: ArrayLike, up: ArrayLike = (0.0, 1.0, 0.0)) -> Floats:
    """(n,) Guth's position indices of (n, 3) directions: how much less a source glares there than ahead; at most 16.

    Above the line of sight by the formula of the IES [IES 2000, eq. 9-19], below it by [Iwata 1997]. Infinite behind.
    """
    front: Floats = np.asarray(forward, float)
    front = front / np.linalg.norm(front)
    right: Floats = np.cross(front, np.asarray(up, float))
    right /= np.linalg.norm(right)
    d = np.asarray(directions, float)
    d = d / np.linalg.norm(d, axis=1, keepdims=True)
    ahead, aside, above = d @ front, d @ right, d @ np.cross(right, front)
    sigma = np.degrees(np.arccos(np.clip(ahead, -1, 1)))
    tau = np.degrees(np.arctan2(np.abs(aside), above))
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        guth = np.exp(
            (35.2 - 0.31889 * tau - 1.22 * np.exp(-2 * tau / 9)) * 1e-3 * sigma
            + (21 + 0.26667 * tau - 0.002963 * tau**2) * 1e-5 * sigma**2
        )
        away = np.minimum(np.hypot(aside, above) / ahead, 3)
    iwata = 1 + np.where(away < 0.6, 0.8, 1.2) * away
    index = np.minimum(np.where(above >= 0, guth, iwata), 16)
    return np.where(ahead > 0, index, np.inf)


def glare_probability(luminance: ArrayLike, camera: Spec, threshold: float | None = None) -> float:
    """The daylight glare probability of a picture: how likely a person who looks ahead is disturbed, from 0 to 1.
    [Wienold 2006, eq. 11]

    DGP = 5.87·10⁻⁵ Ev + 0.0918 log₁₀(1 + Σ L² ω / (Ev^1.87 P²)) + 0.16, of sources with luminance L, solid angle ω and position
    index P, and the illuminance Ev at the eye. It was found for values from 0.2 to 0.8. Each pixel above the threshold counts
    as a source of its own, which is the same as whole sources if these are evenly bright.

    Args:
        luminance: (height, width) in cd/m²: 683 times that of a picture's pixels.
        camera: the camera of the picture, of `bilux.cameras`: one that sees at least half of everything around it, such as
            `fisheye`.
        threshold: in cd/m², above which a pixel glares; by default five times the mean luminance.

    Raises:
        ValueError: if the picture has no two dimensions, or holds what is not finite or the numbers of a picture file; or if the
            camera sees less than half of everything around it.

    Warns:
        UserWarning: if the result is outside of the values for which the formula was found, as it is of pictures in other units.
    """
    seen = _Seen(luminance, camera)
    if seen.eye <= 0:
        warnings.warn("glare_probability: the picture is black, with 0 lx at the eye", stacklevel=2)
        return 0.0
    glaring = seen.glaring(threshold)
    total = float((seen.light[glaring] ** 2 * seen.solid[glaring] / seen.index(glaring) ** 2).sum()) / seen.eye**1.87
    found = float(5.87e-5 * seen.eye + 9.18e-2 * np.log10(1 + total) + 0.16)
    least, most = _FOUND_FOR
    if seen.eye < _DIM:
        warnings.warn(
            f"glare_probability: there are only {seen.eye:.3g} lx at the eye, which is no daylight: is the luminance in cd/m², 683 "
            "times that of a picture's pixels?",
            stacklevel=2,
        )
    elif not least <= found <= most:
        warnings.warn(
            f"glare_probability: {found:.3g}, with {seen.eye:.3g} lx at the eye, is outside of {least} to {most}, for which the "
            "formula was found: is the luminance in cd/m²?",
            stacklevel=2,
        )
    return min(max(found, 0.0), 1.0)


def unified_glare_rating(luminance: ArrayLike, camera: Spec, threshold: float | None = None) -> float:
    """The unified glare rating of a picture: how much the lamps of a room disturb, from 10 (nobody) to 30 (all). [CIE 117]

    UGR = 8 log₁₀(0.25 / Lb Σ L² ω / P²), of lamps with luminance L, solid angle ω and position index P. Lb is the background's
    luminance: the illuminance at the eye without the lamps, over π. Each pixel above the threshold counts as a lamp of its own,
    which is the same as whole lamps if these are evenly bright.

    Args:
        luminance: (height, width) in cd/m²: 683 times that of a picture's pixels.
        camera: the camera of the picture, as for `glare_probability`.
        threshold: in cd/m², above which a pixel belongs to a lamp; by default five times the mean luminance.

    Returns:
        the rating; minus infinity if nothing glares.

    Raises:
        ValueError: as for `glare_probability`, and if all is dark but the lamps, so that there is no background.
    """
    seen = _Seen(luminance, camera)
    glaring = seen.glaring(threshold)
    if not glaring.any():
        return -math.inf
    background = float((seen.light * seen.solid * seen.cos)[~glaring].sum()) / np.pi
    if background <= 0:
        raise ValueError("luminance: all is dark but the lamps, so that there is no background to compare them with")
    total = float((seen.light[glaring] ** 2 * seen.solid[glaring] / seen.index(glaring) ** 2).sum())
    return float(8 * np.log10(0.25 / background * total))


class _Seen:
    """What an eye sees: directions, solid angles and luminances of the pixels of a picture."""

    def __init__(self, luminance: ArrayLike, camera: Spec) -> None:
        given = np.asarray(luminance)
        if given.dtype in (np.bool_, np.uint8, np.uint16):
            raise ValueError(f"luminance: these are numbers of a picture file ({given.dtype}), not luminances in cd/m²")
        values = np.asarray(given, float)
        if values.ndim != 2 or not np.isfinite(values).all():
            raise ValueError("luminance: give an array (height, width) of finite numbers in cd/m²")
        height, width = values.shape
        y, x = np.mgrid[0:height, 0:width]

        def at(dx: float, dy: float) -> Floats:
            return camera.rays(np.stack([x + dx, y + dy], -1).reshape(-1, 2), size=(width, height))[1]

        middle = at(0, 0)
        across, down = at(0.5, 0) - at(-0.5, 0), at(0, 0.5) - at(0, -0.5)
        solid = np.nan_to_num(np.linalg.norm(np.cross(across, down), axis=1))
        seen = np.isfinite(middle).all(axis=1) & (solid > 0)
        self.forward = camera.rays([[(width - 1) / 2, (height - 1) / 2]], size=(width, height))[1][0]
        self.up = camera.parameters.get("up", (0.0, 1.0, 0.0))
        self.middle, self.solid, self.light = middle[seen], solid[seen], values.reshape(-1)[seen]
        self.cos: Floats = np.maximum(self.middle @ self.forward, 0)
        ahead = float(self.solid[self.cos > 0].sum()) / (2 * np.pi)
        if ahead < _WHOLE_VIEW:
            raise ValueError(
                f"camera: it sees {ahead:.0%} of what is ahead of it, but glare is of all that an eye sees: take "
                "bilux.cameras.fisheye with fov=180"
            )
        self.eye = float((self.light * self.solid * self.cos).sum())

    def glaring(self, threshold: float | None) -> NDArray[np.bool_]:
        """(n,) which pixels ahead are brighter than the threshold, by default five times the mean."""
        limit = 5 * float((self.light * self.solid).sum() / self.solid.sum()) if threshold is None else threshold
        bright: NDArray[np.bool_] = (self.light > limit) & (self.cos > 0)
        return bright

    def index(self, which: NDArray[np.bool_]) -> Floats:
        """The position indices of some pixels."""
        return position_index(self.middle[which], self.forward, self.up)


_FOUND_FOR = (0.2, 0.8)
"""The values of the daylight glare probability for which its formula was found. [Wienold 2006]"""

_DIM = 100.0
"""Illuminances at the eye, in lx, that are less are no daylight: the people of [Wienold 2006] had some hundreds at least."""

_WHOLE_VIEW = 0.95
"""The part of the half sphere ahead that a camera must see, less than all since its edge is one of pixels."""
