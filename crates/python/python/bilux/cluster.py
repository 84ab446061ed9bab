"""Pictures by the machines of a Ray cluster (`pip install bilux[ray]`), the same to the byte as those of one.

`render` divides one picture by its samples; `animation` and `dataset` give each machine whole pictures. A scene is sent
to each node once, and meshes and textures that scenes share are, too. Work that is lost with a node, or late, is given to
others.
"""

from __future__ import annotations

import hashlib
import os
import time as clock
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any

from . import _bilux
from ._bilux import Picture
from ._errors import Interrupted
from ._progress import following
from ._resume import Parts, Pictures
from ._scene import MAX_MEMORY, Scene, _bytes, _layers
from ._types import Progress
from ._workers import Task, Work, Workers

Path = str | os.PathLike[str]

AHEAD = 8
"""How many pictures for each worker may be done before they are asked for."""


def render(
    scene: Scene,
    *,
    address: str | None = None,
    cpus: int | None = None,
    resume: Path | None = None,
    aov: Sequence[str] = (),
    fast: bool = False,
    progress: bool | Callable[[Progress], object] = False,
    preview: Callable[[Picture], object] | None = None,
    max_memory: int = MAX_MEMORY,
    **settings: Any,
) -> Picture:
    """Renders a picture on a cluster: the bytes of `scene.render(…)`, whatever the number of machines.

    The samples are divided among workers, and merged here. `noise` ends the picture at the same sample as on one
    machine, since it is measured here, on the same films; with `time_limit`, a cluster takes more samples.

    Args:
        scene: the scene.
        address: the cluster, as `ray.init` takes it. By default the one that this process is connected to, else all
            cores of this machine.
        cpus: CPUs of each worker; by default, each node has one worker with all of its CPUs.
        resume: a folder that keeps the parts that are done. After the same call again, only the others are rendered.
        aov, fast, progress, max_memory: as for `Scene.render`; all layers but "interval".
        preview: a function that gets the picture so far about every second. If it returns False, rendering stops.
        **settings: all others of `Scene.render`, such as `size`, `spp` and `noise`, but no `crop`.

    Returns:
        the picture. Its `info` also has "workers", "parts", "parts_here" (those that were in `resume`), "given_again"
        (parts that were lost or late), "cpu_seconds" (of CPUs, for the parts that were used) and "scene_bytes" (sent to
        each node).

    Raises:
        Error: if Ray is missing or too old, nodes have another version of bilux, or all workers are lost.
        Interrupted: after Ctrl-C; its `picture` is the picture so far.
        SceneError, RenderError: as for `Scene.render`.

    Example:
        >>> picture = bilux.cluster.render(scene, address="auto", size=(1920, 1080), spp=4096)  # doctest: +SKIP
        >>> picture.save("large.exr")  # doctest: +SKIP
    """
    begun = clock.monotonic()
    given = _settings(scene, settings)
    layers = _layers(aov)
    memory = _bytes(max_memory)
    with Workers(address, cpus) as workers, following(progress) as report:
        work = Work(workers.ship(scene), given, fast, memory)
        workers.begin(Task("plan", "plan", (work,)))
        gathering = _bilux.Gathering(scene, given, layers, fast, memory, scene._time)
        store = None if resume is None else Parts(resume, gathering.fingerprint)
        plan = _plan(workers, store)
        gathering.begin(plan["workers"], plan["threads"], plan["may_crop"])
        done = {"parts": 0, "parts_here": 0}
        samples = rays = 0
        cpu_seconds = 0.0

        def add(part: _Part, film: Any, traced: int) -> None:
            nonlocal samples, rays
            gathering.add(part, film, traced)
            samples += (part[1] - part[0]) * part[4] * part[5]
            rays += traced

        def next_task() -> Task | None:
            while (part := gathering.next_part()) is not None:
                saved = None if store is None else store.read(part)
                if saved is None:
                    return Task(part, "part", (work, part))
                add(part, *saved)
                done["parts_here"] += 1
            return None

        shown = clock.monotonic()
        try:
            for answer in workers.results(next_task, lambda: gathering.done):
                if answer is not None:
                    part, (film, traced, seconds) = answer
                    if store is not None:
                        store.write(part, film, traced)
                    add(part, film, traced)
                    done["parts"] += 1
                    cpu_seconds += seconds
                now = clock.monotonic()
                stop = report is not None and report(samples, gathering.expected, rays, now - begun) is False
                if preview is not None and now - shown > 1 and samples and not gathering.done:
                    so_far = gathering.preview()
                    stop |= so_far is not None and preview(so_far) is False
                    shown = clock.monotonic()
                if stop or gathering.done:
                    break
        except KeyboardInterrupt:
            so_far = gathering.preview()
            raise Interrupted("the render was interrupted; `picture` is the picture so far", so_far) from None
        picture = gathering.picture()
        counts = {"workers": workers.ready, "given_again": workers.given_again, "scene_bytes": workers.shipped_bytes}
        picture.info.update(done | counts | {"cpu_seconds": cpu_seconds, "choice": plan["choice"]})
        return picture


