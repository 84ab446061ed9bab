"""Every example of the documentation runs, and every public name has documentation."""

import doctest
import inspect
import os
import pathlib
import re
import warnings

import numpy as np
import pytest

import bilux

ROOT = pathlib.Path(__file__).resolve().parents[3]


def documented():
    """Every public object and its public methods, by name."""
    for name in bilux.__all__:
        thing = getattr(bilux, name)
        if name.startswith("__"):
            continue
        yield name, thing
        if inspect.isclass(thing):
            for member in vars(thing) | (vars(thing.__mro__[1]) if name == "Scene" else {}):
                if not member.startswith("_") and member not in getattr(thing, "_fields", ()):
                    yield f"{name}.{member}", getattr(thing, member)
    yield from ((f"lidar.{name}", getattr(bilux.lidar, name)) for name in bilux.lidar.__all__)
    yield "lidar.PointCloud.save", bilux.lidar.PointCloud.save
    yield from ((f"trimesh.{name}", getattr(bilux.trimesh, name)) for name in ("RayMeshIntersector", "scene_of"))
    yield from ((f"labels.{name}", getattr(bilux.labels, name)) for name in bilux.labels.__all__)


EVERYTHING = dict(documented()) | {"bilux": bilux}


@pytest.mark.parametrize("name", EVERYTHING)
def test_everything_is_documented_and_its_examples_run(name, folder):
    text = inspect.getdoc(EVERYTHING[name])
    assert text, f"{name} has no documentation"
    assert all(f"{field}: " in text for field in getattr(EVERYTHING[name], "_fields", ()))
    if name == "trimesh" or name.startswith("trimesh."):
        pytest.importorskip("trimesh")
    space = {"bilux": bilux, "np": np}
    test = doctest.DocTestParser().get_doctest(text, space, name, None, None)
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS)
    runner.run(test)
    assert runner.failures == 0


@pytest.mark.parametrize(
    "page",
    [
        "README.md",
        "crates/python/README.md",
        "docs/tutorials/python.md",
        "docs/tutorials/python-coming-from.md",
        "docs/tutorials/calibrated.md",
        "docs/tutorials/sensors.md",
        "docs/tutorials/lux.md",
        "docs/tutorials/daylight.md",
        "docs/tutorials/training-data.md",
    ],
)
def test_every_example_of_the_pages_runs(page, folder, monkeypatch):
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / page).read_text("utf-8"), re.DOTALL)
    assert blocks
    if any("import trimesh" in block for block in blocks):
        pytest.importorskip("trimesh")
    if page in LARGE:
        monkeypatch.setattr(bilux.Scene, "render", in_small(bilux.Scene.render))
    # Without a display, OpenGL draws by EGL.
    monkeypatch.setenv("PYOPENGL_PLATFORM", os.environ.get("PYOPENGL_PLATFORM", "egl"))
    space = {}
    for number, block in enumerate(blocks):
        other = next((name for name in OTHERS if f"import {name}\n" in block), None)
        try:
            exec(compile(block, f"{page}, example {number + 1}", "exec"), space)
        except Exception as error:
            # What other renderers need, such as OpenGL, may be missing; they may not be at fault for anything else.
            if other is None:
                raise
            warnings.warn(f"SKIPPED: {page}, example {number + 1}: {other}: {error!r}", stacklevel=1)
    check_against_pyrender(space)


# Pages whose first picture takes seconds; nothing there depends on its size.
LARGE = ["README.md", "crates/python/README.md", "docs/tutorials/python.md"]


def in_small(render):
    """Renders large pictures with a sixteenth of their pixels."""

    def rendered(scene, *arguments, **settings):
        if settings.get("size") in [(320, 240), (640, 480)]:
            settings["size"] = tuple(side // 4 for side in settings["size"])
            settings.setdefault("spp", 4)
        return render(scene, *arguments, **settings)

    return rendered


OTHERS = ["mitsuba", "pyrender", "bpy", "pyradiance"]


def check_against_pyrender(space):
    """What the page says of pyrender's depth is right, where it has run."""
    if "depth" not in space or "our_depth" not in space:
        return
    theirs, ours = space["depth"], space["our_depth"]
    both = (theirs > 0) & (ours > 0)
    assert both.sum() > 2000 and ((theirs > 0) != (ours > 0)).mean() < 0.02
    assert np.median(np.abs(theirs - ours)[both]) < 0.01
