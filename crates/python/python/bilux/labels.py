"""Data sets: what is in pictures, in the forms of COCO, BOP, KITTI and YOLO.

`instances` says what a camera sees of each object; the writers take that. Masks are exact: one ray through the centre of each
pixel decides.

Example:
    >>> scene = bilux.generate("cornell")
    >>> scene.set_category(5, "box")
    >>> seen = bilux.labels.instances(scene, size=(64, 64))
    >>> coco = bilux.labels.Coco(["box"])
    >>> coco.add("000000.png", seen)
    0
    >>> coco.save("instances.json")
"""

from __future__ import annotations

import json
import os
import pathlib
import struct
import warnings
import zlib
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ._amodal import Amodal, Box, mask_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ._bilux import Picture, Spec
    from ._scene import Scene

    _Numbers = NDArray[np.float64]

__all__ = [
    "Bop", "Coco", "Instance", "compressed", "decoded", "instances", "kitti", "matrices", "polygons", "runs", "write_depth",
    "write_png", "yolo",
]  # fmt: skip

Path = str | os.PathLike[str]


class Instance(NamedTuple):
    """An object in a picture, or several that are one thing.

    Attributes:
        category: what kind of thing it is.
        name: the name of its first object.
        transform: (4, 4) matrix from the mesh of its first object to the scene.
        bounds: (2, 3) corners of the box around all of it, along the axes of that mesh.
        masks: all of it, and what is visible of it.
        time: the moment of all that, in seconds.
    """

    category: str
    name: str
    transform: _Numbers
    bounds: _Numbers
    masks: Amodal
    time: float = 0.0


def instances(
    scene: Scene,
    objects: Sequence[int | Sequence[int]] | None = None,
    *,
    margin: int = 0,
    time: float | None = None,
    **settings: Any,
) -> list[Instance]:
    """Finds what the camera sees of each object that has a category.

    Args:
        scene: the scene.
        objects: objects in place of those; a list of several in the place of a number makes one instance of them.
        margin: pixels on each side of the picture that masks reach beyond it, for objects that it cuts off.
        time: the moment of masks, places and bounds, in seconds; by default that of a render.
        **settings: `size`, `camera` and others, as for `Scene.render`.

    Returns:
        one instance each, also for those of which nothing is visible.

    Raises:
        SceneError: if the meshes of a file move by themselves, and it was read for another time.
    """
    moment = scene._checked_moment(time)
    known = scene._objects_at(moment)
    if objects is None:
        objects = [number for number, one in enumerate(known) if one.category]
    found = scene.amodal(objects, margin=margin, **settings | ({} if time is None else {"time": time}))

    def one(masks: Amodal) -> Instance:
        first = known[masks.objects[0]]
        inverse = np.linalg.inv(first.transform)
        corners = [
            _placed(inverse @ known[number].transform, scene.mesh(number).vertices.astype(np.float64))
            for number in masks.objects
        ]
        points = np.concatenate(corners)
        bounds = np.stack([points.min(0), points.max(0)])
        return Instance(first.category, first.name, first.transform, bounds, masks, moment)

    return [one(masks) for masks in found if masks.objects]


def _placed(matrix: _Numbers, points: _Numbers) -> _Numbers:
    placed: _Numbers = points @ matrix[:3, :3].T + matrix[:3, 3]
    return placed


# Masks.


def _of_mask(mask: ArrayLike) -> NDArray[np.bool_]:
    """A mask, if it is one."""
    inside = np.asarray(mask, dtype=bool)
    if inside.ndim != 2:
        raise ValueError(f"mask: its shape is {inside.shape}, but must be (height, width)")
    return inside


def runs(mask: ArrayLike) -> list[int]:
    """How many pixels are outside and inside of a mask in turn, column by column: COCO's uncompressed masks.

    Args:
        mask: (height, width), of which what is not 0 is inside.

    Example:
        >>> bilux.labels.runs([[0, 1], [0, 1]])
        [2, 2]
    """
    flat = _of_mask(mask).ravel(order="F")
    ends = np.flatnonzero(np.diff(flat)) + 1
    lengths: list[int] = np.diff(np.concatenate([[0], ends, [flat.size]])).tolist()
    return ([0] if flat.size and flat[0] else []) + lengths