_Part = tuple[int, int, int, int, int, int]


def _plan(workers: Workers, store: Parts | None) -> dict[str, Any]:
    """How the picture is divided: as it was before, if it is resumed, since parts that are done have to fit."""
    if store is not None and (before := store.plan()) is not None:
        return before
    for _ in workers.results(lambda: None, lambda: workers.first_answer is not None):
        pass
    threads, may_crop, choice = workers.first_answer
    plan = {"workers": max(len(workers), 1), "threads": threads, "may_crop": may_crop, "choice": choice}
    if store is not None:
        store.begin(plan)
    return plan


def animation(scene: Scene, times: Iterable[float], **keywords: Any) -> Iterator[Picture]:
    """Renders a scene at several times on a cluster.

    What the scene's keyframes move, moves. Meshes that change their shape with time are read from the file for one time:
    give `dataset` a scene for each.

    Args:
        scene: the scene.
        times: the time of each picture, in seconds.
        **keywords: those of `dataset`, and settings.

    Yields:
        the pictures, in the order of their times.

    Raises:
        Error, SceneError, RenderError: as `render`.

    Example:
        >>> times = [frame / 24 for frame in range(240)]
        >>> for number, picture in enumerate(bilux.cluster.animation(scene, times, spp=64)):  # doctest: +SKIP
        ...     picture.save(f"{number:04}.png")
    """
    return dataset(((scene, {"time": float(time)}) for time in times), **keywords)


def dataset(
    scenes: Iterable[Scene | tuple[Scene, dict[str, Any]]],
    *,
    address: str | None = None,
    cpus: int | None = None,
    resume: Path | None = None,
    aov: Sequence[str] = (),
    fast: bool = False,
    max_memory: int = MAX_MEMORY,
    **settings: Any,
) -> Iterator[Picture]:
    """Renders a picture of each of many scenes on a cluster.

    Scenes are taken as they are needed, so `scenes` may be a generator that changes one scene again and again. Meshes and
    textures that they share are sent to a node once.

    Args:
        scenes: scenes, or pairs of a scene and settings for its picture, such as `{"seed": 7}`.
        address, cpus, aov, fast, max_memory, **settings: as for `render`.
        resume: a folder that keeps the pictures that are done.

    Yields:
        the pictures, in the order of the scenes.

    Raises:
        Error, SceneError, RenderError: as `render`.

    Example:
        >>> def scenes():
        ...     for seed in range(10_000):
        ...         yield random_scene(seed), {"seed": seed}
        >>> for picture in bilux.cluster.dataset(scenes(), size=256, spp=32):  # doctest: +SKIP
        ...     learn_from(picture)
    """
    layers = _layers(aov)
    memory = _bytes(max_memory)
    store = None if resume is None else Pictures(resume)
    coming = iter(scenes)
    names: dict[int, str] = {}
    ready: dict[int, Picture] = {}
    count = first = 0
    ended = False
    with Workers(address, cpus) as workers:
        workers.begin()

        def next_task() -> Task | None:
            nonlocal count, ended
            while len(names) < AHEAD * max(len(workers), 1):
                try:
                    item = next(coming)
                except StopIteration:
                    ended = True
                    return None
                scene, own = item if isinstance(item, tuple) else (item, {})
                given = _settings(scene, settings | own)
                work = Work(workers.ship(scene), given, fast, memory)
                what = f"{work.scene.key} {sorted(given.items())} {layers} {fast}"
                number, count = count, count + 1
                names[number] = f"{number:06}-{hashlib.sha256(what.encode()).hexdigest()[:16]}"
                saved = None if store is None else store.read(names[number])
                if saved is None:
                    return Task(number, "picture", (work, layers))
                ready[number] = saved
            return None

        for answer in workers.results(next_task, lambda: ended and not names):
            if answer is not None:
                number, picture = answer
                if store is not None:
                    store.write(names[number], picture)
                ready[number] = picture
            while first in ready:
                del names[first]
                yield ready.pop(first)
                first += 1


def _settings(scene: Scene, settings: dict[str, Any]) -> dict[str, Any]:
    """The settings as the tables name them."""
    if not isinstance(scene, Scene):
        raise TypeError(f"a {type(scene).__name__} is no bilux.Scene")
    if "crop" in settings:
        raise TypeError("crop: a cluster renders whole pictures: leave it out")
    given = dict.fromkeys(("size", "camera", "time", "exposure")) | settings
    return scene._settings(**given)


__all__ = ["animation", "dataset", "render"]
