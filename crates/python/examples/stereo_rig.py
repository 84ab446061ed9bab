"""A stereo rig: two calibrated cameras before the Cornell box, with the depth and the disparity of every pixel.

The folder gets left.png, right.png, both beside each other (pair.png), disparity.png in false colours, disparity.npy and depth.npy
(float32, in pixels and in metres along the axis, NaN where nothing is seen), and calibration.yml as OpenCV's FileStorage reads it.

    python stereo_rig.py rig --size 640 480 --spp 64
"""

import argparse
import pathlib

import numpy as np

import bilux

BASELINE = 0.04
EYE, TARGET = np.array([0.22, 0.34, -0.38]), np.array([0.29, 0.22, 0.3])


def intrinsics(width, height):
    """K of a camera that sees 70 degrees to the sides, whose axis is a little off the middle."""
    focal = 0.5 * width / np.tan(np.radians(35))
    return np.array([[focal, 0, 0.49 * width], [0, focal, 0.51 * height], [0, 0, 1]])


def poses():
    """The rotation of both cameras, from the world to OpenCV's axes, and the translation of each."""
    ahead = (TARGET - EYE) / np.linalg.norm(TARGET - EYE)
    right = np.cross(ahead, [0, 1, 0])
    right /= np.linalg.norm(right)
    rotation = np.stack([right, np.cross(ahead, right), ahead])
    left = -rotation @ EYE
    return rotation, [left, left - [BASELINE, 0, 0]]


def write_calibration(path, K, size):
    """Writes the pair as OpenCV's `stereoCalibrate` results are stored."""

    def matrix(name, rows):
        rows = np.atleast_2d(rows)
        numbers = ", ".join(f"{number:.17g}" for number in rows.ravel())
        shape = f"   rows: {rows.shape[0]}\n   cols: {rows.shape[1]}\n   dt: d\n"
        return f"{name}: !!opencv-matrix\n{shape}   data: [ {numbers} ]\n"

    text = f"%YAML:1.0\n---\nimage_width: {size[0]}\nimage_height: {size[1]}\n"
    for eye in ("1", "2"):
        text += matrix(f"M{eye}", K) + matrix(f"D{eye}", np.zeros(5))
    text += matrix("R", np.eye(3)) + matrix("T", np.array([[-BASELINE], [0], [0]]))
    path.write_text(text)


def disparity_of(left, right, points):
    """How far each point is seen further left by the right camera, in pixels."""
    return (left.project(points) - right.project(points))[:, 0]


def false_colours(values):
    """Numbers as colours from blue to red, black where there are none."""
    low, high = np.nanpercentile(values, [2, 98])
    x = np.clip((values - low) / (high - low), 0, 1)[..., None]
    colours = np.clip(1.5 - np.abs(4 * x - [3, 2, 1]), 0, 1)
    return np.where(np.isnan(x), 0, colours)


def main(arguments=None):
    """Takes the pictures that the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--size", type=int, nargs=2, default=(640, 480), metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--spp", type=int, default=64, help="samples per pixel")
    asked = parser.parse_args(arguments)
    asked.folder.mkdir(parents=True, exist_ok=True)
    size = tuple(asked.size)

    K = intrinsics(*size)
    R, (t_left, t_right) = poses()
    left = bilux.cameras.opencv(K, R=R, t=t_left, size=size, name="left")
    right = bilux.cameras.opencv(K, R=R, t=t_right, size=size, name="right")
    scene = bilux.generate("cornell")
    scene.cameras = [left, right]

    # Labels are of one ray through each pixel's centre, so positions are exact, whatever the number of samples.
    pictures = [scene.render(camera=name, spp=asked.spp, aov=["position", "ids"]) for name in ("left", "right")]
    for name, picture in zip(("left", "right"), pictures, strict=True):
        picture.save(asked.folder / f"{name}.png", exposure="auto")
    seen = pictures[0]["id"][..., 0] > 0
    points = pictures[0]["position"].reshape(-1, 3).astype(float)
    depth = (points @ R[2] + t_left[2]).reshape(seen.shape)
    disparity = disparity_of(left, right, points).reshape(seen.shape)
    for name, numbers in (("depth", depth), ("disparity", disparity)):
        np.save(asked.folder / f"{name}.npy", np.where(seen, numbers, np.nan).astype(np.float32))
    shown = false_colours(np.where(seen, disparity, np.nan))
    bilux.Picture(shown).save(asked.folder / "disparity.png", tonemap="none")
    write_calibration(asked.folder / "calibration.yml", K, size)

    # The same without K: a pair in one picture.
    fov = np.degrees(2 * np.arctan(0.5 * size[1] / K[1, 1]))
    rig = {"stereo": "side-by-side", "eye_distance": BASELINE, "fov": fov}
    middle = EYE + R[0] * BASELINE / 2
    scene.cameras = [bilux.cameras.perspective(position=middle, look_at=middle + R[2], **rig)]
    scene.render(size=(2 * size[0], size[1]), spp=asked.spp).save(asked.folder / "pair.png", exposure="auto")


if __name__ == "__main__":
    main()
