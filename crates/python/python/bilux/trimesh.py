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

from ._bilux import PlacedMesh

_Floats = NDArray[np.float64]
_Integers = NDArray[np.int64]


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
        self._built: tuple[int, PlacedMesh] | None = None

    def _placed(self) -> PlacedMesh:
        """The structure over the mesh."""
        state = hash(self.mesh)
        if self._built is None or self._built[0] != state:
            size = self.mesh.scale if self._scale_to_box and len(self.mesh.vertices) > 0 else None
            self._built = state, PlacedMesh(self.mesh.vertices, self.mesh.faces, size, self._kind)
        return self._built[1]

    def _crossings(
        self, ray_origins: ArrayLike, ray_directions: ArrayLike, most: int, positions: bool
    ) -> tuple[_Integers, _Integers, _Floats | None]:
        """Rows of faces, of rays, and positions."""
        rays = _matching(ray_origins, ray_directions)
        return self._placed().crossings(*rays, most, positions)

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
        most = max(int(max_hits), 0) if multiple_hits else 1
        index_tri, index_ray, locations = self._crossings(ray_origins, ray_directions, most, return_locations)
        return (index_tri, index_ray, locations) if return_locations else (index_tri, index_ray)

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
        return self._placed().first(*_matching(ray_origins, ray_directions))

    def intersects_any(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> NDArray[np.bool_]:
        """Whether each ray hits anything: (n,) bool."""
        return self._placed().any(*_matching(ray_origins, ray_directions))

    def contains_points(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Whether each point is inside the mesh, which must be closed: (n,) bool."""
        return self._placed().inside(points)

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_built": None}

    def __copy__(self) -> RayMeshIntersector:
        return RayMeshIntersector(self.mesh, self._scale_to_box, kind=self._kind)

    def __deepcopy__(self, memo: dict[int, Any]) -> RayMeshIntersector:
        return RayMeshIntersector(copy.deepcopy(self.mesh, memo), self._scale_to_box, kind=self._kind)


def _matching(ray_origins: ArrayLike, ray_directions: ArrayLike) -> tuple[NDArray[Any], NDArray[Any]]:
    """Origins and directions as arrays of the same shape."""
    origins, directions = np.asarray(ray_origins), np.asarray(ray_directions)
    if origins.shape != directions.shape:
        raise ValueError(
            f"Ray origin and direction don't match! {origins.shape} and {directions.shape}: give one for each"
        )
    return origins, directions
