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
        self._built: tuple[int, Accel, _Floats, float] | None = None

    def _placed(self) -> tuple[Accel, _Floats, float]:
        """The structure over the mesh in its box, what is subtracted from positions, and by what they are then
        multiplied."""
        state = hash(self.mesh)
        if self._built is None or self._built[0] != state:
            vertices = np.asarray(self.mesh.vertices, np.float64)
            origin, scale = np.zeros(3), 1.0
            if self._scale_to_box and len(vertices) > 0:
                origin, scale = vertices.min(axis=0), 100.0 / (float(self.mesh.scale) or 100.0)
            accel = Accel((vertices - origin) * scale, np.asarray(self.mesh.faces), kind=self._kind)
            self._built = state, accel, origin, scale
        return self._built[1:]

    def _rays(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> tuple[Accel, _Floats, _Floats]:
        """The structure, and the rays in the mesh's box."""
        accel, origin, scale = self._placed()
        origins = np.asarray(ray_origins, np.float64)
        directions = np.asarray(ray_directions)
        if origins.shape != directions.shape:
            raise ValueError(
                f"Ray origin and direction don't match! {origins.shape} and {directions.shape}: give one for each"
            )
        return accel, (origins - origin) * scale, directions

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
        accel, origins, directions = self._rays(ray_origins, ray_directions)
        if multiple_hits:
            index_tri, index_ray = self._crossings(accel, origins, directions)
            kept = np.arange(len(index_ray)) - np.searchsorted(index_ray, index_ray) < max_hits
            index_tri, index_ray = index_tri[kept], index_ray[kept]
        else:
            first = accel.closest(origins, directions).primitive
            index_ray = np.flatnonzero(first >= 0)
            index_tri = first[index_ray]
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
        accel, origins, directions = self._rays(ray_origins, ray_directions)
        return accel.closest(origins, directions).primitive

    def intersects_any(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> NDArray[np.bool_]:
        """Whether each ray hits anything: (n,) bool."""
        accel, origins, directions = self._rays(ray_origins, ray_directions)
        return accel.any(origins, directions)

    def contains_points(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Whether each point is inside the mesh, which must be closed: (n,) bool."""
        points = np.asarray(points, np.float64)
        if points.ndim != 2 or points.shape[1] != 3:
            raise ValueError(f"points: the shape is {points.shape}, but must be (n, 3)")
        inside: NDArray[np.bool_] = np.zeros(len(points), bool)
        lower, upper = np.asarray(self.mesh.bounds)
        near = np.flatnonzero(((points >= lower) & (points <= upper)).all(axis=1))
        if len(near) > 0:
            accel, origin, scale = self._placed()
            places = (points[near] - origin) * scale
            # Where a ray grazes the surface at a vertex, its count may be wrong: the majority of three decides.
            odd = [self._count(accel, places, direction) % 2 for direction in _DIRECTIONS]
            inside[near] = np.sum(odd, axis=0) >= 2
        return inside

    def _count(self, accel: Accel, places: _Floats, direction: tuple[float, float, float]) -> _Integers:
        """How often a ray in a direction from each place in the mesh's box crosses the surface."""
        index_ray = self._crossings(accel, places, np.array([direction]))[1]
        return np.bincount(index_ray, minlength=len(places))

    def _crossings(
        self, accel: Accel, origins: _Floats, directions: NDArray[Any]
    ) -> tuple[_Integers, _Integers]:
        """All hits in the mesh's box: rows of faces, and of rays. A ray through an edge or a vertex hits all triangles
        there, but crosses the surface once: of triangles that touch, and that it enters or leaves at the same point,
        only one counts."""
        hits = accel.all_hits(origins, directions)
        if len(hits.ray) < 2:
            return hits.primitive, hits.ray
        along = np.broadcast_to(directions, origins.shape)[hits.ray]
        distance = hits.t * np.linalg.norm(along, axis=1)
        size = float(np.linalg.norm(np.diff(accel.bounds, axis=0)))
        gap = np.diff(distance) > 4 * np.finfo(np.float32).eps * np.maximum(distance[1:], size)
        place = np.concatenate([[0], np.cumsum(gap | (np.diff(hits.ray) > 0))])
        together = np.diff(place) == 0
        several = np.flatnonzero(np.append(together, False) | np.insert(together, 0, False))
        enters = np.einsum("ij,ij->i", hits.normal[several], along[several]) < 0
        order = np.lexsort((hits.primitive[several], enters, place[several]))
        several, enters = several[order], enters[order]
        same = (np.diff(place[several]) == 0) & (enters[:-1] == enters[1:])
        one, other = several[:-1][same], several[1:][same]
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