def compressed(counts: Iterable[int]) -> str:
    """Runs as COCO writes them into a string.

    Each number, from the third on as the difference to the one two before, is written in groups of five bits, the lowest first;
    a sixth bit says that more follow, and 48 is added to make a character of it. [Lin 2014]

    Example:
        >>> bilux.labels.compressed([2, 2])
        '22'
    """
    text = []
    before = [int(count) for count in counts]
    for i, count in enumerate(before):
        rest = count - before[i - 2] if i > 2 else count
        while True:
            group, rest = rest & 31, rest >> 5
            # The sign is in the highest bit of the last group.
            more = rest != (-1 if group & 16 else 0)
            text.append(chr((group | 32 if more else group) + 48))
            if not more:
                break
    return "".join(text)


def decoded(text: str | bytes) -> list[int]:
    """The runs in a string of COCO's: the inverse of `compressed`.

    Raises:
        ValueError: if the string is none.

    Example:
        >>> bilux.labels.decoded("22")
        [2, 2]
    """
    counts: list[int] = []
    number = shift = 0
    for character in text.encode() if isinstance(text, str) else text:
        group = character - 48
        if not 0 <= group < 64:
            raise ValueError(f"text: the character {chr(character)!r} is not in masks of COCO")
        number |= (group & 31) << shift
        shift += 5
        if group & 32:
            continue
        if group & 16:
            number -= 1 << shift
        counts.append(number + (counts[-2] if len(counts) > 2 else 0))
        number = shift = 0
    if shift:
        raise ValueError("text: it is cut off within a number")
    return counts


def polygons(mask: ArrayLike) -> list[list[float]]:
    """The outlines of a mask along the edges of its pixels, the largest first: COCO's polygons.

    Args:
        mask: (height, width), of which what is not 0 is inside.

    Returns:
        x and y of the corners in turn, from the upper left corner of the picture, of each part that hangs together by the
        sides of its pixels. Holes are filled: these polygons cannot say them, runs can.

    Example:
        >>> bilux.labels.polygons([[0, 0, 0], [0, 1, 0]])
        [[1.0, 1.0, 2.0, 1.0, 2.0, 2.0, 1.0, 2.0]]
    """
    inside = np.pad(_of_mask(mask), 1)
    leaves: dict[tuple[int, int], list[tuple[int, int]]] = {}
    # Edges with the inside on their right, as seen with y downwards.
    for edges, begin, end in (
        (inside[1:, 1:] & ~inside[:-1, 1:], (0, 0), (1, 0)),
        (inside[:-1, 1:] & ~inside[1:, 1:], (1, 0), (0, 0)),
        (inside[1:, 1:] & ~inside[1:, :-1], (0, 1), (0, 0)),
        (inside[1:, :-1] & ~inside[1:, 1:], (0, 0), (0, 1)),
    ):
        rows, columns = np.nonzero(edges)
        for row, column in zip(rows.tolist(), columns.tolist(), strict=True):
            leaves.setdefault((column + begin[0], row + begin[1]), []).append((column + end[0], row + end[1]))
    outlines = []
    while leaves:
        start = next(iter(leaves))
        outline, here, direction = [start], start, (0, 0)
        while True:
            # Where four edges meet, turn right: pixels that only touch at a corner stay apart.
            choices = leaves[here]
            right = (here[0] - direction[1], here[1] + direction[0])
            following = right if right in choices else choices[0]
            choices.remove(following)
            if not choices:
                del leaves[here]
            direction = (following[0] - here[0], following[1] - here[1])
            if following == start:
                break
            outline.append(following)
            here = following
        outlines.append(_corners(outline))
    # Clockwise on the screen is outside, the other way around a hole.
    areas = [(_area(outline), outline) for outline in outlines]
    outer = sorted((pair for pair in areas if pair[0] > 0), key=lambda pair: -pair[0])
    return [[float(side) for corner in outline for side in corner] for _, outline in outer]


