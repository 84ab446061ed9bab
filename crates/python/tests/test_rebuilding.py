"""One scene is rendered again and again: what did not change is not built again, and the pictures are those of a new
scene, byte for byte, in any thread."""

import pathlib
import threading
import time

import numpy as np
import pytest

import bilux


def ball(rings=36):
    """A sphere of 5040 triangles: vertices and triangles."""
    theta, phi = np.meshgrid(np.linspace(0, np.pi, rings + 1), np.linspace(0, 2 * np.pi, 2 * rings, endpoint=False))
    vertices = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)], -1).reshape(-1, 3)
    i, j = (a.reshape(-1) for a in np.meshgrid(np.arange(2 * rings), np.arange(rings), indexing="ij"))
    a, b = i * (rings + 1) + j, (i + 1) % (2 * rings) * (rings + 1) + j
    upper, lower = np.stack([a, b + 1, a + 1], -1)[j < rings - 1], np.stack([a, b, b + 1], -1)[j > 0]
    return vertices, np.concatenate([upper, lower])


def place(*at):
    matrix = np.eye(4)
    matrix[:3, 3] = at
    return matrix


def room(balls=10):
    """A floor with balls on it, 50,000 triangles in all, a light and a camera."""
    scene = bilux.Scene()
    floor = np.array([[-9, 0, -9], [-9, 0, 9], [9, 0, 9], [9, 0, -9]])
    scene.add_mesh(floor, [[0, 1, 2], [0, 2, 3]])
    gold = bilux.materials.conductor(metal="gold", roughness=0.3)
    for i in range(balls):
        scene.add_mesh(*ball(), material=gold if i % 2 else None, transform=place(3 * (i % 4) - 4.5, 1, -2 * (i // 4)))
    scene.add_light(bilux.lights.rect(position=(0, 8, 0), edge_u=(3, 0, 0), edge_v=(0, 0, 3), radiance=9))
    scene.add_camera(bilux.cameras.perspective(position=(0, 4, 12), look_at=(0, 1, 0)))
    return scene


def add_ball(scene):
    scene.add_mesh(*ball(6), transform=place(0, 3, 0))


def swap_lights(scene):
    scene.lights = [bilux.lights.environment(radiance=(0.4, 0.5, 0.7))]


def swap_cameras(scene):
    scene.cameras = [bilux.cameras.perspective(position=(3, 2, 9), look_at=(0, 1, 0))]


EDITS = {
    "move": lambda scene: scene.set_transform(2, place(0, 2, 1)),
    "move again": lambda scene: scene.set_transform(2, place(1, 2, 1)),
    "move another": lambda scene: scene.set_transform(4, place(-1, 1, 3)),
    "change a material": lambda scene: scene.set_material(1, bilux.materials.dielectric()),
    "add": add_ball,
    "remove": lambda scene: scene.remove(3),
    "change lights": swap_lights,
    "change the camera": swap_cameras,
}


def test_after_every_edit_the_picture_is_that_of_a_new_scene():
    scene, made = room(), []
    for name, edit in EDITS.items():
        edit(scene)
        made.append(edit)
        new = room()
        for before in made:
            before(new)
        wanted = new.render(size=32, spp=4).pixels
        assert np.array_equal(scene.render(size=32, spp=4).pixels, wanted), name
        *_, last = scene.progressive(size=32, spp=4)
        assert np.array_equal(last.pixels, wanted), name


def test_only_what_changed_is_built():
    scene = room()

    def built(**settings):
        return scene.render(**({"size": 16, "spp": 1} | settings)).info["trees_built"]

    assert built() == 1
    assert built() == 0
    assert built(seed=2, size=(20, 12)) == 0
    swap_cameras(scene)
    scene.set_material(1, bilux.materials.mirror())
    scene.materials = [bilux.materials.diffuse(reflectance=0.2), *scene.materials[1:]]
    assert built() == 0, "neither a camera nor a material has a tree"
    scene.set_transform(2, place(0, 2, 1))
    assert built() == 2, "all others once, and what moved"
    scene.set_transform(2, place(0, 3, 1))
    assert built() == 1, "what moved"
    assert scene.copy().render(size=16, spp=1).info["trees_built"] == 0, "copies share trees"


def test_moving_objects_costs_little():
    scene, numbers = room(), np.random.default_rng(1)

    def share(renders):
        pictures = []
        for _ in range(renders):
            for index in (2, 5):
                scene.set_transform(index, place(*numbers.uniform([-4, 1, -4], [4, 3, 4])))
            pictures.append(scene.render(size=128, spp=16, integrator="path"))
        return sum(p.info["build_seconds"] for p in pictures) / sum(p.info["seconds"] for p in pictures)

    share(2)
    again = share(4)
    print(f"building takes {again:.1%} of the time")
    assert again < 0.2


def memory():
    """Megabytes that the process has in memory."""
    path = pathlib.Path("/proc/self/statm")
    if not path.exists():
        pytest.skip("the system does not say how much memory a process has")
    return int(path.read_text().split()[1]) * 4096 / 1e6


def test_many_renders_in_many_threads_end_and_leave_nothing_behind():
    def render(scene, seed=0, threads=1):
        return scene.render(size=12, spp=1, seed=seed, threads=threads, integrator="path").pixels

    shared = room(4)
    wanted = [render(shared, seed) for seed in range(5)]
    failures = []

    def work(number):
        own = shared.copy()
        try:
            for i in range(25):
                seed = (number + i) % 5
                # Others render and change the same scene meanwhile: its picture is that of one state or another.
                shared.set_transform(1, place(-4.5, 1, 0))
                if not np.array_equal(render(shared, seed, threads=2), wanted[seed]):
                    failures.append(f"thread {number}: the shared scene, render {i}")
                own.set_transform(2, place(i / 10, 2, 1))
                new = shared.copy()
                new.set_transform(2, place(i / 10, 2, 1))
                picture = render(own)
                if i % 8 == 0 and not np.array_equal(picture, render(new)):
                    failures.append(f"thread {number}: its own scene, render {i}")
        except BaseException as error:
            failures.append(repr(error))

    def all_threads():
        threads = [threading.Thread(target=work, args=(number,), daemon=True) for number in range(8)]
        end = time.monotonic() + 300
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(max(0, end - time.monotonic()))
        assert not any(thread.is_alive() for thread in threads), "some threads wait for each other"

    all_threads()
    before = memory()
    all_threads()
    assert failures == []
    assert memory() < before + 50, f"{memory() - before:.0f} MB more after 400 renders"
