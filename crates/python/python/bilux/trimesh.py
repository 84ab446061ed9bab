"""Ray queries for trimesh: `RayMeshIntersector` does what those of `trimesh.ray` do.

Example:
    >>> import trimesh
    >>> ball = trimesh.creation.icosphere()
    >>> ball.ray = bilux.trimesh.RayMeshIntersector(ball)
    >>> ball.ray.intersects_any([[0, 0, 5]], [[0, 0, -1]])
    array([ True])
"""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._bilux import Accel

_Floats = NDArray[np.float64]
_Integers = NDArray[np.int64]


_DIRECTIONS = [(0.318, 0.577, 0.753), (-0.693, 0.147, 0.706), (0.271, -0.828, 0.491)]
"""Arbitrary directions, which no edge of an ordinary model is parallel to."""


class RayMeshIntersector:
    """Ray queries on a `trimesh.Trimesh`, with the methods of `trimesh.ray`'s own class of this name.

    The structure is built at the first query, and again after the mesh has changed. All hits along a ray are found in
    one query, also where triangles touch or coincide.

    Args:
        geometry: the mesh.
        scale_to_box: whether the mesh is moved and scaled into a box of size 100, so that 32-bit floats resolve meshes
            that are far from the origin.
        kind: the structure (`bilux.accels`).
    """

    def __init__(self, geometry: Any, scale_to_box: bool = True, *, kind: str = "auto") -> None:
        self.mesh = geometry
        self._scale_to_box = scale_to_box
        self._kind = kind
        self._built: tuple[Any, Accel] | None = None

    @property
    def _placement(self) -> tuple[_Floats, float]:
        """What is subtracted from positions, and by what they are then multiplied."""
        vertices = np.asarray(self.mesh.vertices, np.float64)
        if not self._scale_to_box or len(vertices) == 0:
            return np.zeros(3), 1.0
        size = float(self.mesh.scale)
        return vertices.min(axis=0), 100.0 / size if size > 0 else 1.0

    @property
    def _accel(self) -> Accel:
        state = hash(self.mesh)
        if self._built is None or self._built[0] != state:
            origin, scale = self._placement
            vertices = (np.asarray(self.mesh.vertices, np.float64) - origin) * scale
            self._built = state, Accel(vertices, np.asarray(self.mesh.faces), kind=self._kind)
        return self._built[1]

    def _rays(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> tuple[_Floats, _Floats]:
        """The rays in the mesh's box, with directions of unit length."""
        origins = np.asarray(ray_origins, np.float64)
        directions = np.asarray(ray_directions, np.float64)
        if origins.shape != directions.shape:
            raise ValueError(
                f"Ray origin and direction don't match! {origins.shape} and {directions.shape}: give one for each"
            )
        length = np.linalg.norm(directions, axis=-1, keepdims=True)
        directions = np.divide(directions, length, out=np.zeros_like(directions), where=length > 0)
        origin, scale = self._placement
        return (origins - origin) * scale, directions

    def intersects_id(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = True,
        max_hits: int = 100,
        return_locations: bool = False,
    ) -> Any:
        """Finds which triangles are hit.

        Args:
            ray_origins, ray_directions: (n, 3) arrays.
            multiple_hits: whether all hits along a ray are wanted, or only the first.
            max_hits: the maximum number of hits of a ray.
            return_locations: whether positions are wanted too.

        Returns:
            index_tri: (m,) rows of faces.
            index_ray: (m,) rows of rays, in ascending order.
            locations: (m, 3) positions, if `return_locations`.
        """
        origins, directions = self._rays(ray_origins, ray_directions)
        if multiple_hits:
            index_tri, index_ray = self._crossings(origins, directions)
            kept = np.arange(len(index_ray)) - np.searchsorted(index_ray, index_ray) < max_hits
            index_tri, index_ray = index_tri[kept], index_ray[kept]
        else:
            closest = self._accel.closest(origins, directions)
            index_ray = np.flatnonzero(closest.primitive >= 0)
            index_tri = closest.primitive[index_ray]
        if not return_locations:
            return index_tri, index_ray
        return index_tri, index_ray, self._locations(ray_origins, ray_directions, index_ray, index_tri)

    def _locations(
        self, ray_origins: ArrayLike, ray_directions: ArrayLike, index_ray: _Integers, index_tri: _Integers
    ) -> _Floats:
        """Where rays meet the planes of triangles, in 64-bit floats."""
        origins = np.asarray(ray_origins, np.float64)[index_ray]
        directions = np.asarray(ray_directions, np.float64)[index_ray]
        a, b, c = np.moveaxis(np.asarray(self.mesh.triangles, np.float64)[index_tri], 1, 0)
        normals = np.cross(b - a, c - a)
        along = np.einsum("ij,ij->i", normals, directions)
        # A ray that lies in the plane, to the last bit, keeps its own origin.
        along[along == 0] = np.inf
        t = np.einsum("ij,ij->i", normals, a - origins) / along
        return np.asarray(origins + directions * t[:, None], np.float64)

    def intersects_location(
        self, ray_origins: ArrayLike, ray_directions: ArrayLike, multiple_hits: bool = True
    ) -> tuple[_Floats, _Integers, _Integers]:
        """Finds where the surface is hit.

        Returns:
            locations: (m, 3) positions.
            index_ray: (m,) rows of rays.
            index_tri: (m,) rows of faces.
        """
        index_tri, index_ray, locations = self.intersects_id(
            ray_origins, ray_directions, multiple_hits=multiple_hits, return_locations=True
        )
        return locations, index_ray, index_tri

    def intersects_first(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> _Integers:
        """The first triangle that each ray hits: (n,) rows of faces, -1 where nothing is hit."""
        return self._accel.closest(*self._rays(ray_origins, ray_directions)).primitive

    def intersects_any(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> NDArray[np.bool_]:
        """Whether each ray hits anything: (n,) bool."""
        return self._accel.any(*self._rays(ray_origins, ray_directions))

    def contains_points(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Whether each point is inside the mesh, which must be closed: (n,) bool."""
        points = np.asarray(points, np.float64)
        if points.ndim != 2 or points.shape[1] != 3:
            raise ValueError(f"points: the shape is {points.shape}, but must be (n, 3)")
        inside: NDArray[np.bool_] = np.zeros(len(points), bool)
        lower, upper = np.asarray(self.mesh.bounds)
        near = np.flatnonzero(((points >= lower) & (points <= upper)).all(axis=1))
        if len(near) > 0:
            origin, scale = self._placement
            places = (points[near] - origin) * scale
            # Where a ray grazes the surface at a vertex, its count may be wrong: the majority of three decides.
            odd = [self._count(places, direction) % 2 for direction in _DIRECTIONS]
            inside[near] = np.sum(odd, axis=0) >= 2
        return inside

    def _count(self, places: _Floats, direction: tuple[float, float, float]) -> _Integers:
        """How often a ray in a direction from each place in the mesh's box crosses the surface."""
        index_ray = self._crossings(places, np.array([direction]))[1]
        return np.bincount(index_ray, minlength=len(places))

    def _crossings(self, origins: _Floats, directions: _Floats) -> tuple[_Integers, _Integers]:
        """All hits in the mesh's box: rows of faces, and of rays. A ray through an edge or a vertex hits all triangles
        there, but crosses the surface once: of triangles that touch, and that it enters or leaves at the same point,
        only one counts."""
        hits = self._accel.all_hits(origins, directions)
        if len(hits.ray) < 2:
            return hits.primitive, hits.ray
        size = float(np.linalg.norm(np.diff(self._accel.bounds, axis=0)))
        gap = np.diff(hits.t) > 4 * np.finfo(np.float32).eps * np.maximum(hits.t[1:], size)
        place = np.concatenate([[0], np.cumsum(gap | (np.diff(hits.ray) > 0))])
        along = np.broadcast_to(directions, origins.shape)[hits.ray]
        enters = np.einsum("ij,ij->i", hits.normal, along) < 0
        order = np.lexsort((hits.primitive, enters, place))
        one, other = order[:-1], order[1:]
        same = (place[one] == place[other]) & (enters[one] == enters[other])
        one, other = one[same], other[same]
        corners = np.asarray(self.mesh.triangles)
        touch = corners[hits.primitive[one]][:, :, None] == corners[hits.primitive[other]][:, None, :]
        kept = np.ones(len(hits.ray), bool)
        kept[other[touch.all(axis=3).any(axis=(1, 2))]] = False
        return hits.primitive[kept], hits.ray[kept]

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_built": None}

    def __copy__(self) -> RayMeshIntersector:
        return RayMeshIntersector(self.mesh, self._scale_to_box, kind=self._kind)

    def __deepcopy__(self, memo: dict[int, Any]) -> RayMeshIntersector:
        return RayMeshIntersector(copy.deepcopy(self.mesh, memo), self._scale_to_box, kind=self._kind)
