"""Checkers of types know what makers take: they refuse what is misspelt before it runs."""

import re

import pytest

import bilux

api = pytest.importorskip("mypy.api")

RIGHT = """
import numpy as np
import bilux
scene = bilux.Scene()
scene.lights = [bilux.lights.point(position=(0, 3, 0), intensity=np.float32(10)), bilux.lights.sky(name="sky")]
glass = bilux.materials.dielectric(eta=1.5, name="glass")
red = bilux.materials.principled(base_color="#c01010", specular_roughness=bilux.Texture(np.zeros((2, 2, 3))))
scene.cameras = [
    bilux.cameras.perspective(position=np.array([0, 1, 4]), look_at=[0, 0, 0], fov=35),
    bilux.cameras.opencv([[5, 0, 2], [0, 5, 2], [0, 0, 1]], np.eye(4), size=(4, 4), k1=0.1),
    bilux.cameras.opencv_fisheye(fx=5, fy=5, width=8, height=8),
]
"""

WRONG = {
    "bilux.materials.dielectric(etaa=1.5)": '"eta"',
    "bilux.materials.principled(base_colour=(1, 0, 0))": '"base_color"',
    "bilux.lights.point(positon=(0, 3, 0))": '"position"',
    "bilux.cameras.perspective(fow=35)": '"fow"',
    "bilux.cameras.opencv(dist=[0.1])": "dist",
    "bilux.materials.difuse(reflectance=0.5)": '"diffuse"',
    "bilux.lights.point(position=None)": "position",
}


def test_misspelt_parameters_and_kinds_are_refused_by_mypy(tmp_path):
    code = tmp_path / "scene.py"
    code.write_text(RIGHT + "\n".join(WRONG) + "\n")
    said, trouble, _ = api.run([str(code), "--strict", "--cache-dir", str(tmp_path / "cache"), "--no-error-summary"])
    assert not trouble
    first = RIGHT.count("\n") + 1
    errors = {}
    for line in said.splitlines():
        if found := re.search(r"scene\.py:(\d+): error: (.*)", line):
            errors.setdefault(int(found[1]) - first, found[2])
    assert list(errors) == list(range(len(WRONG))), said
    for number, (line, part) in enumerate(WRONG.items()):
        assert part in errors[number], f"{line}: {errors[number]}"


@pytest.mark.parametrize("makers", [bilux.materials, bilux.lights, bilux.cameras], ids=lambda makers: makers._name)
def test_each_maker_has_its_types(makers):
    assert {kind.replace("-", "_") for kind in makers} <= set(vars(type(makers)))
