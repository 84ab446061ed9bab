"""Workers on a Ray cluster, which keep scenes built, and what they are given to do."""

from __future__ import annotations

import importlib
import time
from collections import OrderedDict, deque
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple, TypeVar

import numpy as np

from . import _bilux
from ._bilux import Picture, __version__
from ._errors import Error
from ._scene import Scene, _restored

Kept = TypeVar("Kept")

OLDEST_RAY = (2, 9)
"""The oldest version of Ray that has all that is used here."""

SCENES_KEPT = 2
"""How many scenes a worker keeps built."""

DEPTH = 2
"""How many tasks a worker holds: while it does one, the next is on its way."""

LOSSES = 4
"""How many workers a task may lose before it is given up."""

PATIENCE = 120.0
"""Seconds without any worker after which there is an error."""

SLOW = 2.0
"""A task that takes so many times as long as others is given out again."""

BLOBS_KEPT = 1 << 30
"""Bytes of meshes and images that stay in the object store for the next scenes."""


def ray_module() -> Any:
    """Ray.

    Raises:
        Error: if it is missing or too old.
    """
    try:
        ray = importlib.import_module("ray")
    except ImportError as error:
        raise Error(f"bilux.cluster needs Ray: pip install bilux[ray] ({error})") from None
    version = tuple(int(number) for number in ray.__version__.split(".")[:2])
    if version < OLDEST_RAY:
        oldest = ".".join(map(str, OLDEST_RAY))
        raise Error(f"Ray {ray.__version__} is too old: pip install 'ray>={oldest}', on all nodes")
    return ray


class Shipped(NamedTuple):
    """A scene in the object store, from which each node fetches it once."""

    key: str
    document: Any
    blobs: dict[str, Any]
    time: float


class Work(NamedTuple):
    """What is rendered, of which scene."""

    scene: Shipped
    settings: dict[str, Any]
    fast: bool = False
    max_memory: int = 0


class Worker:
    """Renders on one node. Ray makes an actor of it."""

    def __init__(self, threads: int) -> None:
        self._ray = ray_module()
        self._threads = threads
        self._scenes: OrderedDict[str, Scene] = OrderedDict()
        self._renderers: OrderedDict[str, _bilux.PartRenderer] = OrderedDict()

    def version(self) -> str:
        return __version__

    def plan(self, work: Work) -> tuple[int, bool, str | None]:
        """Builds the scene; says how many threads render, whether parts may be windows, and what an integrator that chooses
        has chosen."""
        renderer = self._renderer(work)
        return self._threads, renderer.may_crop(), renderer.choice()

    def part(self, work: Work, part: tuple[int, ...]) -> tuple[Any, int, float]:
        """Renders a part of a picture: its film, and the rays and the seconds of CPUs that it took."""
        begun = time.process_time()
        film, rays, cancelled = self._renderer(work).render(part)  # type: ignore[arg-type]
        if cancelled:
            raise Error("a part of the picture was interrupted on its node")
        return film, rays, time.process_time() - begun

    def picture(self, work: Work, aov: list[str]) -> Picture:
        """Renders a whole picture."""
        scene = self._scene(work.scene)
        return scene._render(
            self._settings(work), aov, None, (None, None), work.fast, work.max_memory, work.scene.time, None
        )

    def _settings(self, work: Work) -> dict[str, Any]:
        return {"threads": self._threads} | work.settings

    def _renderer(self, work: Work) -> _bilux.PartRenderer:
        key = f"{work.scene.key} {sorted(work.settings.items())} {work.fast}"
        if key not in self._renderers:
            scene = self._scene(work.scene)
            self._renderers[key] = _bilux.PartRenderer(
                scene, self._settings(work), work.fast, work.max_memory, work.scene.time
            )
        return _kept(self._renderers, key)

    def _scene(self, shipped: Shipped) -> Scene:
        if shipped.key not in self._scenes:
            document = self._ray.get(shipped.document)
            blobs = dict(zip(shipped.blobs, self._ray.get(list(shipped.blobs.values()))))
            self._scenes[shipped.key] = _restored(Scene, document, blobs, shipped.time)
        return _kept(self._scenes, shipped.key)


def _kept(values: OrderedDict[str, Kept], key: str) -> Kept:
    """A value that is now the last one to be forgotten."""
    values.move_to_end(key)
    while len(values) > SCENES_KEPT:
        values.popitem(last=False)
    return values[key]


class Task(NamedTuple):
    """A call of a worker's method."""

    key: Any
    method: str
    arguments: tuple[Any, ...]


class _Given:
    """A task that was given out."""

    def __init__(self, task: Task) -> None:
        self.task = task
        self.refs: set[Any] = set()
        self.losses = 0


