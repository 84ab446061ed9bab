# %% [markdown]
# # Relighting
# Light adds up: a picture in all lights is the sum of pictures in one light each. Rendered once, their brightness and colour can be
# changed afterwards, without rendering again.

# %%
import numpy as np

import bilux

SIZE, SPP = (128, 96), 12

# %%
scene = bilux.generate("trio")
for number in range(len(scene)):
    scene.set_material(number, bilux.materials.principled(base_color=0.6, specular_roughness=0.3))
lamps = {
    "window": bilux.lights.rect(position=(-4, 3, 2), edge_u=(0, 0, 3), edge_v=(0, 2, 0), radiance=2),
    "lamp": bilux.lights.sphere(position=(2.5, 2, 2.5), radius=0.3, intensity=(9, 5, 2)),
    "sky": bilux.lights.environment(radiance=(0.1, 0.15, 0.25)),
}

# %% [markdown]
# One picture for each light. The sums below are of linear light, before any tone curve, so they are exact.

# %%
alone = {}
for name, light in lamps.items():
    scene.lights = [light]
    alone[name] = scene.render(size=SIZE, spp=SPP, integrator="path").pixels

scene.lights = list(lamps.values())
together = scene.render(size=SIZE, spp=SPP, integrator="path", seed=1).pixels
total = sum(alone.values())
print(f"the sum differs from the picture in all lights by {abs(total.mean() / together.mean() - 1):.1%}, which is noise")

# %% [markdown]
# Three moods of one scene, at once.

# %%
moods = {
    "day": {"window": (1, 1, 1), "lamp": (0, 0, 0), "sky": (1, 1, 1)},
    "evening": {"window": (0.1, 0.05, 0.02), "lamp": (1, 1, 1), "sky": (0.3, 0.2, 0.4)},
    "stage": {"window": (1.5, 0.1, 0.9), "lamp": (0, 0.3, 1), "sky": (0, 0.2, 0)},
}
relit = [sum(alone[name] * np.float32(colour) for name, colour in mood.items()) for mood in moods.values()]
picture = bilux.Picture(np.concatenate(relit, axis=1))
picture.save("relighting.png", exposure=1.3, tonemap="neutral")
picture
