# %% [markdown]
# # A product turntable
# A model on a matte ground in soft light, from all around, on a sheet. The camera moves; the light stays.

# %%
import numpy as np

import bilux

FRAMES, SIZE, SPP = 8, (128, 96), 16

# %% [markdown]
# The model is a teapot that Bilux makes; any file that `bilux.load` reads will do. Its bounds say how large it is.

# %%
model = bilux.generate("teapot")
low, high = np.array(model.bounds)
middle, reach = (low + high) / 2, np.linalg.norm(high - low)

scene = bilux.Scene()
mesh = model.mesh(0)
glaze = bilux.materials.principled(base_color=(0.05, 0.2, 0.35), specular_roughness=0.15, coat_weight=1.0)
scene.add_mesh(mesh.vertices, mesh.triangles, normals=mesh.normals, material=glaze, transform=model.objects[0].transform)

# %% [markdown]
# The ground is large, so that its edge is never seen, and the light comes from a panel above and from all around.

# %%
far = 40 * reach
ground = np.array([[-far, 0, -far], [-far, 0, far], [far, 0, far], [far, 0, -far]]) + [middle[0], low[1], middle[2]]
scene.add_mesh(ground, [[0, 1, 2], [0, 2, 3]], material=bilux.materials.diffuse(reflectance=0.7))
panel = {"edge_u": (1.5 * reach, 0, 0), "edge_v": (0, 0, 1.5 * reach), "radiance": 5}
scene.add_light(bilux.lights.rect(position=tuple(middle + [-reach, 2 * reach, reach]), **panel))
scene.add_light(bilux.lights.environment(radiance=0.5))

# %%
frames = []
for angle in np.arange(FRAMES) * 2 * np.pi / FRAMES:
    eye = middle + 1.5 * reach * np.array([np.sin(angle), 0.4, np.cos(angle)])
    scene.cameras = [bilux.cameras.perspective(position=tuple(eye), look_at=tuple(middle), fov=32)]
    frames.append(scene.render(size=SIZE, spp=SPP, seed=len(frames), denoise=True).to_uint8("neutral", exposure=0.3))

# %% [markdown]
# One sheet of all frames, in two rows. `video.py` makes a film of such frames.

# %%
rows = np.split(np.array(frames), 2)
sheet = np.concatenate([np.concatenate(list(row), axis=1) for row in rows])
picture = bilux.Picture((sheet / 255.0) ** 2.2)
picture.save("turntable.png")
picture
