# %% [markdown]
# # A plan in lux
# An office of 6 by 4 metres with four lamps: the illuminance on the desks, how even it is, and a plan.

# %%
import numpy as np

import bilux

# %% [markdown]
# ## The lamps
# Makers publish files of IES LM-63 (`bilux.IntensityDistribution.read("lamp.ies")`). This one is made up: a panel that shines downwards, and less
# than a matt one to the sides.

# %%
angles = np.arange(0, 91, 5)
candela = 900 * np.cos(np.radians(angles)) ** 1.6
lamp = f"""IESNA:LM-63-2002
[LUMINAIRE] Panel
TILT=NONE
1 -1 1 {len(angles)} 1 1 2 0.6 0.6 0
1 1 32
{" ".join(map(str, angles))}
0
{" ".join(f"{value:.1f}" for value in candela)}
"""
with open("panel.ies", "w") as file:
    file.write(lamp)
distribution = bilux.IntensityDistribution.read("panel.ies")

# %% [markdown]
# ## The room
# Walls, floor and ceiling are boxes of one triangle pair each; `x` is to the right, `y` up and `z` towards the reader of the plan.

# %%
WIDTH, HEIGHT, DEPTH = 6.0, 2.8, 4.0
scene = bilux.Scene()


def wall(corner, u, v, reflectance):
    corner, u, v = np.array(corner), np.array(u), np.array(v)
    material = bilux.materials.diffuse(reflectance=reflectance)
    scene.add_mesh([corner, corner + u, corner + u + v, corner + v], [[0, 1, 2], [0, 2, 3]], material=material)


wall([0, 0, 0], [0, 0, DEPTH], [WIDTH, 0, 0], 0.2)
wall([0, HEIGHT, 0], [WIDTH, 0, 0], [0, 0, DEPTH], 0.7)
wall([0, 0, 0], [WIDTH, 0, 0], [0, HEIGHT, 0], 0.5)
wall([0, 0, DEPTH], [0, HEIGHT, 0], [WIDTH, 0, 0], 0.5)
wall([0, 0, 0], [0, HEIGHT, 0], [0, 0, DEPTH], 0.5)
wall([WIDTH, 0, 0], [0, 0, DEPTH], [0, HEIGHT, 0], 0.5)

for x in (1.5, 4.5):
    for z in (1.0, 3.0):
        at = (x, HEIGHT - 0.05, z)
        scene.add_light(bilux.lights.luminaire(distribution=distribution, position=at, flux="3600 lm"))

# %% [markdown]
# ## Figures
# EN 12464-1 asks for 500 lx on desks, and a uniformity (the least over the mean) of 0.6. Desks are 0.75 m high; half a metre along the
# walls does not count.

# %%
x, z = np.meshgrid(np.linspace(0.5, WIDTH - 0.5, 11), np.linspace(0.5, DEPTH - 0.5, 7))
points = np.stack([x, np.full_like(x, 0.75), z], axis=-1).reshape(-1, 3)
values, errors = scene.illuminance(points, spp=256)
print(f"mean {values.mean():.0f} lx, least {values.min():.0f} lx, most {values.max():.0f} lx")
print(f"uniformity {values.min() / values.mean():.2f}; standard error at most {(errors / values).max():.1%}")

# %% [markdown]
# ## The plan
# The camera `irradiance` is a meter of the same height: each pixel is what its part of the plane receives, over π.

# %%
scene.add_camera(
    bilux.cameras.irradiance(
        position=(WIDTH / 2, 0.75, DEPTH / 2), look_at=(WIDTH / 2, HEIGHT, DEPTH / 2), up=(0, 0, -1), height=DEPTH
    )
)
picture = scene.render(size=(240, 160), spp=16, denoise=False)
lux = picture.pixels.mean(axis=2) * np.pi * 683

# %% [markdown]
# False colours, and lines every 100 lx: where the illuminance, smoothed over 20 cm, passes a multiple.

# %%
smooth = lux.copy()
for axis in (0, 1):
    kernel = np.ones(9) / 9
    padded = np.pad(smooth, [(4, 4) if a == axis else (0, 0) for a in (0, 1)], mode="edge")
    smooth = np.apply_along_axis(np.convolve, axis, padded, kernel, mode="valid")
steps = np.floor(smooth / 100)
lines = np.zeros(lux.shape, bool)
lines[:-1] |= steps[:-1] != steps[1:]
lines[:, :-1] |= steps[:, :-1] != steps[:, 1:]
STOPS = np.array([[0, 0, 0.1], [0.3, 0, 0.5], [0.8, 0.1, 0.35], [1, 0.55, 0.1], [1, 0.95, 0.6]])
share = np.clip(smooth / 800, 0, 1) * (len(STOPS) - 1)
colours = np.stack([np.interp(share, np.arange(len(STOPS)), STOPS[:, channel]) for channel in range(3)], axis=-1)
colours[lines] = 1
plan = bilux.Picture(colours.astype(np.float32))
plan.save("office_lux.png")
plan