def _corners(outline: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """The points where an outline turns."""
    around = zip(outline[-1:] + outline[:-1], outline, outline[1:] + outline[:1], strict=True)
    turns = [here for before, here, after in around if before[0] + after[0] != 2 * here[0] or before[1] + after[1] != 2 * here[1]]
    return turns


def _area(outline: list[tuple[int, int]]) -> float:
    x, y = np.array(outline, dtype=np.float64).T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


# Files.


def write_png(file: Path, numbers: ArrayLike) -> None:
    """Writes a grey picture of whole numbers as a PNG of 8 or 16 bits, as they are.

    Args:
        file: its path.
        numbers: (height, width) of uint8, uint16 or bool; what is true is written as 255.

    Raises:
        ValueError: if the array has another shape or type.
    """
    array = np.asarray(numbers)
    array = array.astype(np.uint8) * np.uint8(255) if array.dtype == bool else array
    if array.ndim != 2 or array.dtype not in (np.uint8, np.uint16) or 0 in array.shape:
        raise ValueError(f"numbers: {array.dtype} of shape {array.shape}, but must be uint8, uint16 or bool (height, width)")
    (height, width), bits = array.shape, 8 * array.dtype.itemsize
    rows = np.ascontiguousarray(array.astype(f">u{array.dtype.itemsize}")).view(np.uint8).reshape(height, -1)
    # Each row says how it is filtered: not at all.
    data = np.concatenate([np.zeros((height, 1), np.uint8), rows], axis=1).tobytes()

    def chunk(kind: bytes, content: bytes) -> bytes:
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    head = struct.pack(">IIBBBBB", width, height, bits, 0, 0, 0, 0)
    whole = chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(data, 6)) + chunk(b"IEND", b"")
    pathlib.Path(file).write_bytes(b"\x89PNG\r\n\x1a\n" + whole)


def write_depth(file: Path, depth: ArrayLike, *, unit: float = 0.001) -> None:
    """Writes depths as a PNG of 16 bits, as depth cameras do.

    Args:
        file: its path.
        depth: (height, width) in metres; z-depth for most readers. What is infinite, or behind the camera, becomes 0, which
            says that there is no depth.
        unit: metres that the number 1 stands for: 0.001 for millimetres, which reach 65.5 m.

    Raises:
        ValueError: if a depth is too far for 16 bits, or the unit is no positive number.
    """
    write_png(file, _steps(depth, unit))


_LARGEST = 65535


def _steps(depth: ArrayLike, unit: float) -> NDArray[np.uint16]:
    """Depths in steps of a unit, both in metres; 0 where there is none."""
    if not 0 < unit < np.inf:
        raise ValueError(f"unit: {unit!r} is no positive number of metres")
    metres = np.asarray(depth, dtype=np.float64)
    steps = np.rint(np.where(np.isfinite(metres) & (metres >= 0), metres, 0) / unit)
    if steps.max(initial=0) > _LARGEST:
        raise ValueError(
            f"depths reach {steps.max() * unit:.6g} m, but 16 bits of {unit * 1e3:.6g} mm hold at most {_LARGEST * unit:.6g} m: "
            "take larger steps, or make what is farther infinite, which is written as 0"
        )
    return steps.astype(np.uint16)


