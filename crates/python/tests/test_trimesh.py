"""The adapter for trimesh, compared with trimesh's own queries."""

import copy
import pickle

import numpy as np
import pytest

import bilux

trimesh = pytest.importorskip("trimesh")


def own(mesh, **keywords):
    return bilux.trimesh.RayMeshIntersector(mesh, **keywords)


def reference(mesh):
    pytest.importorskip("rtree")
    from trimesh.ray.ray_triangle import RayMeshIntersector

    return RayMeshIntersector(mesh)


@pytest.fixture(params=["icosphere", "torus", "far"])
def mesh(request):
    if request.param == "icosphere":
        return trimesh.creation.icosphere(subdivisions=2)
    if request.param == "torus":
        return trimesh.creation.torus(2, 0.5)
    far = trimesh.creation.icosphere(subdivisions=2)
    far.apply_scale(1e-3)
    far.apply_translation([1e3, -1e3, 1e3])
    return far


@pytest.fixture
def rays(mesh):
    random = np.random.default_rng(3)
    origins = mesh.centroid + random.normal(size=(200, 3)) * mesh.scale * 2
    return origins, mesh.centroid + random.uniform(-0.3, 0.3, (200, 3)) * mesh.scale - origins


def rows(*columns):
    return sorted(zip(*(column.tolist() for column in columns)))


def test_all_queries_agree_with_those_of_trimesh(mesh, rays):
    ours, theirs = own(mesh), reference(mesh)
    assert np.array_equal(ours.intersects_any(*rays), theirs.intersects_any(*rays))
    assert np.array_equal(ours.intersects_first(*rays), theirs.intersects_first(*rays))
    assert rows(*ours.intersects_id(*rays)) == rows(*theirs.intersects_id(*rays))
    for multiple in [True, False]:
        places, ray, triangle = ours.intersects_location(*rays, multiple_hits=multiple)
        their_places, their_ray, their_triangle = theirs.intersects_location(*rays, multiple_hits=multiple)
        assert rows(ray, triangle) == rows(their_ray, their_triangle)
        order, their_order = np.lexsort((triangle, ray)), np.lexsort((their_triangle, their_ray))
        assert np.allclose(places[order], their_places[their_order], atol=1e-9 * abs(mesh.bounds).max())


def test_points_inside_are_found(mesh):
    random = np.random.default_rng(4)
    points = mesh.centroid + random.uniform(-0.6, 0.6, (500, 3)) * mesh.scale
    inside = own(mesh).contains_points(points)
    assert np.array_equal(inside, reference(mesh).contains_points(points))
    assert 5 < inside.sum() < 495


def test_a_ray_through_an_edge_or_a_vertex_crosses_once():
    box = trimesh.creation.box()
    box.ray = own(box)
    along = [[0, 0, -1.0]]
    for start in [[0, 0, 2], [0.25, 0.25, 2], [0.1, 0.3, 2], [0.25, -0.25, 2]]:
        assert len(box.ray.intersects_id([start], along)[0]) == 2
    round = trimesh.creation.icosphere(subdivisions=3)
    outward = round.vertices * 0.5
    assert own(round).contains_points(outward).all()
    hits = own(round).intersects_id(outward, round.vertices.copy())
    assert np.array_equal(hits[1], np.arange(len(outward)))


def test_a_changed_mesh_is_built_again():
    box = trimesh.creation.box()
    box.ray = own(box)
    ray = [[3, 0, 5.0]], [[0, 0, -1.0]]
    assert not box.ray.intersects_any(*ray)[0]
    box.apply_translation([3, 0, 0])
    assert box.ray.intersects_any(*ray)[0]
    assert pickle.loads(pickle.dumps(box.ray)).intersects_any(*ray)[0]
    assert copy.copy(box.ray).mesh is box and copy.deepcopy(box.ray).mesh is not box


def test_many_rays_agree_with_single_ones(mesh, rays):
    origins, directions = (np.tile(numbers, (20, 1)) for numbers in rays)
    ours = own(mesh)
    triangle, ray, places = ours.intersects_id(origins, directions, return_locations=True)
    assert len(ray) > 1000 and np.array_equal(np.sort(ray), ray)
    for number in [0, 150, 3999]:
        of_one = ours.intersects_id(origins[[number]], directions[[number]], return_locations=True)
        mine = ray == number
        assert np.array_equal(triangle[mine], of_one[0]) and np.array_equal(places[mine], of_one[2])
    first = ours.intersects_first(origins, directions)
    assert np.array_equal(first[np.unique(ray)], triangle[np.unique(ray, return_index=True)[1]])
    assert np.array_equal(first >= 0, ours.intersects_any(origins, directions))
    for most in [0, 1, 2]:
        kept = ours.intersects_id(origins, directions, max_hits=most)[1]
        assert np.array_equal(kept, np.repeat(np.arange(4000), np.minimum(np.bincount(ray, minlength=4000), most)))
    assert ours.intersects_first(origins[:1], directions[:1] * 1e-40) == ours.intersects_first(origins[:1], directions[:1] * 1e30)


