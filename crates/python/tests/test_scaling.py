"""The simulation of `docs/scaling.md` agrees with what can be worked out by hand."""

import dataclasses
import importlib.util
import pathlib
import sys

import pytest

SCRIPT = pathlib.Path(__file__).resolve().parents[3] / "docs/scaling/simulate.py"


@pytest.fixture(scope="module")
def simulation():
    spec = importlib.util.spec_from_file_location("simulate", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    sys.modules["simulate"] = module
    spec.loader.exec_module(module)
    return module


def even(simulation, nodes, tasks, **more):
    """A plan for nodes that are all alike."""
    return simulation.Plan(nodes, tasks, samples=960, spread=0.0, slow=0.0, again=False, **more)


def test_nodes_that_are_alike_share_the_work(simulation):
    free = dataclasses.replace(simulation.COSTS, scene_bytes=0, start=0, film_bytes=0, merge=0, finish=0, dispatch=0)
    alone = simulation.simulate(even(simulation, 1, 1), free, 1)
    assert alone == pytest.approx(960 * free.sample / 16)
    for nodes in (2, 12, 96):
        assert simulation.simulate(even(simulation, nodes, 4 * nodes), free, 1) == pytest.approx(alone / nodes)


def test_a_driver_that_merges_all_films_sets_the_limit(simulation):
    costs = dataclasses.replace(simulation.COSTS, merge=5.0, sample=0.01)
    seconds = simulation.simulate(even(simulation, 96, 480), costs, 1)
    assert seconds == pytest.approx(480 * 5, rel=0.05)
    assert simulation.simulate(even(simulation, 96, 480, premerge=True), costs, 1) < 1.1 * 96 * 5
    assert simulation.simulate(even(simulation, 96, 480, premerge=True, pairs=True), costs, 1) < 10 * 5


def test_a_slow_node_costs_less_when_its_task_is_given_out_again(simulation):
    plan = simulation.Plan(50, 50, spread=0.0, slow=0.02, slowness=20.0)
    again = simulation.simulate(plan, simulation.COSTS, 1)
    waits = simulation.simulate(dataclasses.replace(plan, again=False), simulation.COSTS, 1)
    assert waits > 5 * again


def test_processes_read_the_scene_for_each_task(simulation):
    costs = dataclasses.replace(simulation.COSTS, start=10.0, sample=0.01)
    kept = simulation.simulate(even(simulation, 1, 8), costs, 1)
    each = simulation.simulate(even(simulation, 1, 8, kept=False), costs, 1)
    assert each - kept == pytest.approx(70, abs=1)