def matrices(camera: Spec, size: tuple[int, int], *, time: float = 0.0) -> tuple[_Numbers, _Numbers]:
    """The matrices of a camera with OpenCV's axes (x to the right, y down, z forwards).

    Args:
        camera: one of `bilux.cameras` whose pictures keep straight lines straight: a pinhole, also with a principal point
            elsewhere.
        size: width and height of its pictures in pixels.
        time: of a camera that moves, the moment in seconds.

    Returns:
        K: (3, 3) camera matrix, in pixels whose centres are at whole numbers.
        world_to_camera: (4, 4), in metres.

    Raises:
        ValueError: if its pictures are distorted, or it has no centre.

    Example:
        >>> camera = bilux.cameras.perspective(position=(0, 0, 4), look_at=(0, 0, 0), fov=90)
        >>> K, world_to_camera = bilux.labels.matrices(camera, (640, 480))
        >>> K.round(3) + 0
        array([[240. ,   0. , 319.5],
               [  0. , 240. , 239.5],
               [  0. ,   0. ,   1. ]])
    """
    width, height = size
    sides = np.array([[0, 0], [width, 0], [0, height], [width, height], [0.37 * width, 0.21 * height]], np.float64)
    origins, rays = camera.rays(sides, size=size, time=time)
    if not np.isfinite(rays).all() or np.abs(origins - origins[0]).max() > 1e-6 * (1 + np.abs(origins[0]).max()):
        raise ValueError("camera: its rays do not come from one point, so that it has no matrix")
    # Rays of a pinhole are a matrix times (column, row, 1); the corners say it but for its scale.
    weights = np.linalg.solve(np.stack([-rays[0], rays[1], rays[2]], axis=1), rays[3])
    corners = rays[:3] * weights[:, None]
    back = np.stack([(corners[1] - corners[0]) / width, (corners[2] - corners[0]) / height, corners[0]], axis=1)
    check = back @ np.append(sides[4], 1)
    if not np.allclose(check / np.linalg.norm(check), rays[4], atol=1e-7):
        raise ValueError("camera: its pictures are distorted, so that no matrix says them: undistort them, or use another form")
    # The inverse is K times a rotation; turned around, QR finds both.
    flip = np.eye(3)[::-1]
    q, r = np.linalg.qr((flip @ np.linalg.inv(back)).T)
    K, rotation = flip @ r.T @ flip, flip @ q.T
    signs = np.sign(np.diag(K))
    K, rotation = K * signs, rotation * signs[:, None]
    world_to_camera = np.eye(4)
    world_to_camera[:3, :3] = rotation
    world_to_camera[:3, 3] = -rotation @ origins[0]
    return K / K[2, 2], world_to_camera


# COCO.


class Coco:
    """Collects pictures and what is in them, in the form of COCO's instances.

    Boxes, areas and masks are those of what is visible.

    Args:
        categories: their names, or their numbers by name; names alone are counted from 1.
        polygons: whether masks are polygons, which fill holes, instead of runs, which are exact.
    """

    def __init__(self, categories: Sequence[str] | Mapping[str, int], *, polygons: bool = False) -> None:
        self._categories = _numbered(categories, 1)
        self._polygons = polygons
        self._images: list[dict[str, Any]] = []
        self._annotations: list[dict[str, Any]] = []

    def add(self, file_name: str, instances: Iterable[Instance], *, size: tuple[int, int] | None = None) -> int:
        """Adds a picture, and returns its number.

        Args:
            file_name: its name in the data set.
            instances: what is in it; those of which nothing is visible are left out.
            size: its width and height in pixels; needed only if there is no instance.

        Raises:
            ValueError: if an instance has a category that is not in the list, or nothing says the size.
        """
        seen = list(instances)
        width, height = size or (_size(seen[0].masks) if seen else (0, 0))
        if not width:
            raise ValueError("size: nothing is in the picture, so give its width and height")
        number = len(self._images)
        self._images.append({"id": number, "file_name": file_name, "width": width, "height": height})
        for instance in seen:
            category = _number_of(instance, self._categories)
            if instance.masks.visible_pixels == 0:
                continue
            mask = _cropped(instance.masks)
            counts = runs(mask)
            self._annotations.append(
                {
                    "id": len(self._annotations) + 1,
                    "image_id": number,
                    "category_id": category,
                    "bbox": list(instance.masks.visible_box or ()),
                    "area": instance.masks.visible_pixels,
                    "iscrowd": 0,
                    "segmentation": polygons(mask)
                    if self._polygons
                    else {"size": [height, width], "counts": compressed(counts)},
                }
            )
        return number

    @property
    def content(self) -> dict[str, Any]:
        """The data set so far, as the file has it."""
        categories = [{"id": number, "name": name} for name, number in self._categories.items()]
        return {"images": self._images, "annotations": self._annotations, "categories": categories}

    def save(self, file: Path) -> None:
        """Writes the file."""
        pathlib.Path(file).write_text(json.dumps(self.content))


def _size(masks: Amodal) -> tuple[int, int]:
    """Width and height of the picture."""
    height, width = masks.size
    return width - 2 * masks.margin, height - 2 * masks.margin


