"""Cameras that were calibrated with OpenCV, by its matrices and its axes: x to the right, y down, z forwards."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from ._bilux import Spec

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    _Numbers = NDArray[np.float64]

ORDER = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4")
"""The order of OpenCV's coefficients; two more tilt the sensor."""

FISHEYE_ORDER = ("k1", "k2", "k3", "k4")

ROUNDING = 1e-6
"""How far a matrix with rounded numbers may be from a rotation."""


def _matrix(K: ArrayLike) -> dict[str, float]:
    """The parameters of a camera matrix.

    Raises:
        ValueError: if it is none.
    """
    numbers = _numbers("K", K)
    if numbers.shape != (3, 3):
        raise ValueError(f"K: its shape is {numbers.shape}, but a camera matrix is (3, 3)")
    below = [(row, column) for row, column in ((1, 0), (2, 0), (2, 1)) if numbers[row, column] != 0]
    if below:
        row, column = below[0]
        advice = "; transpose it: K.T" if np.array_equal(numbers.T, np.triu(numbers.T)) else ""
        found = numbers[row, column]
        raise ValueError(f"K: it must be upper triangular, but K[{row}, {column}] is {found:g}{advice}")
    if numbers[2, 2] == 0:
        raise ValueError("K: K[2, 2] is 0, but must be 1")
    numbers = numbers / numbers[2, 2]
    if numbers[0, 0] <= 0 or numbers[1, 1] <= 0:
        raise ValueError(f"K: the focal lengths {numbers[0, 0]:g} and {numbers[1, 1]:g} must be positive")
    return {
        "fx": float(numbers[0, 0]), "fy": float(numbers[1, 1]), "cx": float(numbers[0, 2]),
        "cy": float(numbers[1, 2]), "skew": float(numbers[0, 1]),
    }  # fmt: skip


def _pose(
    world_to_camera: ArrayLike | None, camera_to_world: ArrayLike | None, R: ArrayLike | None, t: ArrayLike | None
) -> dict[str, tuple[float, ...]]:
    """Position, a point on the axis, and up, of a camera with OpenCV's axes.

    Raises:
        ValueError: if there is no rotation, or more than one.
    """
    if camera_to_world is not None:
        if world_to_camera is not None or R is not None or t is not None:
            raise ValueError("camera_to_world: give it, or world_to_camera, or R and t, not both")
        turn, place = _halves(_numbers("camera_to_world", camera_to_world), "camera_to_world")
        rotation, shift, name = turn.T, -turn.T @ place, "camera_to_world"
    elif world_to_camera is None and R is None and t is None:
        rotation, shift, name = np.eye(3), np.zeros(3), "R"
    elif world_to_camera is not None:
        if R is not None or t is not None:
            raise ValueError("world_to_camera: give it, or R and t, not both")
        rotation, shift, name = *_halves(_numbers("world_to_camera", world_to_camera), "world_to_camera"), "world_to_camera"
    else:
        if R is None or t is None:
            missing = "R" if R is None else "t"
            raise ValueError(f"{missing}: R and t belong together: give both, or world_to_camera")
        rotation, shift, name = _numbers("R", R), _numbers("t", t).reshape(-1), "R"
        if rotation.size == 3:
            rotation = _by_axis(rotation.reshape(-1))
        if rotation.shape != (3, 3):
            raise ValueError(f"R: its shape is {rotation.shape}, but a rotation is (3, 3), or (3,) as OpenCV's rvec")
        if shift.shape != (3,):
            raise ValueError(f"t: it has {shift.size} numbers, but a translation has 3")
    _check_rotation(name, rotation)
    position = -rotation.T @ shift
    # So far ahead that the point, rounded, says the direction.
    ahead = position + rotation[2] * max(1.0, float(np.abs(position).max()))
    return {
        "position": tuple(position.tolist()), "look_at": tuple(ahead.tolist()), "up": tuple((-rotation[1]).tolist()),
    }  # fmt: skip


def _distortion(names: tuple[str, ...], coefficients: ArrayLike | None) -> dict[str, float]:
    """The parameters of OpenCV's coefficients, in its order.

    Raises:
        ValueError: if their number is none that OpenCV has.
    """
    if coefficients is None:
        return {}
    numbers = _numbers("distortion", coefficients).reshape(-1)
    counts = (0, 4) if names == FISHEYE_ORDER else (0, 4, 5, 8, 12, 14)
    if numbers.size not in counts:
        known = ", ".join(map(str, counts))
        raise ValueError(f"distortion: there are {numbers.size} coefficients, but OpenCV has {known}")
    if np.any(numbers[12:] != 0):
        raise ValueError("distortion: the last two coefficients tilt the sensor, which is not supported: they must be 0")
    return {name: float(number) for name, number in zip(names, numbers, strict=False)}


def _sides(size: Any) -> dict[str, int]:
    """Width and height.

    Raises:
        ValueError: if it is no size.
    """
    if size is None:
        raise ValueError("size: give the width and height of the calibrated pictures in pixels, such as size=(640, 480)")
    numbers = _numbers("size", size)
    if numbers.shape != (2,) or np.any(numbers < 1) or np.any(numbers != np.floor(numbers)):
        raise ValueError(f"size: {size!r} is no width and height in pixels, such as (640, 480)")
    return {"width": int(numbers[0]), "height": int(numbers[1])}


