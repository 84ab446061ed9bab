"""Physically based pictures of 3D scenes on the CPU, and ray queries on numpy arrays.

Example:
    >>> scene = bilux.load("model.glb")
    >>> picture = scene.render(size=(64, 48), spp=4)
    >>> picture.save("model.png")

`Scene` is built from files (`load`), by generators (`generate`) or from arrays; `Scene.render` gives a `Picture`, whose
layers are numpy arrays; `Accel` answers ray queries. What has variants is listed in tables: `integrators()`,
`materials()`, `lights()`, `cameras()`, `settings()` and more.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from . import lidar, trimesh
from ._amodal import Amodal
from ._bilux import (
    Accel,
    Grid,
    IntensityDistribution,
    Picture,
    Spec,
    Texture,
    __version__,
    compare,
    licenses,
    read_cameras,
    read_picture,
)
from ._errors import Error, FormatError, Interrupted, PictureError, RenderError, SceneError, SceneWarning
from ._makers import cameras, lights, materials
from ._scene import Scene, generate, load
from ._tables import (
    Entry,
    Parameter,
    Table,
    accels,
    aovs,
    denoisers,
    densities,
    filters,
    formats,
    generators,
    integrators,
    metrics,
    picture_formats,
    sensor,
    settings,
    tonemaps,
)
from ._types import AllHits, Hits, Measured, Mesh, NearestPoints, Object, Progress, Replay, Strategy, Transient
from ._view import View

if TYPE_CHECKING:
    from . import cluster, daylight, labels

__all__ = [
    "Accel",
    "AllHits",
    "Amodal",
    "Entry",
    "Error",
    "FormatError",
    "Grid",
    "Hits",
    "IntensityDistribution",
    "Interrupted",
    "Measured",
    "Mesh",
    "NearestPoints",
    "Object",
    "Parameter",
    "Picture",
    "PictureError",
    "Progress",
    "RenderError",
    "Replay",
    "Scene",
    "SceneError",
    "SceneWarning",
    "Spec",
    "Strategy",
    "Table",
    "Texture",
    "Transient",
    "View",
    "__version__",
    "accels",
    "aovs",
    "cameras",
    "cluster",
    "compare",
    "daylight",
    "denoisers",
    "densities",
    "filters",
    "formats",
    "generate",
    "generators",
    "integrators",
    "labels",
    "licenses",
    "lidar",
    "lights",
    "load",
    "materials",
    "metrics",
    "picture_formats",
    "read_cameras",
    "read_picture",
    "sensor",
    "settings",
    "tonemaps",
    "trimesh",
]


def __getattr__(name: str) -> Any:
    """`bilux.cluster`, `bilux.daylight` and `bilux.labels`, which not all need, when they are first used."""
    if name in ("cluster", "daylight", "labels"):
        return import_module(f".{name}", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), "cluster", "daylight", "labels"})
