# %% [markdown]
# # A video
# Balls that bounce, one picture for each frame, in a file that players open. The file needs the package imageio with imageio-ffmpeg;
# without it, the frames stay as pictures.

# %%
import pathlib

import numpy as np

import bilux

FRAMES, RATE, SIZE, SPP = 12, 12, (160, 96), 8


# %%
def ball(rings=16):
    """The vertices and triangles of a sphere of radius 1."""
    theta, phi = np.meshgrid(np.linspace(0, np.pi, rings + 1), np.linspace(0, 2 * np.pi, 2 * rings + 1), indexing="ij")
    vertices = np.stack([np.sin(theta) * np.sin(phi), np.cos(theta), np.sin(theta) * np.cos(phi)], axis=-1).reshape(-1, 3)
    row, column = (grid.ravel() for grid in np.meshgrid(np.arange(rings), np.arange(2 * rings), indexing="ij"))
    above, below = row * (2 * rings + 1) + column, (row + 1) * (2 * rings + 1) + column
    return vertices, np.concatenate([np.stack([above, below, above + 1], 1), np.stack([above + 1, below, below + 1], 1)])


scene = bilux.Scene()
floor = bilux.materials.diffuse(reflectance=(0.5, 0.55, 0.6))
scene.add_mesh([[-30, 0, -30], [-30, 0, 30], [30, 0, 30], [30, 0, -30]], [[0, 1, 2], [0, 2, 3]], material=floor)
vertices, triangles = ball()
colours = [(0.8, 0.1, 0.1), (0.8, 0.6, 0.1), (0.1, 0.5, 0.2), (0.1, 0.2, 0.7)]
balls = []
for colour in colours:
    paint = bilux.materials.principled(base_color=colour, specular_roughness=0.2)
    balls.append(scene.add_mesh(vertices, triangles, normals=vertices, material=paint))
scene.add_light(bilux.lights.environment(radiance=0.6))
scene.add_light(bilux.lights.sphere(position=(-4, 8, 6), radius=1, intensity=120))
scene.add_camera(bilux.cameras.perspective(position=(0, 2.5, 11), look_at=(0, 1.2, 0), fov=42))

# %% [markdown]
# Each ball bounces on its own; what does not move is not touched.

# %%
frames = []
for frame in range(FRAMES):
    for number, moved in enumerate(balls):
        phase = (frame / RATE + number / len(balls)) % 1
        place = np.diag([0.7, 0.7, 0.7, 1.0])
        place[:3, 3] = [2.2 * number - 3.3, 0.7 + 2.4 * 4 * phase * (1 - phase), 0]
        scene.set_transform(moved, place)
    picture = scene.render(size=SIZE, spp=SPP, integrator="path", seed=frame, denoise=True)
    frames.append(picture.to_uint8("neutral", exposure=-0.3))

# %%
try:
    import imageio.v2 as imageio

    with imageio.get_writer("video.mp4", fps=RATE, macro_block_size=16) as video:
        for pixels in frames:
            video.append_data(pixels)
    print("video.mp4:", pathlib.Path("video.mp4").stat().st_size, "bytes")
except (ImportError, ValueError) as missing:
    print(f"no video ({missing}): frames as pictures")
    for number, pixels in enumerate(frames):
        bilux.Picture((pixels / 255.0) ** 2.2).save(f"frame-{number:04}.png")
picture
