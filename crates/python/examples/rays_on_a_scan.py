# %% [markdown]
# # Ray queries on a scan
# What a scanned mesh tells without a picture: how thick its walls are, how much of the sky each point sees, how far a point is from
# it, and what hides it from a sensor.

# %%
import time

import numpy as np

import bilux

RAYS, WIDTH = 32, 200

# %% [markdown]
# The scan is one that Bilux makes. With `trimesh`, it would be `mesh = trimesh.load(…)`, and `mesh.vertices` and `mesh.faces`.

# %%
scan = bilux.generate("scan", detail=60)
mesh = scan.mesh(0)
begun = time.perf_counter()
accel = bilux.Accel(mesh.vertices, mesh.triangles)
print(f"{len(mesh.triangles)} triangles, tree built in {time.perf_counter() - begun:.2f} s")

corners = mesh.vertices[mesh.triangles].astype(float)
centres = corners.mean(axis=1)
normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
normals /= np.linalg.norm(normals, axis=1, keepdims=True)
size = np.linalg.norm(np.ptp(corners.reshape(-1, 3), axis=0))

# %% [markdown]
# Thickness: a ray from each triangle straight into the body, until it leaves it.

# %%
inwards = accel.closest(centres - 1e-4 * size * normals, -normals)
found = np.isfinite(inwards.t)
print(f"the walls are {np.median(inwards.t[found]):.3f} m thick in the middle of the range, {inwards.t[found].min():.4f} m at least")

# %% [markdown]
# Exposure to the sky: many rays from each triangle, in directions around its normal, weighted by their cosine. One call traces all.

# %%
random = np.random.default_rng(1)
directions = random.normal(size=(len(centres), RAYS, 3))
directions /= np.linalg.norm(directions, axis=2, keepdims=True)
directions += normals[:, None] * 1.0001
origins = np.repeat(centres + 1e-4 * size * normals, RAYS, axis=0)
begun = time.perf_counter()
blocked = accel.any(origins, directions.reshape(-1, 3)).reshape(-1, RAYS)
print(f"{blocked.size / (time.perf_counter() - begun) / 1e6:.1f} million rays per second")
exposure = 1 - blocked.mean(axis=1)

# %% [markdown]
# Distance: how far points around the scan are from it; and what a sensor at one place sees of it.

# %%
around = corners.reshape(-1, 3).mean(axis=0) + size * random.normal(size=(1000, 3))
distance = np.linalg.norm(accel.nearest_point(around).point - around, axis=1)
sensor = centres.mean(axis=0) + [0, 0, 2 * size]
visible = accel.visible(centres + 1e-4 * size * normals, np.tile(sensor, (len(centres), 1)))
print(f"points around are {distance.mean():.2f} m away; the sensor sees {visible.mean():.0%} of the triangles")

# %% [markdown]
# A picture of the exposure, by rays alone: each pixel shows the triangle that it sees.

# %%
low, high = corners.reshape(-1, 3).min(axis=0), corners.reshape(-1, 3).max(axis=0)
height = int(WIDTH * (high[1] - low[1]) / (high[0] - low[0]))
x, y = np.meshgrid(np.linspace(low[0], high[0], WIDTH), np.linspace(high[1], low[1], height))
seen = accel.closest(np.stack([x, y, np.full_like(x, high[2] + size)], axis=-1).reshape(-1, 3), [[0, 0, -1]])
values = np.where(seen.primitive >= 0, exposure[seen.primitive], 0)
picture = bilux.Picture(np.repeat(values.reshape(height, WIDTH, 1), 3, axis=2).astype(np.float32))
picture.save("exposure.png")
picture
