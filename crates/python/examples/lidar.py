# %% [markdown]
# # A laser scanner on a street
# What a spinning laser scanner measures of a street: a car that moves while it turns, a shop behind its window, and points that are not
# there, which a mirror shows.

# %%
import numpy as np

import bilux

# %% [markdown]
# The street: boxes of matt paint, a window, and a mirror, such as a glazed front. Lengths are in metres, y is up.

# %%
CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (0, 1) for z in (-0.5, 0.5)], float)
FACES = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
scene = bilux.Scene()


def placed(at, size):
    return np.block([[np.diag(size), np.array(at, float)[:, None]], [0, 0, 0, 1]])


def box(name, at, size, material=None, reflectance=0.5):
    material = material or bilux.materials.diffuse(reflectance=reflectance)
    return scene.add_mesh(CORNERS, FACES, material=material, transform=placed(at, size), name=name)


box("road", (0, -0.1, 0), (60, 0.1, 60), reflectance=0.1)
box("house", (-12, 0, -6), (4, 7, 16), reflectance=0.6)
box("far house", (5, 0, -16), (22, 6, 3), reflectance=0.4)
box("shelf", (11.5, 0, -2), (0.5, 2, 5), reflectance=0.7)
for z in range(-10, 12, 4):
    box("post", (-6, 0, z), (0.15, 1.2, 0.15), reflectance=0.8)
pane = bilux.materials.dielectric(thin=True)
scene.add_mesh([[9, 0, -6], [9, 3, -6], [9, 3, 2], [9, 0, 2]], [[0, 1, 2], [0, 2, 3]], material=pane, name="window")
mirror = bilux.materials.mirror(reflectance=0.7)
scene.add_mesh([[-7, 0, 10], [-7, 4, 10], [3, 4, 13], [3, 0, 13]], [[0, 1, 2], [0, 2, 3]], material=mirror, name="mirror")
car = box("car", (-2, 0.3, -8), (1.8, 1.4, 4.2), reflectance=0.3)
path = [placed((-2, 0.3, z), (1.8, 1.4, 4.2)) for z in (-8, -5)]
scene.set_keyframes(car, [0, 0.1], path)

# %% [markdown]
# The scanner: 48 lasers, 0.4° between firings, ten turns a second. Each pulse is 3 mrad wide, so at edges it returns twice.

# %%
beams = bilux.lidar.spinning(np.linspace(-22, 8, 48), 0.4, frequency=10)
pose = placed((0, 1.8, 2), (1, 1, 1))
cloud = scene.lidar(beams, pose=pose, divergence=3, rays=7, max_range=60, range_noise=0.01, seed=1)
names = np.array([one.name for one in scene.objects])
print(f"{len(beams.times)} pulses, {len(cloud.range)} returns, {(cloud.count > 1).sum()} of them not the only one")
for name in ["shelf", "car", "post"]:
    print(f"{name}: {(names[cloud.object] == name).sum()} returns")

# %% [markdown]
# What the mirror shows seems to be behind it. The way there is known, so such points can be told: nothing is straight ahead of them
# but the mirror.

# %%
straight = scene.lidar(beams, pose=pose, max_events=0, max_range=60)
direct = np.zeros(len(beams.times), bool)
direct[straight.pulse] = True
ghosts = ~direct[cloud.pulse]
print(f"{ghosts.sum()} returns came by the mirror or through the window")

# %% [markdown]
# The point cloud is written, read as a scene of points, and rendered from above: blue where the way was straight, by height, and red
# where it was not.

# %%
height = (cloud.points[:, 1] / 7).clip(0, 1)
colours = np.stack([0.2 + 0.5 * height, 0.35 + 0.5 * height, 0.9 - 0.3 * height], axis=1)
colours[ghosts] = 1, 0.15, 0.1
cloud.save("cloud.ply", colours=colours)
points = bilux.load("cloud.ply")
points.add_camera(bilux.cameras.perspective(position=(4, 26, 30), look_at=(0, 0, -1), fov=42))
picture = points.render(size=(640, 480), spp=16, integrator="path", up="y")
picture.save("cloud.png")
picture
