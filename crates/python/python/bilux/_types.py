"""Named tuples that the package returns."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._bilux import Spec

Floats = NDArray[np.float32]
Integers = NDArray[np.int64]


class Hits(NamedTuple):
    """The first hit of each ray. Where a ray hits nothing, `t` is infinite, `primitive` is -1, `point` and `normal`
    are NaN, and `u` and `v` are 0."""

    t: Floats
    """(n,) distances along the rays, in lengths of their directions."""
    primitive: Integers
    """(n,) rows of the triangles."""
    u: Floats
    """(n,) barycentric weights of the triangles' second vertices, from 0 to 1."""
    v: Floats
    """(n,) barycentric weights of the triangles' third vertices, from 0 to 1."""
    point: Floats
    """(n, 3) points that are hit."""
    normal: Floats
    """(n, 3) unit normals of the triangles, on their fronts."""


class AllHits(NamedTuple):
    """Every hit of each ray, sorted by ray and then by distance: m rows in all."""

    ray: Integers
    """(m,) rows of the rays."""
    t: Floats
    """(m,) distances along the rays, in lengths of their directions."""
    primitive: Integers
    """(m,) rows of the triangles."""
    u: Floats
    """(m,) barycentric weights of the triangles' second vertices, from 0 to 1."""
    v: Floats
    """(m,) barycentric weights of the triangles' third vertices, from 0 to 1."""
    point: Floats
    """(m, 3) points that are hit."""
    normal: Floats
    """(m, 3) unit normals of the triangles, on their fronts."""


class NearestPoints(NamedTuple):
    """The nearest point of the triangles to each point. Where nothing is within reach, `distance` is infinite,
    `primitive` is -1, `point` is NaN, and `u` and `v` are 0."""

    distance: Floats
    """(n,) distances."""
    primitive: Integers
    """(n,) rows of the triangles."""
    u: Floats
    """(n,) barycentric weights of the triangles' second vertices, from 0 to 1."""
    v: Floats
    """(n,) barycentric weights of the triangles' third vertices, from 0 to 1."""
    point: Floats
    """(n, 3) nearest points."""


class Object(NamedTuple):
    """An object of a scene."""

    name: str
    """Its name, which may be empty."""
    material: Spec
    """What it is made of."""
    transform: NDArray[np.float64]
    """(4, 4) matrix from its mesh to the scene; for objects that move, at time 0."""
    vertices: int
    """Number of vertices of its mesh."""
    triangles: int
    """Number of triangles of its mesh."""


class Mesh(NamedTuple):
    """The arrays of a mesh, in its own coordinates."""

    vertices: Floats
    """(n, 3) positions."""
    triangles: Integers
    """(m, 3) rows of vertices."""
    normals: Floats | None
    """(n, 3) shading normals, if it has any."""
    uvs: Floats | None
    """(n, 2) texture coordinates, v upwards, if it has any."""


class Progress(NamedTuple):
    """How far a render is."""

    samples: int
    """Samples taken, over all pixels."""
    total: int
    """Samples to take. If noise or time ends the render, it usually ends with fewer."""
    rays: int
    """Rays traced."""
    seconds: float
    """Seconds since the render began."""

    @property
    def fraction(self) -> float:
        """The part of the samples that is taken, from 0 to 1."""
        return self.samples / self.total if self.total else 0.0


__all__: list[str] = ["AllHits", "Hits", "Mesh", "NearestPoints", "Object", "Progress"]