def _cropped(masks: Amodal, *, whole: bool = False) -> NDArray[np.bool_]:
    """The mask of what is visible, or of all, in the picture alone."""
    mask = mask_of(masks.counts if whole else masks.visible_counts, masks.size)
    margin, (width, height) = masks.margin, _size(masks)
    return mask[margin : margin + height, margin : margin + width]


def _numbered(categories: Sequence[str] | Mapping[str, int], first: int) -> dict[str, int]:
    """The numbers of categories by their names, counted from the first if there are only names."""
    names = list(categories)
    numbers = list(categories.values()) if isinstance(categories, Mapping) else list(range(first, first + len(names)))
    lists: list[tuple[str, Sequence[object]]] = [("the name", names), ("the number", numbers)]
    for kind, values in lists:
        twice = [one for one in values if values.count(one) > 1]
        if twice:
            raise ValueError(f"categories: {kind} {twice[0]!r} is there twice, but each category has its own")
    return dict(zip(names, numbers, strict=True))


def _number_of(instance: Instance, categories: Mapping[str, int]) -> int:
    if instance.category not in categories:
        known = ", ".join(categories)
        raise ValueError(f"categories: {instance.category!r}, of the object {instance.name!r}, is none of {known}")
    return categories[instance.category]


# YOLO.


def yolo(
    file: Path,
    instances: Iterable[Instance],
    categories: Sequence[str] | Mapping[str, int],
    *,
    segments: bool = False,
) -> None:
    """Writes what is visible in a picture as YOLO's lines: a class and a box, or a class and an outline.

    Args:
        file: its path.
        instances: what is in the picture; those of which nothing is visible are left out.
        categories: the names of classes, counted from 0, or their numbers by name.
        segments: whether to write outlines instead of boxes. A line has one outline: of what others cut in pieces, the largest.

    Raises:
        ValueError: if an instance has another category.
    """
    numbers = _numbered(categories, 0)
    lines = []
    for instance in instances:
        number, box = _number_of(instance, numbers), instance.masks.visible_box
        if box is None:
            continue
        width, height = _size(instance.masks)
        if segments:
            corners = np.reshape(polygons(_cropped(instance.masks))[0], (-1, 2)) / (width, height)
            values = corners.ravel().tolist()
        else:
            x, y, across, down = box
            values = [(x + across / 2) / width, (y + down / 2) / height, across / width, down / height]
        lines.append(" ".join([str(number), *(f"{value:.6f}" for value in values)]))
    pathlib.Path(file).write_text("".join(line + "\n" for line in lines))


# KITTI.


def kitti(
    file: Path, instances: Iterable[Instance], camera: Spec, size: tuple[int, int], *, forward: ArrayLike = (0, 0, 1)
) -> None:
    """Writes what is visible in a picture as KITTI's lines of objects, with boxes in the picture and in space.

    Boxes in space have the height along y of the object's mesh, and the length along its front; they are exact if it stands
    upright before an upright camera. How much the picture cuts off is known up to the `margin` of `instances`.

    Args:
        file: its path.
        instances: what is in the picture; those of which nothing is visible are left out.
        camera: the camera, a pinhole. If it moves, it counts where it is at the moment of the instances.
        size: width and height of the picture in pixels.
        forward: the direction of an object's front, (3,) along x or z of its mesh, by default z, as in glTF.

    Raises:
        ValueError: if the camera has no matrix, the front is along y, or the instances are of several moments.
    """
    seen = list(instances)
    _, world_to_camera = matrices(camera, size, time=_moment(seen))
    _warn_of_leaning(seen, world_to_camera)
    front = np.asarray(forward, np.float64)
    along = int(np.argmax(np.abs(front)))
    if front.shape != (3,) or along == 1 or not front[along]:
        raise ValueError(f"forward: {forward!r} is no direction along x or z")
    lines = []
    for instance in seen:
        if instance.masks.visible_box is None:
            continue
        to_camera = world_to_camera @ instance.transform
        scales = np.linalg.norm(instance.transform[:3, :3], axis=0)
        extent = (instance.bounds[1] - instance.bounds[0]) * scales
        middle = instance.bounds.mean(0)
        middle[1] = instance.bounds[0, 1]
        x, y, z = _placed(to_camera, middle[None])[0]
        heading = to_camera[:3, :3] @ front
        turn = float(np.arctan2(-heading[2], heading[0]))
        left, top, across, down = instance.masks.visible_box
        inside = int(_cropped(instance.masks, whole=True).sum())
        truncated = 1 - inside / instance.masks.pixels
        visible = instance.masks.visible_pixels / max(inside, 1)
        occluded = 0 if visible > 0.9 else 1 if visible > 0.5 else 2
        numbers = [
            turn - float(np.arctan2(x, z)), left, top, left + across, top + down,
            extent[1], extent[2 - along], extent[along], x, y, z, turn,
        ]  # fmt: skip
        numbers[0] = (numbers[0] + np.pi) % (2 * np.pi) - np.pi
        kind = instance.category.replace(" ", "_")
        lines.append(" ".join([kind, f"{truncated:.2f}", str(occluded), *(f"{number:.4f}" for number in numbers)]))
    pathlib.Path(file).write_text("".join(line + "\n" for line in lines))