class _Member:
    """A worker, and what it has been given, in order."""

    def __init__(self, actor: Any, node: str, first: list[Any]) -> None:
        self.actor = actor
        self.node = node
        # Its version, and then the answer to the first task, if there is one.
        self.greeting = first
        self.has_answered = False
        self.is_ready = False
        self.held: dict[Any, _Given] = {}
        self.head_since = time.monotonic()


class Workers:
    """All workers of a cluster. A context manager: at its end, they stop.

    Args:
        address: the cluster; None for the one that this process is connected to, else for this machine alone.
        cpus: CPUs of each worker; None for a worker on each node that has all of them.
    """

    def __init__(self, address: str | None, cpus: int | None) -> None:
        self.ray = ray_module()
        self._began_ray = not self.ray.is_initialized()
        if self._began_ray:
            self.ray.init(address=address, log_to_driver=False)
        elif address not in (None, "auto", here := self.ray.get_runtime_context().gcs_address):
            raise ValueError(f"address: this process is connected to the cluster {here}: leave it out, or ray.shutdown()")
        self._cpus = cpus
        self._first: Callable[[], Task] | None = None
        self._actor = self.ray.remote(Worker)
        self._strategy = importlib.import_module("ray.util.scheduling_strategies").NodeAffinitySchedulingStrategy
        self._members: list[_Member] = []
        self._deaths: dict[str, int] = {}
        self._looked = self._alive = time.monotonic()
        self._waiting_since: float | None = None
        self._blobs: OrderedDict[str, tuple[Any, int]] = OrderedDict()
        self._durations: deque[float] = deque(maxlen=32)
        self.first_answer: Any = None
        self.last_loss = ""
        self.shipped_bytes = 0
        self.given_again = 0

    def __enter__(self) -> Workers:
        return self

    def __exit__(self, *_: object) -> None:
        for member in self._members:
            self.ray.kill(member.actor)
        self._members.clear()
        self._blobs.clear()
        if self._began_ray:
            self.ray.shutdown()

    def __len__(self) -> int:
        return len(self._members)

    @property
    def ready(self) -> int:
        """The number of workers that have begun."""
        return sum(member.is_ready for member in self._members)

    def ship(self, scene: Scene) -> Shipped:
        """Puts a scene into the object store; what is there from other scenes is not put there again."""
        encoded = scene._encoded()
        blobs = {}
        for key in encoded.hashes:
            if key not in self._blobs:
                blob = np.frombuffer(encoded.blob(key), np.uint8)
                self._blobs[key] = self.ray.put(blob), blob.nbytes
                self.shipped_bytes += blob.nbytes
            self._blobs.move_to_end(key)
            blobs[key] = self._blobs[key][0]
        while sum(size for _, size in self._blobs.values()) > BLOBS_KEPT and len(self._blobs) > len(blobs):
            self._blobs.popitem(last=False)
        document = encoded.document
        self.shipped_bytes += len(document)
        return Shipped(document[-32:].hex(), self.ray.put(np.frombuffer(document, np.uint8)), blobs, scene._time)

    def begin(self, first: Task | None = None) -> None:
        """Starts a worker on every node. Each does `first` before anything else; `first_answer` is the first result."""
        self._first = None if first is None else lambda: first
        self._refresh(force=True)

    def results(
        self, next_task: Callable[[], Task | None], until: Callable[[], bool] = lambda: True
    ) -> Iterator[tuple[Any, Any] | None]:
        """Keeps all workers busy, and gives the key and the result of each task as it comes; and None now and then.

        Ends when there are no tasks and `until` is true. The tasks of workers that are lost are given to others, and so are those that take
        much longer than the rest: then the first result counts.
        """
        given: dict[Any, _Given] = {}
        again: deque[_Given] = deque()
        while True:
            self._refresh()
            ended = self._give(next_task, given, again)
            if ended and not given and until():
                return
            refs = [ref for member in self._members for ref in [*member.greeting[:1], *list(member.held)[:1]]]
            if not refs:
                time.sleep(0.02)
                yield None
                continue
            done, _ = self.ray.wait(refs, num_returns=1, timeout=0.1)
            if not done:
                yield None
            for ref in done:
                member = next((member for member in self._members if ref in member.greeting or ref in member.held), None)
                if member is None:
                    continue
                try:
                    value = self.ray.get(ref)
                except self.ray.exceptions.RayTaskError as error:
                    raise self._cause(error) from None
                except self.ray.exceptions.RayError as error:
                    self._lose(member, error, given, again)
                    continue
                if ref in member.greeting:
                    self._greeted(member, value)
                    continue
                task = member.held.pop(ref)
                self._durations.append(time.monotonic() - member.head_since)
                member.head_since = time.monotonic()
                if given.pop(task.task.key, None) is not None:
                    if task in again:
                        again.remove(task)
                    yield task.task.key, value

    def _give(
        self, next_task: Callable[[], Task | None], given: dict[Any, _Given], again: deque[_Given]
    ) -> bool:
        """Gives tasks to workers that hold few, and says whether there are no more."""
        ended = False
        for depth in range(1, DEPTH + 1):
            for member in self._members:
                if not member.is_ready or len(member.held) >= depth:
                    continue
                task = again.popleft() if again else None
                if task is None and not ended:
                    new = next_task()
                    ended = new is None
                    task = None if new is None else given.setdefault(new.key, _Given(new))
                if task is None and depth == 1:
                    task = self._slow_task(member)
                    self.given_again += task is not None
                if task is None:
                    continue
                if not member.held:
                    member.head_since = time.monotonic()
                ref = getattr(member.actor, task.task.method).remote(*task.task.arguments)
                member.held[ref] = task
                task.refs.add(ref)
        return ended

    def _slow_task(self, idle: _Member) -> _Given | None:
        """A task that another worker has not begun, or has had for long."""
        usual = sorted(self._durations)[len(self._durations) // 2] if self._durations else 1.0
        now = time.monotonic()
        waits = [
            (0.0 if place else now - member.head_since, task)
            for member in self._members
            if member is not idle
            for place, task in enumerate(member.held.values())
            if len(task.refs) == 1 and (place > 0 or now - member.head_since > SLOW * usual)
        ]
        return max(waits, key=lambda wait: wait[0])[1] if waits else None

    def _greeted(self, member: _Member, value: Any) -> None:
        """Takes the first answers of a worker."""
        member.greeting.pop(0)
        member.has_answered = True
        if isinstance(value, str) and value != __version__:
            raise Error(
                f"node {member.node} has bilux {value}, but this process has {__version__}: install the same version "
                "everywhere"
            )
        if not isinstance(value, str):
            self.first_answer = value if self.first_answer is None else self.first_answer
        member.is_ready = not member.greeting
        member.head_since = time.monotonic()

    def _lose(
        self, member: _Member, error: Exception, given: dict[Any, _Given], again: deque[_Given]
    ) -> None:
        """Forgets a worker, and gives its tasks to others."""
        self._members.remove(member)
        self._deaths[member.node] = self._deaths.get(member.node, 0) + 1
        self.last_loss = str(error).strip().splitlines()[0] if str(error).strip() else type(error).__name__
        if "ModuleNotFoundError" in str(error) or "ImportError" in str(error):
            raise Error(f"node {member.node} cannot import bilux: install it there too ({self.last_loss})")
        self.ray.kill(member.actor)
        for ref, task in member.held.items():
            task.refs.discard(ref)
            task.losses += 1
            if given.get(task.task.key) is not task or task.refs:
                continue
            if task.losses > LOSSES:
                raise Error(
                    f"{task.losses} workers were lost with the same part of the work: a node may have too little memory "
                    f"({self.last_loss})"
                )
            self.given_again += 1
            again.append(task)

    def _cause(self, error: Any) -> Exception:
        """The exception that was raised in a worker."""
        cause = getattr(error, "cause", None)
        return cause if isinstance(cause, Exception) else Error(str(error))

    def _refresh(self, force: bool = False) -> None:
        """Starts workers on nodes that have none."""
        now = time.monotonic()
        if self._members:
            self._alive = now
        elif now - self._alive > PATIENCE:
            reason = f"; the last one was lost: {self.last_loss}" if self.last_loss else ""
            raise Error(f"no node of the cluster has had a CPU for {PATIENCE:.0f} seconds{reason}")
        if not self._members or any(member.is_ready for member in self._members):
            self._waiting_since = None
        elif self._waiting_since is None:
            self._waiting_since = now
        elif now - self._waiting_since > PATIENCE and not any(member.has_answered for member in self._members):
            raise Error(
                f"no worker has started within {PATIENCE:.0f} seconds: other programs may have all CPUs of the cluster"
            )
        if not force and now - self._looked < 1.0:
            return
        self._looked = now
        for node in self.ray.nodes():
            total = int(node["Resources"].get("CPU", 0)) if node["Alive"] else 0
            each = min(self._cpus or total, total)
            if each < 1 or self._deaths.get(node["NodeID"], 0) > LOSSES:
                continue
            have = sum(member.node == node["NodeID"] for member in self._members)
            for _ in range(have, total // each):
                self._start(node["NodeID"], each)

    def _start(self, node: str, cpus: int) -> None:
        strategy = self._strategy(node, soft=False)
        actor = self._actor.options(num_cpus=cpus, scheduling_strategy=strategy).remote(cpus)
        greeting = [actor.version.remote()]
        if self._first is not None:
            first = self._first()
            greeting.append(getattr(actor, first.method).remote(*first.arguments))
        self._members.append(_Member(actor, node, greeting))
