"""What a camera would see of objects if nothing hid them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

Box = tuple[int, int, int, int]


class Amodal(NamedTuple):
    """All of an object in a picture, and what is visible of it (`Scene.amodal`).

    Attributes:
        objects: the numbers of the objects that make it.
        pixels: how many pixels it would cover if nothing hid it, those of the margin included.
        visible_pixels: how many pixels of the picture show it.
        box: column and row of the upper left pixel, width and height of what it would cover, from the picture's upper left
            corner, negative in the margin; None if there is no pixel.
        visible_box: the same of what is visible.
        counts: (n,) numbers of pixels outside and inside of what it would cover in turn, column by column, as in COCO's
            uncompressed masks.
        visible_counts: the same of what is visible.
        size: height and width of these masks, with the margin.
        margin: pixels on each side of the picture.
    """

    objects: tuple[int, ...]
    pixels: int
    visible_pixels: int
    box: Box | None
    visible_box: Box | None
    counts: NDArray[np.uint32]
    visible_counts: NDArray[np.uint32]
    size: tuple[int, int]
    margin: int

    @property
    def visible_fraction(self) -> float:
        """How much of what it would cover is visible, from 0 to 1; 0 if it covers nothing."""
        return self.visible_pixels / self.pixels if self.pixels else 0.0

    @property
    def mask(self) -> NDArray[np.bool_]:
        """What it would cover: (height, width) bool, with the margin."""
        return mask_of(self.counts, self.size)

    @property
    def visible_mask(self) -> NDArray[np.bool_]:
        """What is visible: (height, width) bool, with the margin."""
        return mask_of(self.visible_counts, self.size)


def mask_of(counts: NDArray[Any] | Sequence[int], size: tuple[int, int]) -> NDArray[np.bool_]:
    """The mask with these runs, column by column."""
    inside = np.arange(len(counts)) % 2 == 1
    mask: NDArray[np.bool_] = np.repeat(inside, counts).reshape(size, order="F")
    return mask


def _box(sides: Sequence[int] | None) -> Box | None:
    if sides is None:
        return None
    column, row, width, height = sides
    return column, row, width, height


def amodal_of(groups: Sequence[Sequence[int]], margin: int, masks: Sequence[Any], size: tuple[int, int]) -> list[Amodal]:
    """The masks of groups of objects, as the native part gives them."""
    whole = (size[1] + 2 * margin, size[0] + 2 * margin)

    def one(group: Sequence[int], both: Any) -> Amodal:
        (counts, pixels, box), (seen, visible, seen_box) = both
        return Amodal(tuple(group), pixels, visible, _box(box), _box(seen_box), counts, seen, whole, margin)

    return [one(group, both) for group, both in zip(groups, masks, strict=True)]
