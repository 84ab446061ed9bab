# %% [markdown]
# # Integrators compared
# Which algorithm computes a caustic best? Each gets the same times, and its error against a reference is plotted.

# %%
import importlib.util

import numpy as np

import bilux

SIZE, SECONDS, NAMES = (96, 72), (0.15, 0.3, 0.6), ("path", "bdpt", "vcm", "auto")

# %%
for entry in bilux.integrators():
    if entry.name in NAMES:
        print(f"{entry.name}: {entry.summary}")

# %% [markdown]
# The reference is from `vcm`, with other random numbers and more time.

# %%
scene = bilux.generate("cornell-spheres")
reference = scene.render(size=SIZE, integrator="vcm", time_limit=3, denoise=False, seed=100)
errors = {name: [] for name in NAMES}
for name in NAMES:
    for seconds in SECONDS:
        picture = scene.render(size=SIZE, integrator=name, time_limit=seconds, denoise=False)
        errors[name].append(bilux.compare(picture, reference)["relmse"])
    print(f"{name:5}", *(f"{error:.4f}" for error in errors[name]))

# %% [markdown]
# The error of a picture falls as one over the time, so on logarithmic axes the lines are parallel, and the lower one is better.

# %%
if importlib.util.find_spec("matplotlib"):
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5, 4), layout="constrained")
    axes = figure.subplots()
    for name, values in errors.items():
        axes.loglog(SECONDS, values, marker="o", label=name)
    axes.set(xlabel="time (s)", ylabel="relative mean squared error")
    axes.legend()
    figure.savefig("integrators.png")
else:
    print("matplotlib is not installed: no plot")
bilux.Picture(np.concatenate([picture.pixels, reference.pixels], axis=1))
