"""Ray queries, compared with a loop in numpy."""

import pickle

import numpy as np
import pytest

import bilux


@pytest.fixture(scope="module")
def soup():
    """Triangles and rays at random."""
    random = np.random.default_rng(5)
    corners = random.uniform(-1, 1, (200, 1, 3)) + random.uniform(-0.3, 0.3, (200, 3, 3))
    vertices = corners.reshape(-1, 3).astype(np.float32)
    origins = random.uniform(-3, 3, (500, 3)).astype(np.float32)
    return vertices, np.arange(600).reshape(-1, 3), origins, (random.uniform(-1, 1, (500, 3)) - origins).astype(np.float32)


def by_hand(vertices, triangles, origins, directions):
    """The distance of every ray along every triangle's plane, infinite where it misses. [Möller 1997]"""
    a, b, c = np.moveaxis(vertices.astype(float)[triangles], 1, 0)
    o, d = origins.astype(float)[:, None], directions.astype(float)[:, None]
    p = np.cross(d, c - a)
    det = np.einsum("rti,ti->rt", p, b - a)
    s = o - a
    u = np.einsum("rti,rti->rt", s, p) / det
    q = np.cross(s, b - a)
    v = np.einsum("rti,rti->rt", np.broadcast_to(d, q.shape), q) / det
    t = np.einsum("rti,ti->rt", q, c - a) / det
    return np.where((u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0), t, np.inf), u, v