def of_opencv(kind: str, make: Callable[..., Spec]) -> Callable[..., Spec]:
    """A function that makes a camera of OpenCV by its matrices, or by `make` if it gets the parameters by their names."""
    order = FISHEYE_ORDER if kind == "opencv-fisheye" else ORDER

    def by_matrices(
        K: ArrayLike | None = None,
        world_to_camera: ArrayLike | None = None,
        *,
        camera_to_world: ArrayLike | None = None,
        distortion: ArrayLike | None = None,
        size: tuple[int, int] | None = None,
        R: ArrayLike | None = None,
        t: ArrayLike | None = None,
        beyond: str = "error",
        name: str = "",
        **parameters: Any,
    ) -> Spec:
        if K is None:
            others = {"world_to_camera": world_to_camera, "camera_to_world": camera_to_world, "distortion": distortion, "size": size, "R": R, "t": t}
            given = [other for other, value in others.items() if value is not None]
            if given:
                raise ValueError(f"{given[0]}: it needs K, the camera matrix")
            return make(name=name, **parameters)
        known = _matrix(K) | _sides(size) | _pose(world_to_camera, camera_to_world, R, t) | _distortion(order, distortion)
        twice = known.keys() & parameters.keys()
        if twice:
            raise ValueError(f"{sorted(twice)[0]}: the matrices say it already")
        return _checked(kind, known | parameters, name, beyond)

    by_matrices.__name__ = by_matrices.__qualname__ = kind.replace("-", "_")
    by_matrices.__doc__ = DOOR.format(function=by_matrices.__name__, order=", ".join(order)) + (make.__doc__ or "")
    return by_matrices


DOOR = """A camera by the matrices of OpenCV, or by the parameters below.

Args:
    K: the camera matrix (3, 3), in pixels whose centres are at whole numbers, as in OpenCV.
    world_to_camera: from points of the world to OpenCV's axes (x to the right, y down, z forwards), in metres: (4, 4) or (3, 4).
    camera_to_world: in place of it, the inverse: where the camera is, and its axes in the world, in OpenCV's directions.
    distortion: OpenCV's coefficients, in its order: {order}.
    size: width and height of the pictures that the camera was calibrated with, in pixels.
    R: in place of world_to_camera: its rotation (3, 3), or OpenCV's rvec (3,).
    t: and its translation (3,).
    beyond: what to do if the distortion folds over within the picture: "error" raises it, "black" leaves these pixels black.
    name: a name for messages and `render(camera=…)`.

Raises:
    ValueError: if K is not upper triangular, R no rotation, or one of the rest does not fit; the message names the argument.

Example:
    >>> K = [[500, 0, 319.5], [0, 500, 239.5], [0, 0, 1]]
    >>> camera = bilux.cameras.{function}(K, R=[0, 0, 0], t=[0, 0, 4], size=(640, 480))
    >>> camera.project([[0, 0, 0]])
    array([[319.5, 239.5]])

"""


def _checked(kind: str, parameters: dict[str, Any], name: str, beyond: str) -> Spec:
    """The camera.

    Raises:
        ValueError: if its principal point is far outside of its pictures, or its distortion folds over inside of them.
    """
    if beyond not in ("error", "black"):
        raise ValueError(f"beyond: {beyond!r} is neither 'error' nor 'black'")
    for centre, side in (("cx", "width"), ("cy", "height")):
        at, extent = parameters[centre], parameters[side]
        if not -0.5 <= at <= extent - 0.5:
            raise ValueError(
                f"size: K has its principal point at {centre} = {at:g}, outside of pictures of "
                f"{parameters['width']}x{parameters['height']}: it belongs to another size; of a part of a larger picture, "
                f"give fx, fy, cx and cy in place of K"
            )
    camera = Spec("cameras", kind, parameters, name)
    for oddity in camera._oddities() if beyond == "error" else ():
        raise ValueError(f"distortion: {oddity}; with beyond='black' this camera can be used nevertheless")
    return camera


def _numbers(name: str, argument: Any) -> _Numbers:
    try:
        numbers = np.asarray(argument, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise TypeError(f"{name}: this is no array of numbers: {error}") from None
    if not np.all(np.isfinite(numbers)):
        raise ValueError(f"{name}: not all of its numbers are finite")
    return numbers


def _halves(both: _Numbers, name: str) -> tuple[_Numbers, _Numbers]:
    """The rotation and the translation of a matrix."""
    if both.shape not in ((4, 4), (3, 4)):
        raise ValueError(f"{name}: its shape is {both.shape}, but must be (4, 4) or (3, 4)")
    if both.shape == (4, 4) and not np.array_equal(both[3], [0, 0, 0, 1]):
        advice = f"; transpose it: {name}.T" if np.array_equal(both[:, 3], [0, 0, 0, 1]) else ""
        raise ValueError(f"{name}: its last row is {both[3].tolist()}, but must be [0, 0, 0, 1]{advice}")
    return both[:3, :3], both[:3, 3]


def _by_axis(turn: _Numbers) -> _Numbers:
    """The rotation around an axis by its length in radians."""
    angle = float(np.linalg.norm(turn))
    x, y, z = turn / (angle or 1.0)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    rotation: _Numbers = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return rotation


def _check_rotation(name: str, rotation: _Numbers) -> None:
    off = float(np.abs(rotation @ rotation.T - np.eye(3)).max())
    if off > ROUNDING:
        scale = float(np.cbrt(abs(np.linalg.det(rotation))))
        advice = f"; it scales by {scale:g}" if abs(scale - 1) > 1e-3 else ""
        raise ValueError(f"{name}: it is no rotation: R R^T is not the identity, but {off:.2g} off{advice}")
    if np.linalg.det(rotation) < 0:
        raise ValueError(f"{name}: it mirrors: its determinant is -1, but a rotation has 1")
