"""For trimesh: `RayMeshIntersector` queries rays as `trimesh.ray` does, and `scene_of` takes over scenes.

Example:
    >>> import trimesh
    >>> ball = trimesh.creation.icosphere()
    >>> ball.ray = bilux.trimesh.RayMeshIntersector(ball)
    >>> ball.ray.intersects_any([[0, 0, 5]], [[0, 0, -1]])
    array([ True])
"""

from __future__ import annotations

import copy
import warnings
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _bilux
from ._bilux import PlacedMesh, Spec
from ._errors import SceneWarning

if TYPE_CHECKING:
    from ._scene import Scene

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


def scene_of(source: Any) -> Scene:
    """A scene of a `trimesh.Scene` or a `trimesh.Trimesh`, with its materials and textures.

    Each node with a mesh becomes an object of the node's name, placed as the scene's graph has it; nodes of the same mesh share
    it. Colours of vertices and faces, the materials of `trimesh.visual` and their pictures are taken over; cameras and lights
    are not. Where the metadata of a node or of its mesh has a "category", this is the object's.

    Args:
        source: the scene, or a mesh.

    Raises:
        TypeError: if it is neither.

    Warns:
        SceneWarning: if it has what is no mesh, such as paths and points, which are left out.

    Example:
        >>> import trimesh
        >>> ball = trimesh.creation.icosphere()
        >>> scene = bilux.trimesh.scene_of(trimesh.Scene({"ball": ball}))
        >>> scene.objects[0].name
        'ball'
    """
    from ._scene import Scene

    made = Scene()
    if hasattr(source, "vertices") and hasattr(source, "faces"):
        _add(made, source, [np.eye(4)], [str(source.metadata.get("name", ""))], [_category(source.metadata)])
        return made
    if not hasattr(source, "graph") or not hasattr(source, "geometry"):
        raise TypeError(f"source: {type(source).__name__} is neither a trimesh.Scene nor a trimesh.Trimesh")
    nodes: dict[str, list[str]] = {}
    for node in source.graph.nodes_geometry:
        nodes.setdefault(source.graph[node][1], []).append(node)
    left_out = []
    for name, places in nodes.items():
        mesh = source.geometry[name]
        if not hasattr(mesh, "faces") or len(mesh.faces) == 0:
            left_out.append(name)
            continue
        own = _category(mesh.metadata)
        categories = [_category(_metadata(source.graph, node)) or own for node in places]
        _add(made, mesh, [source.graph[node][0] for node in places], [str(node) for node in places], categories)
    if left_out:
        named = ", ".join(map(repr, left_out))
        warnings.warn(f"source: {named} is no mesh with triangles, and was left out", SceneWarning, stacklevel=2)
    return made


def _add(scene: Scene, mesh: Any, places: list[Any], names: list[str], categories: list[str]) -> None:
    """Adds the instances of a mesh."""
    vertices, triangles, visual = np.asarray(mesh.vertices), np.asarray(mesh.faces), mesh.visual
    normals = mesh.vertex_normals if "vertex_normals" in mesh._cache or len(vertices) < 3 * len(triangles) else None
    material, colors, uvs = None, None, None
    if getattr(visual, "uv", None) is not None and len(visual.uv) == len(vertices):
        uvs = np.asarray(visual.uv)
    if visual.kind == "texture":
        material = _material(visual.material, uvs is not None)
    elif visual.kind == "vertex":
        colors = np.asarray(visual.vertex_colors)
    elif visual.kind == "face":
        # Each face gets vertices of its own.
        colors = np.repeat(np.asarray(visual.face_colors), 3, axis=0)
        normals = None if normals is None else np.asarray(normals)[triangles.ravel()]
        vertices, triangles = vertices[triangles.ravel()], np.arange(triangles.size).reshape(-1, 3)
    stacked = np.stack([np.asarray(place, np.float64) for place in places])
    added = scene.add_instances(vertices, triangles, stacked, normals=normals, uvs=uvs, colors=colors, material=material)
    for number, name, category in zip(added, names, categories, strict=True):
        _bilux.set_name(scene, number, name)
        if category:
            scene.set_category(number, category)