@pytest.mark.parametrize("kind", ["auto", "brute", "bvh", "kd", "bsp"])
def test_the_closest_hit_is_the_one_found_by_hand(soup, kind):
    vertices, triangles, origins, directions = soup
    t, u, v = by_hand(*soup)
    hits = bilux.Accel(vertices, triangles, kind=kind).closest(origins, directions)
    first = t.argmin(1)
    hit = np.isfinite(t.min(1))
    assert 100 < hit.sum() < 500
    assert np.array_equal(np.isfinite(hits.t), hit) and np.array_equal(hits.primitive, np.where(hit, first, -1))
    assert np.allclose(hits.t[hit], t.min(1)[hit], rtol=1e-5)
    rays = np.arange(500)[hit]
    assert np.allclose(hits.u[hit], u[rays, first[hit]], atol=1e-4) and np.allclose(hits.v[hit], v[rays, first[hit]], atol=1e-4)
    assert np.allclose(hits.point[hit], (origins + directions * hits.t[:, None])[hit], atol=1e-5)
    assert np.isnan(hits.point[~hit]).all() and np.isnan(hits.normal[~hit]).all()
    corners = vertices[triangles[first[hit]]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.allclose(hits.normal[hit], normal / np.linalg.norm(normal, axis=1)[:, None], atol=1e-4)
    assert hits.t.dtype == np.float32 and hits.primitive.dtype == np.int64 and hits.point.shape == (500, 3)


@pytest.mark.parametrize("layout", ["packed", "big-endian", "columns", "reversed", "read-only", "float64", "broadcast"])
def test_any_layout_of_an_array_will_do(soup, layout):
    vertices, triangles, origins, directions = soup
    accel = bilux.Accel(vertices, triangles)
    if layout == "packed":
        bytes = np.zeros(origins.nbytes + 1, np.uint8)
        other = bytes[1:].view(np.float32).reshape(-1, 3)
        other[:] = origins
        assert not other.flags.aligned
    elif layout == "broadcast":
        other = np.broadcast_to(origins[0], origins.shape)
    else:
        other = {
            "big-endian": origins.astype(">f4"),
            "columns": np.asfortranarray(origins),
            "reversed": origins[::-1].copy()[::-1],
            "read-only": origins.copy(),
            "float64": origins.astype(float),
        }[layout]
        other.flags.writeable = layout != "read-only"
    expected = accel.closest(np.array(other), directions)
    for one, same in zip(accel.closest(other, directions), expected):
        assert np.array_equal(one, same, equal_nan=True)


def test_the_first_row_that_is_not_finite_is_named(soup):
    vertices, triangles, origins, directions = soup
    accel = bilux.Accel(vertices, triangles)
    many = np.tile(directions, (20, 1))
    many[[7_000, 9_999], 1] = np.nan
    for query in [accel.closest, accel.any, accel.all_hits]:
        with pytest.raises(ValueError, match="directions: row 7000 is .*NaN"):
            query(origins[:1], many)
    with pytest.raises(ValueError, match="b: row 7000"):
        accel.visible(origins[:1], many)
    with pytest.raises(ValueError, match="a: row 0 "):
        accel.visible([[np.inf, 0, 0]], many)


def test_distances_that_are_not_numbers_are_refused(soup):
    vertices, triangles, origins, directions = soup
    accel = bilux.Accel(vertices, triangles)
    for name in ["t_min", "t_max"]:
        with pytest.raises(ValueError, match=f"{name}: NaN"):
            accel.closest(origins, directions, **{name: np.nan})
    with pytest.raises(ValueError, match="within: NaN"):
        accel.nearest_point(origins, within=np.nan)


def test_the_other_queries_agree(soup):
    vertices, triangles, origins, directions = soup
    t = by_hand(*soup)[0]
    accel = bilux.Accel(vertices, triangles)
    assert np.array_equal(accel.any(origins, directions), np.isfinite(t.min(1)))
    all_hits = accel.all_hits(origins, directions)
    assert len(all_hits.ray) == np.isfinite(t).sum()
    assert set(zip(all_hits.ray, all_hits.primitive)) == set(zip(*np.nonzero(np.isfinite(t))))
    assert np.array_equal(np.lexsort((all_hits.t, all_hits.ray)), np.arange(len(all_hits.ray)))
    blocked = ((t > 1e-4) & (t < 1 - 1e-4)).any(1)
    assert np.array_equal(accel.visible(origins, origins + directions), ~blocked)
    short = accel.closest(origins, directions, t_max=0.5)
    assert np.array_equal(np.isfinite(short.t), t.min(1) <= 0.5)


def test_one_origin_or_direction_serves_all(square):
    accel = bilux.Accel(*square)
    hits = accel.closest([[0.5, 0.5, 2]], [[0, 0, -1], [0, 0, 1], [0, 0, -2]])
    assert hits.t.tolist() == [2, np.inf, 1]
    assert accel.any([[0.5, 0.5, 2], [5, 5, 2]], [[0, 0, -1]]).tolist() == [True, False]
    assert accel.any([[0.5, 0.5, -2]], [[0, 0, 1]], cull_back=True).tolist() == [False]


def test_points_on_triangles_see_each_other(square):
    accel = bilux.Accel(*square)
    on, above, below = [[0.4, 0.3, 0]], [[0.4, 0.3, 1]], [[0.4, 0.3, -1]]
    assert accel.visible(on, above)[0] and accel.visible(above, on)[0]
    assert not accel.visible(above, below)[0] and not accel.visible(above, below, margin=0)[0]
    assert not accel.visible(on, above, margin=0)[0] and not accel.visible(above, on, margin=0)[0]


def test_nearest_points(square):
    near = bilux.Accel(*square).nearest_point([[0.25, 0.5, 3], [2, 0, 0], [9, 9, 9]], within=4)
    assert near.distance.tolist() == [3, 1, np.inf] and near.primitive[2] == -1
    assert near.point[:2].tolist() == [[0.25, 0.5, 0], [1, 0, 0]]


def test_many_rays_are_as_few(square):
    accel = bilux.Accel(*square)
    random = np.random.default_rng(1)
    origins = random.uniform(-1, 2, (20_000, 3)).astype(np.float32)
    directions = random.normal(size=(20_000, 3)).astype(np.float32)
    many = accel.closest(origins, directions)
    few = [accel.closest(origins[i : i + 7], directions[i : i + 7]) for i in range(0, 20_000, 4999)]
    for part, i in zip(few, range(0, 20_000, 4999)):
        assert all(np.array_equal(a, b[i : i + 7], equal_nan=True) for a, b in zip(part, many))
    empty = accel.closest(np.zeros((0, 3)), np.zeros((0, 3)))
    assert empty.t.shape == (0,) and empty.point.shape == (0, 3)


def test_an_empty_mesh_is_never_hit():
    accel = bilux.Accel(np.zeros((0, 3)), np.zeros((0, 3), int))
    assert not accel.any([[0, 0, 0]], [[0, 0, 1]])[0] and len(accel) == 0
    assert accel.nearest_point([[0, 0, 0]]).primitive[0] == -1


def test_wrong_arguments_are_named(square):
    accel = bilux.Accel(*square)
    one = [[0.0, 0.0, 1.0]]
    with pytest.raises(ValueError, match=r"origins: its shape is \(3,\)"):
        accel.closest([0, 0, 1], one)
    with pytest.raises(ValueError, match="directions: there are 2 rows for 3 of origins"):
        accel.any(np.ones((3, 3)), np.ones((2, 3)))
    with pytest.raises(ValueError, match="directions: row 1 is"):
        accel.closest(one, [[0, 0, 1], [0, np.nan, 1]])
    with pytest.raises(TypeError, match="points"):
        accel.nearest_point("here")
    with pytest.raises(ValueError, match="margin"):
        accel.visible(one, one, margin=0.7)
    with pytest.raises(ValueError, match="kind: .*'bvh88'.*'bvh8'"):
        bilux.Accel(*square, kind="bvh88")
    with pytest.raises(ValueError, match="quality"):
        bilux.Accel(*square, quality="good")
    with pytest.raises(ValueError, match="triangles: row 1 has the index 9"):
        bilux.Accel(square[0], [[0, 1, 2], [0, 1, 9]])


def test_structures_are_pickled(soup):
    accel = bilux.Accel(*soup[:2], kind="bvh", quality="fast")
    other = pickle.loads(pickle.dumps(accel))
    assert other.kind == "bvh" and len(other) == len(accel)
    assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(other.closest(*soup[2:]), accel.closest(*soup[2:])))
