"""The exceptions of Bilux. Wrong arguments are also `TypeError` and `ValueError`, as everywhere in Python."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ._bilux import Picture


class Error(Exception):
    """Anything that can go wrong in Bilux. The message says what is wrong, where, and what to do."""


class SceneError(Error, ValueError):
    """A name or a value in a scene, or a setting of a render, is wrong."""


class FormatError(Error, ValueError):
    """A scene file is broken, or in no format that Bilux reads."""


class PictureError(Error, ValueError):
    """A picture is broken, or in no format that Bilux reads or writes, or it has not what was asked for."""


class RenderError(Error):
    """A render is impossible, such as one that takes more memory than is allowed."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C has stopped a render.

    Attributes:
        picture: the picture so far.
    """

    def __init__(self, message: str = "", picture: Picture | None = None) -> None:
        super().__init__(message)
        self.picture = picture


class SceneWarning(UserWarning):
    """Something in a scene is odd, but it can be rendered."""