def _material(given: Any, has_uvs: bool) -> Spec:
    """What is closest to a material of trimesh."""
    known: dict[str, Any] = {"base_color": _colour(_first(given, "baseColorFactor", "diffuse"))}
    known["base_metalness"] = _first(given, "metallicFactor")
    roughness = _first(given, "roughnessFactor")
    if roughness is None and _first(given, "glossiness") is not None:
        # The exponent of Phong's highlight, by the width of its lobe.
        roughness = (2 / (float(given.glossiness) + 2)) ** 0.25
    known["specular_roughness"] = roughness
    known["emission"] = _colour(_first(given, "emissiveFactor"))
    if has_uvs:
        picture = _pixels(_first(given, "baseColorTexture", "image"))
        if picture is not None:
            known["base_color"] = _bilux.Texture(_tinted(picture[..., :3], known["base_color"]))
            if picture.shape[2] == 4 and str(getattr(given, "alphaMode", None)) in ("MASK", "BLEND"):
                known["opacity"] = _bilux.Texture(picture[..., 3] / 255.0, data=True)
        both = _pixels(_first(given, "metallicRoughnessTexture"))
        if both is not None and both.shape[2] >= 3:
            metal, rough = known["base_metalness"], known["specular_roughness"]
            known["specular_roughness"] = _bilux.Texture(both[..., 1] / 255.0 * (1 if rough is None else rough), data=True)
            known["base_metalness"] = _bilux.Texture(both[..., 2] / 255.0 * (1 if metal is None else metal), data=True)
        for name, parameter, data in (("normalTexture", "normal", True), ("emissiveTexture", "emission", False)):
            picture = _pixels(_first(given, name))
            if picture is not None:
                known[parameter] = _bilux.Texture(np.ascontiguousarray(picture[..., :3]), data=data)
    parameters = {key: value for key, value in known.items() if value is not None}
    return Spec("materials", "principled", parameters, str(_first(given, "name") or ""))


def _tinted(picture: NDArray[Any], factor: tuple[float, float, float] | None) -> NDArray[Any]:
    """A picture of bytes, times a colour."""
    if factor is None or factor == (1.0, 1.0, 1.0):
        return np.ascontiguousarray(picture)
    shown = picture / 255.0
    linear = np.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4)
    tinted: NDArray[Any] = (linear * factor).astype(np.float32)
    return tinted


def _first(holder: Any, *names: str) -> Any:
    """The first attribute that there is."""
    return next((found for name in names if (found := getattr(holder, name, None)) is not None), None)


def _colour(value: Any) -> tuple[float, float, float] | None:
    """Three numbers proportional to light, of bytes as screens show them or of floats that are."""
    if value is None:
        return None
    array = np.asarray(value)
    numbers = array.ravel()[:3].astype(np.float64)
    if array.dtype == np.uint8:
        numbers = numbers / 255.0
    red, green, blue = numbers.tolist()
    return red, green, blue


def _pixels(picture: Any) -> NDArray[Any] | None:
    """The bytes of a picture of PIL: (height, width, channels)."""
    if picture is None:
        return None
    array = np.asarray(picture if picture.mode in ("RGB", "RGBA") else picture.convert("RGB"))
    return array if array.dtype == np.uint8 and array.ndim == 3 else None


def _metadata(graph: Any, node: str) -> dict[str, Any]:
    """What a graph knows of a node besides its place."""
    attributes = graph.transforms.node_data.get(node, {})
    found = attributes.get("metadata") or attributes.get("extras") or {}
    return dict(found)


def _category(metadata: Any) -> str:
    """The category that metadata name."""
    found = metadata.get("category", "") if isinstance(metadata, dict) else ""
    return found if isinstance(found, str) else ""
