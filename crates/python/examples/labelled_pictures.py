"""Writes a data set: pictures of tumbled boxes and balls under random light, and what is in them, in COCO's form.

For every picture there is NUMBER.png, NUMBER.depth.npy (float32, metres along the ray, infinite for the background) and
NUMBER.objects.npy (uint32, the object of each pixel, 0 for none). instances.json lists the bounding box, the area and the mask of
every visible object.

    python labelled_pictures.py data --count 1000 --size 256
"""

import argparse
import json
import multiprocessing
import pathlib

import numpy as np

import bilux

CATEGORIES = ["box", "ball"]


def box():
    """The vertices and triangles of a cube, each face with vertices of its own."""
    square = np.array([[-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], float)
    turns = [np.roll(np.eye(3), shift, axis=0) * sign for shift in range(3) for sign in (1, -1)]
    faces = [square @ turn if np.linalg.det(turn) > 0 else square[::-1] @ turn for turn in turns]
    first = 4 * np.arange(6)[:, None, None]
    return np.concatenate(faces), (first + [[0, 1, 2], [0, 2, 3]]).reshape(-1, 3)


def ball(rings=24):
    """The vertices and triangles of a sphere of radius 1."""
    theta, phi = np.meshgrid(np.linspace(0, np.pi, rings + 1), np.linspace(0, 2 * np.pi, 2 * rings + 1), indexing="ij")
    vertices = np.stack([np.sin(theta) * np.sin(phi), np.cos(theta), np.sin(theta) * np.cos(phi)], axis=-1)
    row, column = (grid.ravel() for grid in np.meshgrid(np.arange(rings), np.arange(2 * rings), indexing="ij"))
    above = row * (2 * rings + 1) + column
    below = above + 2 * rings + 1
    triangles = np.concatenate([np.stack([above, below, above + 1], 1), np.stack([above + 1, below, below + 1], 1)])
    return vertices.reshape(-1, 3), triangles


def turned(random):
    """A rotation, all equally likely."""
    q, r = np.linalg.qr(random.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q * np.linalg.det(q)


def scene_of(random):
    """A scene, and the category of each of its objects; the floor has none."""
    scene = bilux.Scene()
    floor = bilux.materials.diffuse(reflectance=random.uniform(0.2, 0.8, 3))
    scene.add_mesh([[-20, 0, -20], [-20, 0, 20], [20, 0, 20], [20, 0, -20]], [[0, 1, 2], [0, 2, 3]], material=floor)
    categories = [None]
    for _ in range(random.integers(3, 8)):
        category = int(random.integers(len(CATEGORIES)))
        vertices, triangles = (box, ball)[category]()
        size = random.uniform(0.3, 0.8)
        place = np.eye(4)
        place[:3, :3] = turned(random) * size
        place[:3, 3] = [random.uniform(-2.5, 2.5), 1.2 * size, random.uniform(-2.5, 2.5)]
        material = bilux.materials.principled(
            base_color=random.uniform(0.05, 0.9, 3),
            base_metalness=float(random.integers(2)),
            specular_roughness=random.uniform(0.1, 0.8),
        )
        normals = vertices if category == 1 else None
        scene.add_mesh(vertices, triangles, normals=normals, material=material, transform=place)
        categories.append(category)
    scene.add_light(bilux.lights.environment(radiance=random.uniform(0.1, 0.6) * random.uniform(0.7, 1, 3)))
    position = [*random.uniform(-5, 5, 2), 5.0]
    position[1] = abs(position[1]) + 3
    scene.add_light(bilux.lights.sphere(position=position, radius=0.5, intensity=random.uniform(20, 60)))
    angle = random.uniform(0, 2 * np.pi)
    eye = (7 * np.cos(angle), random.uniform(2.5, 5), 7 * np.sin(angle))
    scene.add_camera(bilux.cameras.perspective(position=eye, look_at=(0, 0.4, 0), fov=40))
    return scene, categories


def runs(mask):
    """The mask's runs of 0 and 1 by columns, as COCO counts them; the first is of 0."""
    flat = mask.ravel(order="F")
    changes = np.flatnonzero(np.diff(flat)) + 1
    lengths = np.diff(np.concatenate([[0], changes, [flat.size]])).tolist()
    return ([0] if flat[0] else []) + lengths


def make(task):
    """Writes one picture, and returns its labels."""
    folder, number, size, spp = task
    random = np.random.default_rng(number)
    scene, categories = scene_of(random)
    picture = scene.render(size=size, spp=spp, seed=number, threads=1, integrator="path", aov=["ids", "depth"])
    picture.save(folder / f"{number:05}.png", exposure="auto", tonemap="agx")
    np.save(folder / f"{number:05}.depth.npy", picture["depth"])
    objects = picture["id"][..., 0]
    np.save(folder / f"{number:05}.objects.npy", objects)
    labels = []
    for index, category in enumerate(categories):
        # Numbers of objects are counted from 1 in pictures.
        mask = objects == index + 1
        if category is None or not mask.any():
            continue
        rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
        x, y, right, bottom = (int(side) for side in (columns[0], rows[0], columns[-1], rows[-1]))
        labels.append(
            {
                "image_id": number,
                "category_id": category,
                "bbox": [x, y, right - x + 1, bottom - y + 1],
                "area": int(mask.sum()),
                "iscrowd": 0,
                "segmentation": {"size": list(mask.shape), "counts": runs(mask)},
            }
        )
    return {"id": number, "file_name": f"{number:05}.png", "width": size, "height": size}, labels


def main(arguments=None):
    """Writes the data set that the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--count", type=int, default=100, help="number of pictures")
    parser.add_argument("--size", type=int, default=256, help="width and height of each, in pixels")
    parser.add_argument("--spp", type=int, default=64, help="samples per pixel")
    parser.add_argument("--processes", type=int, help="by default one a core")
    asked = parser.parse_args(arguments)
    asked.folder.mkdir(parents=True, exist_ok=True)
    tasks = [(asked.folder, number, asked.size, asked.spp) for number in range(asked.count)]
    # Threads do not survive a fork, so processes are started afresh.
    with multiprocessing.get_context("spawn").Pool(asked.processes) as pool:
        made = pool.map(make, tasks)
    labels = [label | {"id": number} for number, label in enumerate(label for _, labels in made for label in labels)]
    categories = [{"id": number, "name": name} for number, name in enumerate(CATEGORIES)]
    instances = {"images": [image for image, _ in made], "annotations": labels, "categories": categories}
    (asked.folder / "instances.json").write_text(json.dumps(instances))
    return instances


if __name__ == "__main__":
    main()
