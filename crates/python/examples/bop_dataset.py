"""Writes a data set in the form of BOP: models that lie in a heap on a floor, under random light, with poses, depths and masks.

FOLDER/models has the models and what is known of them, FOLDER/train_pbr/000000 the pictures. Camera and models are those of a
file of BOP's kind: the camera has a matrix K, and poses are in millimetres.

    python bop_dataset.py data --count 1000
"""

import argparse
import json
import pathlib

import numpy as np

import bilux

SIZE = (320, 240)
K = [[300.0, 0, 158.7], [0, 300.0, 121.3], [0, 0, 1]]


def lathe(profile, segments=32):
    """The vertices and triangles of a body of revolution about y; the profile has its radius and height from the bottom up."""
    radius, height = np.array(profile, float).T
    angle = np.linspace(0, 2 * np.pi, segments, endpoint=False)
    vertices = np.stack(np.broadcast_arrays(radius[:, None] * np.sin(angle), height[:, None], radius[:, None] * np.cos(angle)), -1)
    row, column = np.divmod(np.arange((len(profile) - 1) * segments), segments)
    here, beside = row * segments + column, row * segments + (column + 1) % segments
    triangles = np.concatenate([np.stack([here, beside, beside + segments], 1), np.stack([here, beside + segments, here + segments], 1)])
    return vertices.reshape(-1, 3), triangles


# In metres, about their middles.
MODELS = {
    "can": lathe([(0, -0.06), (0.03, -0.06), (0.033, -0.055), (0.033, 0.055), (0.03, 0.06), (0, 0.06)]),
    "bowl": lathe([(0, -0.025), (0.04, -0.025), (0.07, 0.01), (0.08, 0.04), (0.077, 0.04), (0.066, 0.012), (0.038, -0.02), (0, -0.02)]),
    "bottle": lathe([(0, -0.1), (0.035, -0.1), (0.037, -0.09), (0.037, 0.02), (0.015, 0.06), (0.013, 0.1), (0, 0.1)]),
}


def turned(random):
    """A rotation, all equally likely."""
    q, r = np.linalg.qr(random.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q * np.linalg.det(q)


def scene_of(random):
    """A heap of models."""
    scene = bilux.Scene()
    floor = bilux.materials.diffuse(reflectance=random.uniform(0.2, 0.7, 3))
    scene.add_mesh([[-2, 0, -2], [-2, 0, 2], [2, 0, 2], [2, 0, -2]], [[0, 1, 2], [0, 2, 3]], material=floor)
    for _ in range(random.integers(6, 12)):
        name = str(random.choice(list(MODELS)))
        vertices, triangles = MODELS[name]
        place = np.eye(4)
        place[:3, :3] = turned(random)
        place[[0, 2], 3] = random.normal(scale=0.1, size=2)
        # It lies on the floor, or on what is there.
        place[1, 3] = -(vertices @ place[1, :3]).min() + abs(random.normal(scale=0.02))
        material = bilux.materials.principled(
            base_color=random.uniform(0.05, 0.9, 3),
            base_metalness=float(random.random() < 0.3),
            specular_roughness=random.uniform(0.1, 0.7),
        )
        scene.add_mesh(vertices, triangles, material=material, transform=place, name=name, category=name)
    scene.add_light(bilux.lights.environment(radiance=random.uniform(0.1, 0.5, 3)))
    lamp = [*random.uniform(-1, 1, 2), 1.2]
    scene.add_light(bilux.lights.sphere(position=[lamp[0], lamp[2], lamp[1]], radius=0.1, intensity=random.uniform(1, 4)))
    return scene


def camera_of(random):
    """A camera that looks at the heap, by its matrix and its pose with OpenCV's axes."""
    angle, height = random.uniform(0, 2 * np.pi), random.uniform(0.3, 0.7)
    position = np.array([0.6 * np.sin(angle), height, 0.6 * np.cos(angle)])
    forward = np.array([0, 0.04, 0]) - position
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0, 1, 0])
    right /= np.linalg.norm(right)
    world_to_camera = np.eye(4)
    world_to_camera[:3, :3] = right, np.cross(forward, right), forward
    world_to_camera[:3, 3] = -world_to_camera[:3, :3] @ position
    return bilux.cameras.opencv(K, world_to_camera, size=SIZE)


def write_models(folder, numbers):
    """The models in millimetres, and their sizes."""
    folder.mkdir(parents=True, exist_ok=True)
    info = {}
    for name, number in numbers.items():
        vertices, triangles = MODELS[name]
        scene = bilux.Scene()
        scene.add_mesh(vertices * 1e3, triangles)
        scene.save(folder / f"obj_{number:06}.ply")
        low, high = vertices.min(0) * 1e3, vertices.max(0) * 1e3
        apart = vertices[:, None] - vertices[None, ::7]
        sizes = dict(zip(("size_x", "size_y", "size_z"), (high - low).tolist(), strict=True))
        least = dict(zip(("min_x", "min_y", "min_z"), low.tolist(), strict=True))
        info[str(number)] = {"diameter": float(np.sqrt((apart**2).sum(-1)).max() * 1e3), **least, **sizes}
    (folder / "models_info.json").write_text(json.dumps(info, indent=1))


def main(arguments=None):
    """Writes the data set that the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--count", type=int, default=10, help="number of pictures")
    parser.add_argument("--spp", type=int, default=64, help="samples per pixel")
    asked = parser.parse_args(arguments)
    numbers = {name: number for number, name in enumerate(MODELS, 1)}
    write_models(asked.folder / "models", numbers)
    writer = bilux.labels.Bop(asked.folder / "train_pbr/000000", numbers)
    for number in range(asked.count):
        random = np.random.default_rng(number)
        scene, camera = scene_of(random), camera_of(random)
        scene.add_camera(camera)
        picture = scene.render(size=SIZE, spp=asked.spp, seed=number, integrator="path", aov=["z_depth"], exposure="auto", tonemap="agx")
        seen = bilux.labels.instances(scene, size=SIZE, margin=max(SIZE) // 2)
        writer.add(picture, seen, camera)
    writer.save()


if __name__ == "__main__":
    main()
