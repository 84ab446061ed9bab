"""Named tuples that the package returns."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._bilux import Picture, Spec

Floats = NDArray[np.float32]
Integers = NDArray[np.int64]


class Hits(NamedTuple):
    """The first hit of each ray. Where a ray hits nothing, `t` is infinite, `primitive` is -1, `point` and `normal`
    are NaN, and `u` and `v` are 0.

    Attributes:
        t: (n,) distances along the rays, in lengths of their directions.
        primitive: (n,) rows of the triangles.
        u: (n,) barycentric weights of the triangles' second vertices, from 0 to 1.
        v: (n,) barycentric weights of the triangles' third vertices, from 0 to 1.
        point: (n, 3) points that are hit.
        normal: (n, 3) unit normals of the triangles, on their fronts.
    """

    t: Floats
    primitive: Integers
    u: Floats
    v: Floats
    point: Floats
    normal: Floats


class AllHits(NamedTuple):
    """Every hit of each ray, sorted by ray and then by distance: m rows in all.

    Attributes:
        ray: (m,) rows of the rays.
        t: (m,) distances along the rays, in lengths of their directions.
        primitive: (m,) rows of the triangles.
        u: (m,) barycentric weights of the triangles' second vertices, from 0 to 1.
        v: (m,) barycentric weights of the triangles' third vertices, from 0 to 1.
        point: (m, 3) points that are hit.
        normal: (m, 3) unit normals of the triangles, on their fronts.
    """

    ray: Integers
    t: Floats
    primitive: Integers
    u: Floats
    v: Floats
    point: Floats
    normal: Floats


class NearestPoints(NamedTuple):
    """The nearest point of the triangles to each point. Where nothing is within reach, `distance` is infinite,
    `primitive` is -1, `point` is NaN, and `u` and `v` are 0.

    Attributes:
        distance: (n,) distances.
        primitive: (n,) rows of the triangles.
        u: (n,) barycentric weights of the triangles' second vertices, from 0 to 1.
        v: (n,) barycentric weights of the triangles' third vertices, from 0 to 1.
        point: (n, 3) nearest points.
    """

    distance: Floats
    primitive: Integers
    u: Floats
    v: Floats
    point: Floats


class Measured(NamedTuple):
    """What points receive, and how certain that is.

    Attributes:
        values: irradiances in W/m², (n, 3), or illuminances in lx, (n,).
        errors: their standard errors, of the same shape; infinite after a single sample.
    """

    values: NDArray[np.float64]
    errors: NDArray[np.float64]


class Object(NamedTuple):
    """An object of a scene.

    Attributes:
        name: its name, which may be empty.
        material: what it is made of.
        transform: (4, 4) matrix from its mesh to the scene; for objects that move, at time 0.
        vertices: number of vertices of its mesh.
        triangles: number of triangles of its mesh.
        category: what kind of thing it is; "" for nothing.
        visibility: which rays see it (`Scene.set_visibility`).
    """

    name: str
    material: Spec
    transform: NDArray[np.float64]
    vertices: int
    triangles: int
    category: str
    visibility: str


class Mesh(NamedTuple):
    """The arrays of a mesh, in its own coordinates.

    Attributes:
        vertices: (n, 3) positions.
        triangles: (m, 3) rows of vertices.
        normals: (n, 3) shading normals, if it has any.
        uvs: (n, 2) texture coordinates, v upwards, if it has any.
        colors: (n, 3) colours, proportional to light, if it has any.
    """

    vertices: Floats
    triangles: Integers
    normals: Floats | None
    uvs: Floats | None
    colors: Floats | None


class Progress(NamedTuple):
    """How far a render is.

    Attributes:
        samples: samples taken, over all pixels.
        total: samples to take. If noise or time ends the render, it usually ends with fewer.
        rays: rays traced.
        seconds: seconds since the render began.
    """

    samples: int
    total: int
    rays: int
    seconds: float

    @property
    def fraction(self) -> float:
        """The part of the samples that is taken, from 0 to 1."""
        return self.samples / self.total if self.total else 0.0


__all__: list[str] = ["AllHits", "Hits", "Mesh", "NearestPoints", "Object", "Progress"]


class Replay(NamedTuple):
    """One sample of a picture, taken again (`Scene.replay`). Its text, `str(replay)`, is for people.

    Attributes:
        text: all of it in words.
        events: what happens along the path: pairs of the number of scattering events before, and a description.
        radiance: red, green and blue of the light in the sample's own pixel.
        origin: where the camera ray begins.
        direction: its direction.
        time: its time in seconds.
        splats: the number of pixels to which its light path contributes.
        rays: the number of rays that it takes.
    """

    text: str
    events: list[tuple[int, str]]
    radiance: tuple[float, float, float]
    origin: tuple[float, float, float]
    direction: tuple[float, float, float]
    time: float
    splats: int
    rays: int

    def __str__(self) -> str:
        return self.text


class Strategy(NamedTuple):
    """What one strategy of an integrator finds (`Scene.strategies`).

    Attributes:
        name: such as "s2-t1".
        s: the number of vertices from the light, including the one on the light.
        t: the number of vertices from the camera, including the one at the camera.
        merges: whether the last vertices of both subpaths are merged, not connected.
        weighted: its share of the picture: all of these add up to it.
        unweighted: all light of paths of this length, as far as this strategy finds it.
    """

    name: str
    s: int
    t: int
    merges: bool
    weighted: Picture
    unweighted: Picture


class Transient(NamedTuple):
    """A picture in intervals of the optical length of paths: `light` over its intervals and `rest` add up to the picture.

    Attributes:
        light: (height, width, n, 3) radiance of each interval.
        rest: (height, width, 3) radiance of paths that are shorter or longer, or come from infinity.
        edges: (n + 1,) ends of the intervals, in metres from where the camera's rays begin.
    """

    light: Floats
    rest: Floats
    edges: NDArray[np.float64]

    @property
    def times(self) -> NDArray[np.float64]:
        """The ends of the intervals as times, in seconds."""
        return self.edges / 299_792_458.0
