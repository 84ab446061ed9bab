"""A camera that the mouse moves around what it looks at."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._bilux import Spec
from ._scene import Scene

_Vector = NDArray[np.float64]

STEEPEST = 85.0
"""The greatest angle in degrees between the camera's line of sight and the ground: from straight above, nothing is up."""


class Orbit:
    """Where a scene is seen from, as the mouse has moved it.

    A scene with a camera is seen by a copy of that camera, which moves around the place that it looks at. A model without one is
    seen by the studio's camera, which keeps its distance.
    """

    def __init__(self, scene: Scene, camera: int = 0) -> None:
        cameras = scene.cameras
        if camera != 0 and not 0 <= camera < len(cameras):
            raise IndexError(f"camera: there is no camera {camera}: the scene has {len(cameras)}, counted from 0")
        self._number = camera
        self._camera: Spec | None = cameras[camera] if cameras else None
        self._turn, self._lift, self._zoom = 0.0, 0.0, 1.0
        if self._camera is None:
            return
        values = self._camera.parameters
        self._eye = np.array(values.get("position", (0, 0, 0)), float)
        ahead = np.array(values.get("look_at", (0, 0, -1)), float) - self._eye
        self._up = _unit(np.array(values.get("up", (0, 1, 0)), float))
        # Many files say only the direction in which a camera looks: what it looks at is next to the middle of the scene.
        middle = np.mean(scene.bounds, axis=0) if scene.bounds else self._eye + ahead
        depth = float(np.dot(middle - self._eye, _unit(ahead)))
        self._pivot = self._eye + _unit(ahead) * (depth if depth > 0 else float(np.linalg.norm(ahead)))
        if abs(self._up[1]) > 0.5:
            # A camera that tilts has an up that tilts too: the ground does not.
            self._up = np.array([0, np.sign(self._up[1]), 0], float)

    def move(self, turn: float, lift: float, zoom: float = 1.0) -> None:
        """Moves the camera to the right and up, in degrees, and nearer by a factor."""
        self._turn = (self._turn + turn) % 360
        self._lift = float(np.clip(self._lift + lift, -2 * STEEPEST, 2 * STEEPEST))
        self._zoom = float(np.clip(self._zoom * zoom, 0.05, 20))

    def place(self, scene: Scene) -> tuple[Scene, dict[str, Any]]:
        """The scene as it is seen, and settings for its render. The scene that is given does not change."""
        if self._turn == 0 and self._lift == 0 and self._zoom == 1:
            return scene, {} if self._camera is None else {"camera": self._number}
        if self._camera is None:
            return scene, {"orbit": f"{_wrapped(26.5 + self._turn)},{np.clip(17.8 + self._lift, -STEEPEST, STEEPEST)}"}
        position = self._pivot + self._moved(self._eye - self._pivot)
        moved = self._camera.with_(position=tuple(position), look_at=tuple(self._pivot), up=tuple(self._up))
        seen = scene.copy()
        seen.cameras = [moved]
        return seen, {"camera": 0}

    def _moved(self, offset: _Vector) -> _Vector:
        """Where the camera has moved to, from its pivot."""
        distance = float(np.linalg.norm(offset))
        height = float(np.dot(offset, self._up)) / distance
        across = offset - np.dot(offset, self._up) * self._up
        # A camera straight above has no direction of its own.
        ahead = _unit(across) if np.linalg.norm(across) > 1e-9 * distance else _any_across(self._up)
        aside = np.cross(self._up, ahead)
        turn = np.radians(self._turn)
        lift = np.radians(np.clip(np.degrees(np.arcsin(np.clip(height, -1, 1))) + self._lift, -STEEPEST, STEEPEST))
        flat = np.cos(turn) * ahead + np.sin(turn) * aside
        moved: _Vector = (np.cos(lift) * flat + np.sin(lift) * self._up) * distance / self._zoom
        return moved


def _unit(vector: _Vector) -> _Vector:
    return vector / max(float(np.linalg.norm(vector)), 1e-30)


def _any_across(up: _Vector) -> _Vector:
    return _unit(np.cross(up, np.eye(3)[int(np.argmin(np.abs(up)))]))


def _wrapped(degrees: float) -> float:
    """The same angle, from -180 to 180."""
    return (degrees + 180) % 360 - 180