def _warn_of_leaning(instances: Sequence[Instance], world_to_camera: _Numbers) -> None:
    """Warns of boxes that are not upright before the camera, as those of KITTI are, such as before one that looks down."""
    for instance in instances:
        up = (world_to_camera @ instance.transform)[:3, 1]
        leaning = float(np.degrees(np.arccos(np.clip(-up[1] / np.linalg.norm(up), -1, 1))))
        if instance.masks.visible_box is not None and leaning > _UPRIGHT:
            warnings.warn(
                f"kitti: boxes in space stand upright before the camera, but {instance.name!r} leans by {leaning:.0f} degrees there, "
                "which its line cannot say: is the camera level, and its pose from the world to the camera?",
                stacklevel=3,
            )
            return


_UPRIGHT = 15.0
"""How far, in degrees, boxes may lean before the camera; those of cars on hills do by some."""


def _moment(instances: Sequence[Instance], shown: float | None = None) -> float:
    """The one moment of instances, and of the picture that shows them, if that is known."""
    moments = sorted({instance.time for instance in instances} | ({shown} if shown is not None else set()))
    if len(moments) > 1:
        seconds = " and ".join(f"{moment:g}" for moment in moments)
        raise ValueError(
            f"instances: they and their picture are of different moments, {seconds} s: give `render` and `instances` the same time"
        )
    return moments[0] if moments else 0.0


# BOP.


