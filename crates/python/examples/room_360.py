"""A room all around: a panorama for players of 360-degree pictures, and one for each eye for virtual reality.

The folder gets room.png in longitude and latitude, twice as wide as high, room-3d.png with the left eye above the right one, and
what each face of a cube around the viewer shows (front.png and so on).

    python room_360.py tour --width 2048 --spp 64
"""

import argparse
import pathlib

import numpy as np

import bilux

EYE, AHEAD = (0.6, 1.5, 0.6), (-0.35, 1.5, -0.75)
FACES = ("right", "left", "up", "down", "front", "back")


def exposure_of(pixels):
    """The exposure in stops that makes the middle of the light of a picture middle grey."""
    luminance = pixels @ [0.2126, 0.7152, 0.0722]
    return float(np.log2(0.18 / np.median(luminance)))


def main(arguments=None):
    """Takes the pictures that the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--width", type=int, default=2048, help="width of a panorama in pixels")
    parser.add_argument("--spp", type=int, default=64, help="samples per pixel")
    asked = parser.parse_args(arguments)
    asked.folder.mkdir(parents=True, exist_ok=True)
    width = asked.width

    scene = bilux.generate("interior")
    around = {"position": EYE, "look_at": AHEAD}
    scene.cameras = [
        bilux.cameras.panorama(**around, name="room"),
        bilux.cameras.panorama(**around, stereo="over-under", name="room-3d"),
        bilux.cameras.panorama(**around, mapping="cube", name="cube"),
    ]
    # One exposure for all of them, so that they fit together.
    mono = scene.render(camera="room", size=(width, width // 2), spp=asked.spp, integrator="path", denoise=True)
    shown = {"exposure": exposure_of(mono.pixels), "tonemap": "agx"}
    mono.save(asked.folder / "room.png", **shown)
    both = scene.render(camera="room-3d", size=(width, width), spp=asked.spp, integrator="path", denoise=True)
    both.save(asked.folder / "room-3d.png", **shown)
    side = width // 4
    cube = scene.render(camera="cube", size=(6 * side, side), spp=asked.spp, integrator="path", denoise=True).pixels
    for i, face in enumerate(FACES):
        bilux.Picture(cube[:, i * side : (i + 1) * side]).save(asked.folder / f"{face}.png", **shown)


if __name__ == "__main__":
    main()
