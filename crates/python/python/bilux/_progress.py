"""Progress of a render, as a bar."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module

from ._types import Progress

Callback = Callable[[Progress], object]
Native = Callable[[int, int, int, float], object]


@contextmanager
def following(progress: bool | Callback) -> Iterator[Native | None]:
    """What the native part calls, for what the user gave as `progress`."""
    if progress is False or progress is None:
        yield None
    elif progress is True:
        with _bar() as native:
            yield native
    elif callable(progress):
        callback = progress
        yield lambda *numbers: callback(Progress(*numbers))
    else:
        raise TypeError("progress: give True for a bar, or a function that takes a bilux.Progress")


@contextmanager
def _bar() -> Iterator[Native]:
    """A bar by tqdm if it is there, else a line on standard error."""
    try:
        tqdm = import_module("tqdm.auto").tqdm
    except ImportError:
        def line(samples: int, total: int, rays: int, seconds: float) -> None:
            percent = 100 * samples // total if total else 0
            sys.stderr.write(f"\rrendering: {percent}%, {rays / max(seconds, 1e-9) / 1e6:.1f} Mrays/s")

        yield line
        sys.stderr.write("\r\x1b[K")
        return
    with tqdm(total=1, unit="samples", unit_scale=True, leave=False) as bar:
        def update(samples: int, total: int, rays: int, seconds: float) -> None:
            bar.total = total
            bar.n = samples
            bar.set_postfix_str(f"{rays / max(seconds, 1e-9) / 1e6:.1f} Mrays/s", refresh=False)
            bar.refresh()

        yield update