def test_wrong_rays_are_refused_and_none_are_fine():
    box = trimesh.creation.box()
    with pytest.raises(ValueError, match="don't match"):
        own(box).intersects_any(np.ones((2, 3)), np.ones((3, 3)))
    with pytest.raises(ValueError, match="points"):
        own(box).contains_points([1, 2, 3])
    empty = np.zeros((0, 3))
    assert own(box).intersects_id(empty, empty)[0].shape == (0,)
    assert own(box).intersects_location(empty, empty)[0].shape == (0, 3)
    assert own(box).contains_points(empty).shape == (0,)
    assert own(trimesh.Trimesh()).intersects_any([[0, 0, 0.0]], [[0, 0, 1.0]]).tolist() == [False]


def test_scenes_are_taken_over_with_their_textures():
    image = pytest.importorskip("PIL.Image")
    corners = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
    pixels = np.zeros((2, 2, 3), np.uint8)
    # The upper left of the picture is red, the lower right blue.
    pixels[0, 0], pixels[1, 1] = (255, 0, 0), (0, 0, 255)
    visual = trimesh.visual.TextureVisuals(
        uv=[[0, 0], [1, 0], [1, 1], [0, 1]],
        material=trimesh.visual.material.PBRMaterial(
            baseColorTexture=image.fromarray(pixels), metallicFactor=0.0, roughnessFactor=1.0
        ),
    )
    card = trimesh.Trimesh(corners, [[0, 1, 2], [0, 2, 3]], visual=visual, process=False, metadata={"category": "card"})
    ball = trimesh.creation.icosphere(1)
    ball.visual = trimesh.visual.ColorVisuals(ball, vertex_colors=np.full((len(ball.vertices), 4), (0, 255, 0, 255), np.uint8))
    box = trimesh.creation.box()
    box.visual = trimesh.visual.ColorVisuals(box, face_colors=np.tile([255, 255, 0, 255], (12, 1)).astype(np.uint8))
    theirs = trimesh.Scene()
    theirs.add_geometry(card, node_name="card")
    theirs.add_geometry(ball, node_name="ball", transform=trimesh.transformations.translation_matrix([3, 0, 0]))
    for number in range(2):
        place = trimesh.transformations.translation_matrix([-3, 2 * number - 1, 0])
        theirs.add_geometry(box, node_name=f"box {number}", geom_name="box", transform=place)
    theirs.add_geometry(trimesh.load_path(np.array([[0, 0, 0], [1, 1, 1.0]])), node_name="path")
    with pytest.warns(bilux.SceneWarning, match="is no mesh with triangles"):
        scene = bilux.trimesh.scene_of(theirs)
    names = [thing.name for thing in scene.objects]
    assert sorted(names)[:2] == ["ball", "box 0"] and len(names) == 4
    assert scene.objects[names.index("card")].category == "card"
    np.testing.assert_allclose(scene.objects[names.index("ball")].transform[:3, 3], [3, 0, 0])
    scene.add_camera(bilux.cameras.orthographic(position=(0, 0, 9), look_at=(0, 0, 0), height=8))
    scene.add_light(bilux.lights.environment(radiance=1.0))
    picture = scene.render(size=(64, 64), spp=4, integrator="path", aov=["albedo", "ids"])
    at = lambda x, y: picture["albedo"][round(31.5 - 8 * y), round(31.5 + 8 * x)]  # noqa: E731
    assert at(-0.8, 0.8).argmax() == 0 and at(0.8, -0.8).argmax() == 2
    assert at(3, 0).argmax() == 1 and at(-3, 1)[2] < 0.1 < at(-3, 1)[1]
    with pytest.raises(TypeError, match="neither a trimesh.Scene nor"):
        bilux.trimesh.scene_of([1, 2])


def test_factors_of_metal_and_roughness_count_with_and_without_a_picture():
    """glTF 2.0, 3.9.2: roughness is in the green and metal in the blue of the picture, each times its factor."""
    image = pytest.importorskip("PIL.Image")
    picture = image.fromarray(np.full((2, 2, 3), (255, 51, 204), np.uint8))
    card = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
    for given, wanted in (
        ({"metallicFactor": 0.25, "roughnessFactor": 0.5}, (0.5 * 0.2, 0.25 * 0.8)),
        ({"metallicFactor": 0.75}, (0.2, 0.75 * 0.8)),
        ({"roughnessFactor": 0.25}, (0.25 * 0.2, 0.8)),
    ):
        for textured in (True, False):
            known = given | ({"metallicRoughnessTexture": picture} if textured else {})
            material = trimesh.visual.material.PBRMaterial(**known)
            visual = trimesh.visual.TextureVisuals(uv=[[0, 0], [1, 0], [1, 1], [0, 1]], material=material)
            mesh = trimesh.Trimesh(card, [[0, 1, 2], [0, 2, 3]], visual=visual, process=False)
            found = bilux.trimesh.scene_of(mesh).materials[0].parameters
            if not textured:
                assert found.get("specular_roughness") == given.get("roughnessFactor")
                assert found.get("base_metalness") == given.get("metallicFactor")
                continue
            for name, value in zip(("specular_roughness", "base_metalness"), wanted, strict=True):
                lit = bilux.Scene()
                glow = bilux.materials.principled(base_color=0.0, emission=found[name])
                lit.add_mesh(card, [[0, 1, 2], [0, 2, 3]], uvs=[[0, 0], [1, 0], [1, 1], [0, 1]], material=glow)
                lit.add_camera(bilux.cameras.orthographic(position=(0, 0, 9), look_at=(0, 0, 0), height=1))
                shown = lit.render(size=4, spp=1, integrator="path", max_depth=0).pixels[..., :3]
                assert np.allclose(shown, value, atol=1e-3), (name, given, shown[0, 0])
