"""Simulates a picture that many nodes render together, by ranges of its samples: `docs/scaling.md` explains what comes out.

    python simulate.py                     prints the tables
    python simulate.py --measure BILUX     measures the constants on this machine, with this program

It needs nothing but Python. The same seed gives the same tables.
"""

import argparse
import dataclasses
import heapq
import itertools
import math
import pathlib
import random
import statistics
import subprocess
import tempfile


@dataclasses.dataclass(frozen=True)
class Costs:
    """What things take. Measured by `--measure` where it says so, in processor time; assumed where it says so."""

    scene_bytes: float = 0.0
    """Of the scene's files. Measured: the sum of their sizes."""
    start: float = 0.0
    """Seconds until a node can render: a process starts, reads the scene and builds its trees. Measured: one sample of one pixel."""
    sample: float = 0.0
    """Seconds of one core for one sample of every pixel. Measured: the time of 5 samples less that of 1, by 4."""
    film_bytes: float = 0.0
    """Of a partial film, as it is sent or written. Measured: the size of the .exr."""
    merge: float = 0.0
    """Seconds in which the driver reads and adds one partial film. Measured: the time of merging 8 parts less that of 4, by 4."""
    finish: float = 0.0
    """Seconds for writing the merged picture. Measured: the time of merging 4 parts, less 4 times the above."""
    dispatch: float = 0.005
    """Seconds in which the driver gives out one task. Assumed: schedulers such as Ray take from 1 to 10 ms."""
    link: float = 1.25e9
    """Bytes per second between two machines. Assumed: 10 Gbit/s."""
    store: float = 1.25e9
    """Bytes per second of the file system, or of the driver, for all nodes together. Assumed: one link."""


@dataclasses.dataclass(frozen=True)
class Plan:
    """How a picture is split and rendered."""

    nodes: int
    tasks: int
    samples: int = 4096
    cores: int = 16
    kept: bool = True
    """Whether a node keeps the scene built between tasks. Without it, each task is a process of its own."""
    again: bool = True
    """Whether idle nodes do the tasks of slow ones once more; the first answer counts."""
    premerge: bool = False
    """Whether a node adds up the films of its tasks, and sends one at the end."""
    pairs: bool = False
    """Whether the nodes then add up their films in pairs, and the sums in pairs again; the driver gets one film."""
    tree: bool = False
    """Whether nodes that have the scene pass it on: then every other waits for one transfer between two nodes, not for the store."""
    spread: float = 0.1
    """How much the nodes differ in speed: the standard deviation of its logarithm."""
    slow: float = 0.02
    """The fraction of nodes that are slow, by a factor of `slowness`."""
    slowness: float = 4.0


def simulate(plan: Plan, costs: Costs, seed: int) -> float:
    """The seconds until the picture is written."""
    chance = random.Random(seed)
    speeds = [math.exp(chance.gauss(0, plan.spread)) for _ in range(plan.nodes)]
    mean = statistics.mean(speeds)
    speeds = [speed / mean for speed in speeds]
    for node in chance.sample(range(plan.nodes), round(plan.slow * plan.nodes)):
        speeds[node] /= plan.slowness
    work = plan.samples / plan.tasks * costs.sample / plan.cores
    waiting = list(range(plan.tasks))[::-1]
    running: dict[int, dict[int, float]] = {}
    """The nodes at work on each task, and when each began."""
    done: set[int] = set()
    ready = [False] * plan.nodes
    has_sent = [False] * plan.nodes
    driver = store = link = 0.0
    """When the driver, the store, and the driver's link are free."""
    count = itertools.count()
    events = [(0.0, next(count), node, None) for node in range(plan.nodes)]
    heapq.heapify(events)
    end = 0.0
    while events and len(done) < plan.tasks:
        now, _, node, task = heapq.heappop(events)
        if task is not None:
            running.get(task, {}).pop(node, None)
            if task not in done:
                done.add(task)
                if not plan.pairs and not (plan.premerge and has_sent[node]):
                    # The film travels over the driver's link, and the driver adds it.
                    has_sent[node] = True
                    link = max(link, now) + costs.film_bytes / costs.link
                    driver = max(driver, link) + costs.merge
                    end = max(end, driver)
                end = max(end, now)
        if waiting:
            task = waiting.pop()
        elif plan.again and (late := [t for t, nodes in running.items() if t not in done and 0 < len(nodes) < 2]):
            # The one that began first is the likeliest to be on a slow node.
            task = min(late, key=lambda t: min(running[t].values()))
        else:
            continue
        begin = max(driver, now) + costs.dispatch if not plan.premerge else now + costs.dispatch
        if not plan.premerge:
            driver = begin
        if not ready[node] or not plan.kept:
            if plan.tree and store > 0:
                begin = max(begin, store) + costs.scene_bytes / costs.link
            else:
                store = max(store, begin) + costs.scene_bytes / costs.store
                begin = store
            begin += costs.start / min(1.0, speeds[node])
            ready[node] = True
        running.setdefault(task, {})[node] = now
        heapq.heappush(events, (begin + work / speeds[node], next(count), node, task))
    if plan.pairs:
        end += math.ceil(math.log2(max(plan.nodes, 1)) + 1) * (costs.film_bytes / costs.link + costs.merge)
    return end + costs.finish


