"""Views: pictures in a notebook that get better and better, and that the mouse turns.

A `View` renders, and takes messages from whatever shows it: `_widget` by anywidget, `_html` without it.
"""

from __future__ import annotations

import atexit
import threading
import weakref
from collections.abc import Callable, Mapping
from typing import Any

from ._bilux import Picture
from ._orbit import Orbit
from ._scene import Scene

Show = Callable[[bytes, str], object]

_open: weakref.WeakSet[View] = weakref.WeakSet()

DEGREES = 180.0
"""By how much the camera turns while the mouse moves from one side of the picture to the other."""


class View:
    """A picture of a scene in a notebook that gets better and better; drag it to turn the camera, use the wheel to come nearer.

    Made by `Scene.view`. Renders in a thread of its own, beside whatever runs in the notebook.

    Example:
        >>> view = bilux.generate("cornell").view(size=32, spp=2)
        >>> view.wait().info["spp"]
        2
        >>> view.close()
    """

    def __init__(self, scene: Scene, size: tuple[int, int], spp: int, camera: int, settings: dict[str, Any]) -> None:
        self.size = size
        self._scene, self._spp, self._settings = scene, spp, settings
        self._orbit = Orbit(scene, camera)
        self._changed = threading.Condition()
        # Counts what was asked for; a render of anything older stops.
        self._wanted, self._done, self._closed = 1, 0, False
        self._picture: Picture | None = None
        self._error: Exception | None = None
        self._shows: list[Show] = []
        self._last: tuple[bytes, str] | None = None
        self._thread = threading.Thread(target=self._work, name="bilux view", daemon=True)
        self._thread.start()
        _open.add(self)

    @property
    def picture(self) -> Picture | None:
        """The picture so far."""
        return self._picture

    def move(self, turn: float = 0.0, lift: float = 0.0, zoom: float = 1.0) -> None:
        """Moves the camera, and renders anew.

        Args:
            turn: degrees to the right around what it looks at.
            lift: degrees up.
            zoom: a factor by which it comes nearer. The studio's camera, which frames a model without a camera, does not.
        """
        with self._changed:
            self._orbit.move(turn, lift, zoom)
        self.refresh()

    def refresh(self) -> None:
        """Renders anew, after the scene was changed."""
        with self._changed:
            self._wanted += 1
            self._changed.notify_all()

    def wait(self, timeout: float | None = None) -> Picture:
        """Waits until the picture is done.

        Args:
            timeout: seconds.

        Returns:
            the picture with all its samples, or what there is of it after the time.

        Raises:
            TimeoutError: if there is no picture after the time.
            Error: what went wrong with the render.
        """
        with self._changed:
            self._changed.wait_for(lambda: self._closed or self._done == self._wanted, timeout)
            if self._error is not None:
                raise self._error
            if self._picture is None:
                raise TimeoutError("there is no picture yet: wait longer, or make it smaller")
            return self._picture

    def close(self) -> None:
        """Stops rendering. The picture so far stays."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        if threading.current_thread() is not self._thread:
            self._thread.join()

    def receive(self, message: Mapping[str, Any]) -> None:
        """Takes a message from what shows the view: `drag`, by what fraction of the picture's width and height the mouse was
        moved, and `zoom`, a factor. Anything else is ignored, since it comes from outside."""
        try:
            across, down = (float(part) for part in message.get("drag", (0, 0)))
            zoom = float(message.get("zoom", 1))
        except (TypeError, ValueError):
            return
        if abs(across) < 100 and abs(down) < 100 and 0 < zoom < 100 and (across, down, zoom) != (0, 0, 1):
            # The scene follows the mouse, so the camera goes the other way.
            self.move(-across * DEGREES, down * DEGREES * self.size[1] / self.size[0], zoom)

    def show(self, show: Show) -> None:
        """Calls this function with every picture from now on, as a PNG and a line of text, and with the latest at once."""
        with self._changed:
            self._shows.append(show)
            last = self._last
        if last is not None:
            show(*last)

    def _work(self) -> None:
        """Renders what is wanted, over and over."""
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._closed or self._done != self._wanted)
                if self._closed:
                    return
                mine = self._wanted
                seen, more = self._orbit.place(self._scene)
            try:
                self._render(seen, more, mine)
                error = None
            except Exception as raised:
                error = raised
                self._say(b"", str(error))
            with self._changed:
                if mine == self._wanted:
                    self._done, self._error = mine, error
                    self._changed.notify_all()

    def _render(self, seen: Scene, more: dict[str, Any], mine: int) -> None:
        """Renders ever better pictures until another is wanted."""
        shown = False

        def goes_on(_: object = None) -> bool:
            # The first picture is finished even if it is old by then: something is seen while the mouse moves.
            return not self._closed and (not shown or mine == self._wanted)

        for picture in seen.progressive(self.size, spp=self._spp, progress=goes_on, **self._settings | more):
            if not goes_on():
                return
            self._picture, shown = picture, True
            spp = picture.info["spp"]
            self._say(picture._repr_png_(), f"{spp} of {self._spp} samples per pixel")

    def _say(self, png: bytes, text: str) -> None:
        with self._changed:
            self._last = png, text
            shows = list(self._shows)
        for show in shows:
            show(png, text)

    def _repr_mimebundle_(self, **kwargs: Any) -> Any:
        """Shows the view in a notebook."""
        from . import _html, _widget

        widget = _widget.of(self)
        return _html.shown(self) if widget is None else widget._repr_mimebundle_(**kwargs)

    def __repr__(self) -> str:
        width, height = self.size
        return f"<bilux view of {width}x{height} pixels>"


@atexit.register
def _close_all() -> None:
    """Threads that still render must not outlive the interpreter."""
    for view in list(_open):
        view.close()
