"""Laser scanners: beam patterns for `Scene.lidar`, and the point clouds that it returns.

Directions are those of the scanner: y is up, and it looks along -z. `pose` puts it into the scene.

Example:
    >>> scene = bilux.generate("trio")
    >>> beams = bilux.lidar.spinning(elevations=[-20, -10, 0], azimuth_step=1.0)
    >>> pose = np.eye(4)
    >>> pose[:3, 3] = 0, 1, 3
    >>> cloud = scene.lidar(beams, pose=pose, range_noise=0.01)
    >>> cloud.points.shape == (len(cloud.range), 3)
    True
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _bilux
from ._tables import Table

_Floats = NDArray[np.float64]
_Integers = NDArray[np.int64]

parameters = Table("lidar", "what can be said of a laser scanner, for `Scene.lidar`")


class Beams(NamedTuple):
    """The pulses of a scan, in the order in which they are fired.

    Attributes:
        directions: (n, 3) directions in the scanner's axes, of any length.
        times: (n,) seconds from the beginning of the scan.
    """

    directions: _Floats
    times: _Floats


class PointCloud(NamedTuple):
    """What a laser scanner measures, one row for each return, in the order of pulses and, of each, by distance.

    Attributes:
        points: (m, 3) points of the scene, in metres: where the pulse would end if it were straight.
        range: (m,) measured distances, in metres.
        intensity: (m,) power that arrives on each square metre at the scanner, of a pulse of power 1, in 1/m².
        object: (m,) numbers of the objects; those after the scene's own are surfaces of lights.
        pulse: (m,) rows of the beams.
        number: (m,) numbers among the returns of the pulse, from 1.
        count: (m,) how many the pulse has.
        time: (m,) times of the pulses, in seconds.
    """

    points: _Floats
    range: _Floats
    intensity: _Floats
    object: _Integers
    pulse: _Integers
    number: _Integers
    # A named tuple has a method of this name, which nobody needs here.
    count: _Integers  # type: ignore[assignment]
    time: _Floats

    def save(self, file: str | os.PathLike[str], *, colours: ArrayLike | None = None) -> None:
        """Writes the points and all that is known of them as a binary PLY file, which `bilux.load` reads as points.

        Args:
            file: the path, which ends in .ply; a file that is there is replaced.
            colours: (m, 3) colours from 0 to 1, sRGB; by default grey, by the logarithm of intensity times squared range.

        Raises:
            ValueError: if the name ends otherwise, or there are more or fewer colours than points.
        """
        path = os.fspath(file)
        if not path.lower().endswith(".ply"):
            raise ValueError(f"file: '{path}' does not end in .ply, the only format that point clouds are written in")
        shown = self._greys() if colours is None else np.asarray(colours, float)
        if shown.shape != (len(self.range), 3):
            raise ValueError(f"colours: their shape is {shown.shape}, but must be ({len(self.range)}, 3), one row for each point")
        columns = {
            "x": ("<f4", self.points[:, 0]),
            "y": ("<f4", self.points[:, 1]),
            "z": ("<f4", self.points[:, 2]),
            "red": ("u1", np.rint(255 * shown[:, 0].clip(0, 1))),
            "green": ("u1", np.rint(255 * shown[:, 1].clip(0, 1))),
            "blue": ("u1", np.rint(255 * shown[:, 2].clip(0, 1))),
            "intensity": ("<f4", self.intensity),
            "object": ("<i4", self.object),
            "return_number": ("u1", self.number.clip(max=255)),
            "number_of_returns": ("u1", self.count.clip(max=255)),
            "time": ("<f8", self.time),
        }
        rows = np.empty(len(self.range), [(name, kind) for name, (kind, _) in columns.items()])
        for name, (_, values) in columns.items():
            rows[name] = values
        words = {"<f4": "float", "<f8": "double", "<i4": "int", "u1": "uchar"}
        properties = "".join(f"property {words[kind]} {name}\n" for name, (kind, _) in columns.items())
        header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(rows)}\n{properties}end_header\n"
        with open(path, "wb") as opened:
            opened.write(header.encode("ascii") + rows.tobytes())

    def _greys(self) -> _Floats:
        """A grey for each point, by how much of the light its surface sends back."""
        back = np.log10(np.maximum(self.intensity * self.range**2, 1e-6))
        low, high = (back.min(), back.max()) if len(back) else (0.0, 1.0)
        return np.repeat(((back - low) / max(high - low, 1e-9) * 0.9 + 0.1)[:, None], 3, axis=1)


def directions(azimuths: ArrayLike, elevations: ArrayLike) -> _Floats:
    """Unit directions in the scanner's axes.

    Args:
        azimuths: degrees from straight ahead (-z), counter-clockwise seen from above.
        elevations: degrees above the horizontal plane. Both of one shape, or of shapes that numpy can broadcast.

    Returns:
        an array of that shape with a last axis of 3.

    Example:
        >>> bilux.lidar.directions(90, 0).round(6) + 0.0
        array([-1.,  0.,  0.])
    """
    across, up = np.radians(np.asarray(azimuths, float)), np.radians(np.asarray(elevations, float))
    across, up = np.broadcast_arrays(across, up)
    return np.stack([-np.sin(across) * np.cos(up), np.sin(up), -np.cos(across) * np.cos(up)], axis=-1)


def spinning(
    elevations: ArrayLike,
    azimuth_step: float,
    *,
    azimuths: tuple[float, float] = (0, 360),
    frequency: float = 10,
    turns: float = 1,
) -> Beams:
    """A column of lasers that turns around the vertical axis, and fires all of them at once after each step.

    Args:
        elevations: degrees above the horizontal plane, one for each laser.
        azimuth_step: degrees between firings.
        azimuths: the part of a turn within which it fires, in degrees, counter-clockwise from straight ahead.
        frequency: turns per second.
        turns: how long it turns.

    Raises:
        ValueError: if a number is not positive, or nothing is fired.

    Example:
        >>> bilux.lidar.spinning([-10, 0, 10], 0.5, frequency=20).directions.shape
        (2160, 3)
    """
    up = np.atleast_1d(np.asarray(elevations, float))
    _check_positive(azimuth_step=azimuth_step, frequency=frequency, turns=turns)
    turned = np.arange(int(np.floor(360 * turns / azimuth_step + 1e-9))) * azimuth_step
    fires = ((turned - azimuths[0]) % 360 <= azimuths[1] - azimuths[0]) | (azimuths[1] - azimuths[0] >= 360)
    turned = turned[fires]
    if up.ndim != 1 or len(up) == 0 or len(turned) == 0:
        raise ValueError("elevations, azimuth_step: no pulse is fired: give at least one elevation, and steps within the turn")
    times = np.repeat(turned / (360 * frequency), len(up))
    return Beams(directions(turned[:, None], up).reshape(-1, 3), times)


def raster(size: tuple[int, int], fov: tuple[float, float], *, duration: float = 0) -> Beams:
    """Columns and rows of directions, evenly spaced in angle, as solid-state scanners have: from the upper left, row by row.

    Args:
        size: the number of columns and rows.
        fov: the angles from the first to the last column and row, in degrees.
        duration: seconds from the first pulse to the last; 0 if all are fired at once.

    Raises:
        ValueError: if there are no columns or rows, or the duration is negative.

    Example:
        >>> beams = bilux.lidar.raster((64, 32), (60, 30), duration=0.05)
        >>> beams.directions.shape, float(beams.times[-1])
        ((2048, 3), 0.05)
    """
    columns, rows = (int(side) for side in size)
    if columns < 1 or rows < 1 or not duration >= 0:
        raise ValueError(f"size, duration: {size} at {duration} s is no raster: give at least one column and row, and no time before 0")
    across, up = np.linspace(fov[0] / 2, -fov[0] / 2, columns), np.linspace(fov[1] / 2, -fov[1] / 2, rows)
    return Beams(directions(across, up[:, None]).reshape(-1, 3), np.linspace(0, duration, columns * rows))


def _check_positive(**numbers: float) -> None:
    for name, number in numbers.items():
        if not (np.isfinite(number) and number > 0):
            raise ValueError(f"{name}: {number} is not positive: give a number above 0")


def _scanned(scene: _bilux.Scene, beams: Beams | ArrayLike, pose: ArrayLike | None, time: float, given: dict[str, Any]) -> PointCloud:
    """See `Scene.lidar`."""
    if not isinstance(beams, Beams):
        given_directions = np.asarray(beams, float)
        beams = Beams(given_directions, np.zeros(len(given_directions) if given_directions.ndim else 0))
    local, times = np.asarray(beams.directions, float), np.asarray(beams.times, float)
    if local.ndim != 2 or local.shape[1] != 3 or times.shape != local.shape[:1]:
        raise ValueError(
            f"beams: directions of shape {local.shape} and times of shape {times.shape}: give (n, 3) directions and n times"
        )
    matrices = np.eye(4) if pose is None else np.asarray(pose, float)
    if matrices.shape not in [(4, 4), (len(local), 4, 4)]:
        raise ValueError(f"pose: its shape is {matrices.shape}, but must be (4, 4), or ({len(local)}, 4, 4) with one for each pulse")
    turns = matrices[..., :3, :3]
    error = np.abs(turns @ np.swapaxes(turns, -1, -2) - np.eye(3)).max()
    if not (error < 1e-4 and (np.linalg.det(turns) > 0).all()):
        raise ValueError(f"pose: its upper left part is no rotation: its product with its transpose is off by {error:.3g}")
    world = np.einsum("...ij,nj->ni" if turns.ndim == 2 else "nij,nj->ni", turns, local)
    origins = np.broadcast_to(matrices[..., :3, 3], world.shape)
    found = _bilux.scan(scene, origins, world, np.ascontiguousarray(times + time), given)
    pulse, number, count, distance, intensity, objects = found
    unit = world / np.linalg.norm(world, axis=1, keepdims=True)
    points = origins[pulse] + unit[pulse] * distance[:, None]
    return PointCloud(points, distance, intensity, objects, pulse, number, count, times[pulse] + time)


__all__: Sequence[str] = ["Beams", "PointCloud", "directions", "parameters", "raster", "spinning"]