def median(plan: Plan, costs: Costs) -> float:
    """The median over random nodes."""
    return statistics.median(simulate(plan, costs, seed) for seed in range(5))


def efficiency(plan: Plan, costs: Costs) -> tuple[float, float]:
    """Seconds, and the fraction of them that all cores spend on samples of the picture."""
    seconds = median(plan, costs)
    return seconds, plan.samples * costs.sample / (plan.nodes * plan.cores * seconds)


NODES = [1, 3, 10, 30, 100, 300, 1000]


def table(title: str, rows: dict[str, object], costs: Costs) -> None:
    """Prints, for each row and number of nodes, the seconds and the efficiency. A row makes a plan from a number of nodes."""
    print(f"\n{title}\n")
    print("| | " + " | ".join(str(nodes) for nodes in NODES) + " |\n|" + " --- |" * (len(NODES) + 1))
    for name, plan_of in rows.items():
        cells = []
        for nodes in NODES:
            plan = plan_of(nodes)
            if plan is None:
                cells.append("–")
                continue
            seconds, fraction = efficiency(plan, costs)
            cells.append(f"{seconds:.0f} s, {fraction:.0%}" if seconds >= 10 else f"{seconds:.1f} s, {fraction:.0%}")
        print(f"| {name} | " + " | ".join(cells) + " |")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--measure", type=pathlib.Path, metavar="BILUX", help="the program to measure")
    parser.add_argument("--scene", default="interior", help="the built-in scene to measure")
    parser.add_argument("--size", default="1920x1080")
    asked = parser.parse_args()
    if asked.measure:
        print(measure(asked.measure.resolve(), asked.scene, asked.size))
        return
    print_tables(COSTS)


def print_tables(costs: Costs) -> None:
    """Everything that `docs/scaling.md` shows."""

    def per_node(tasks: int, **more: object):
        return lambda nodes: Plan(nodes, min(tasks * nodes, 4096), **more)

    print(f"one node: {Plan(1, 1).samples * costs.sample / Plan(1, 1).cores:.0f} s of samples, {costs.start:.2f} s to begin")
    table("Tasks for each node", {f"{n} a node": per_node(n) for n in (1, 2, 4, 8, 16)}, costs)
    best = 4
    rows = {
        "as it is": per_node(best),
        "no node is slow": per_node(best, slow=0.0),
        "slow tasks are not given out again": per_node(best, again=False),
        "each task a process (`bilux farm`)": per_node(best, kept=False),
        "one film a node": per_node(best, premerge=True),
        "films are added in pairs": per_node(best, premerge=True, pairs=True),
    }
    table("What it costs", rows, costs)
    large = dataclasses.replace(costs, scene_bytes=2e9, start=costs.start * 2e9 / max(costs.scene_bytes, 1.0))
    rows = {
        "as it is": per_node(best),
        "nodes pass the scene on": per_node(best, tree=True),
        "each task a process (`bilux farm`)": per_node(best, kept=False),
        "films in pairs": per_node(best, premerge=True, pairs=True),
        "films in pairs, nodes pass the scene on": per_node(best, premerge=True, pairs=True, tree=True),
    }
    table("The same with a scene of 2 GB", rows, large)


def measure(program: pathlib.Path, scene: str, size: str) -> Costs:
    """The constants, on this machine."""
    import resource  # Not on Windows.

    with tempfile.TemporaryDirectory() as folder:
        def run(*words: object) -> float:
            """The seconds of processor time that a command takes, which other programs hardly change."""
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            subprocess.run([program, "-q", *map(str, words)], cwd=folder, check=True)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

        # At half the width and height, so four times as fast: everything but the start goes with the pixels.
        width, height = (int(side) // 2 for side in size.split("x"))
        run("generate", scene, "-o", "scene.toml")
        scene_bytes = sum(path.stat().st_size for path in pathlib.Path(folder).iterdir())
        render = ["render", "scene.toml", "--spp", 64, "-i", "path"]
        start = run(*render, "--size", "1x1", "--samples", "0..1", "-o", "one.exr")
        render += ["--size", f"{width}x{height}"]
        parts = [f"part-{number}.exr" for number in range(8)]
        seconds = [run(*render, "--samples", f"{number}..{number + 1}", "-o", part) for number, part in enumerate(parts)]
        five = run(*render, "--samples", "0..5", "-o", "five.exr")
        sample = (five - statistics.mean(seconds)) / 4 * 4
        film_bytes = 4 * statistics.mean((pathlib.Path(folder) / part).stat().st_size for part in parts)
        few, more = run("merge", *parts[:4], "-o", "few.png"), run("merge", *parts, "-o", "more.png")
        merge = (more - few) / 4 * 4
        finish = max(0.0, few * 4 - 4 * merge)
        return Costs(scene_bytes, start, sample, film_bytes, merge, finish)


# Of `interior` (85,374 triangles), 1920x1080, on a virtual machine with AVX-512, as `--measure` printed them.
COSTS = Costs(scene_bytes=3.23e6, start=0.044, sample=9.13, film_bytes=45.0e6, merge=0.204, finish=0.28)

if __name__ == "__main__":
    main()