class Bop:
    """Writes a scene of a data set in the form of BOP: pictures, depths, masks, and poses in millimetres.

    The folder gets rgb, depth, mask and mask_visib, and, with `save`, scene_camera.json, scene_gt.json and scene_gt_info.json.

    Args:
        folder: of the scene, such as "train_pbr/000000"; it is made if there is none.
        categories: the numbers of models by the category of instances, or names of categories, counted from 1.
        depth_scale: millimetres that the number 1 stands for in files of depth, which reach 65,535 times as far. By default it
            is chosen for each picture, so that its farthest depth fits; scene_camera.json says it.

    Raises:
        ValueError: if the scale is no positive number.
    """

    def __init__(
        self, folder: Path, categories: Sequence[str] | Mapping[str, int], *, depth_scale: float | None = None
    ) -> None:
        if depth_scale is not None and not 0 < depth_scale < np.inf:
            raise ValueError(f"depth_scale: {depth_scale!r} is no positive number of millimetres")
        self._folder = pathlib.Path(folder)
        self._categories = _numbered(categories, 1)
        self._depth_scale = depth_scale
        self._camera: dict[str, Any] = {}
        self._poses: dict[str, Any] = {}
        self._info: dict[str, Any] = {}
        for name in ("rgb", "depth", "mask", "mask_visib"):
            (self._folder / name).mkdir(parents=True, exist_ok=True)

    def add(self, picture: Picture, instances: Iterable[Instance], camera: Spec) -> int:
        """Writes a picture with the layer "z_depth", and what is in it; returns its number.

        Args:
            picture: the picture.
            instances: what is in it. Give `bilux.labels.instances` a margin, since boxes reach beyond the picture.
            camera: the camera, a pinhole. If it moves, it counts where it is at the moment of the picture.

        Raises:
            ValueError: if there is no layer "z_depth", a depth does not fit the scale that was fixed, an instance has another
                category or is of another moment than the picture, or is scaled: poses turn and move.
        """
        if "z_depth" not in picture:
            raise ValueError("picture: it has no layer 'z_depth': render with labels=True or aov=['z_depth']")
        number, size = len(self._camera), (picture.width, picture.height)
        given = list(instances)
        K, world_to_camera = matrices(camera, size, time=_moment(given, picture.info.get("time")))
        seen = [(_number_of(instance, self._categories), instance) for instance in given]
        poses = [_pose(instance, world_to_camera, model) for model, instance in seen]
        scale = _fitting_scale(picture["z_depth"]) if self._depth_scale is None else self._depth_scale
        try:
            depth = _steps(picture["z_depth"], scale * 1e-3)
        except ValueError as error:
            raise ValueError(f"depth_scale: {error}; without depth_scale, it is chosen so that they fit") from None
        picture.save(self._folder / f"rgb/{number:06}.png")
        write_png(self._folder / f"depth/{number:06}.png", depth)
        info = []
        for index, (_, instance) in enumerate(seen):
            masks, name = instance.masks, f"{number:06}_{index:06}.png"
            inside, visible = _cropped(masks, whole=True), _cropped(masks)
            write_png(self._folder / "mask" / name, inside)
            write_png(self._folder / "mask_visib" / name, visible)
            info.append(
                {
                    "bbox_obj": _bop_box(masks.box),
                    "bbox_visib": _bop_box(masks.visible_box),
                    "px_count_all": masks.pixels,
                    "px_count_valid": int(np.count_nonzero(depth[inside])),
                    "px_count_visib": masks.visible_pixels,
                    "visib_fract": masks.visible_fraction,
                }
            )
        self._camera[str(number)] = {
            "cam_K": K.ravel().tolist(),
            "depth_scale": scale,
            "cam_R_w2c": world_to_camera[:3, :3].ravel().tolist(),
            "cam_t_w2c": (world_to_camera[:3, 3] * 1e3).tolist(),
        }
        self._poses[str(number)], self._info[str(number)] = poses, info
        return number

    def save(self) -> None:
        """Writes the files of cameras, poses and visibility."""
        for name, content in (("camera", self._camera), ("gt", self._poses), ("gt_info", self._info)):
            (self._folder / f"scene_{name}.json").write_text(json.dumps(content, indent=1))


def _fitting_scale(depth: ArrayLike) -> float:
    """Millimetres that the number 1 stands for, in two digits, so that the farthest of depths in metres fits into 16 bits."""
    metres = np.asarray(depth, np.float64)
    farthest = float(metres.max(initial=0.0, where=np.isfinite(metres)))
    if farthest <= 0:
        return 0.1
    least = farthest * 1e3 / _LARGEST
    digit = 10.0 ** (int(np.floor(np.log10(least))) - 1)
    # As decimals are written, not with the last bits of a product.
    return float(f"{np.ceil(least / digit * (1 - 1e-12)) * digit:.2g}")


def _bop_box(box: Box | None) -> list[int]:
    """From the first pixel to the last, as `bop_toolkit_lib.misc.calc_2d_bbox`: one less than the pixels across and down."""
    if box is None:
        return [-1, -1, -1, -1]
    x, y, width, height = box
    return [x, y, width - 1, height - 1]


def _pose(instance: Instance, world_to_camera: _Numbers, model: int) -> dict[str, Any]:
    """From the model to the camera, in millimetres."""
    pose = world_to_camera @ instance.transform
    rotation = pose[:3, :3]
    off = float(np.abs(rotation @ rotation.T - np.eye(3)).max())
    if off > 1e-4 or np.linalg.det(rotation) < 0:
        scales = np.linalg.norm(instance.transform[:3, :3], axis=0)
        raise ValueError(
            f"instances: the transform of {instance.name!r} is no rotation and translation (its axes are scaled by "
            f"{scales.round(4).tolist()}), but poses in BOP are: give its mesh in the size that it has"
        )
    return {
        "cam_R_m2c": rotation.ravel().tolist(),
        "cam_t_m2c": (pose[:3, 3] * 1e3).tolist(),
        "obj_id": model,
    }
