//! Trees against brute force, on deliberately awkward meshes and rays.

use super::BspTree;
use super::plane::{Plane, Space};
use super::tree::Branch;
use crate::registry::{BspGroup, BspSplit, Quality};
use crate::{
    Accelerator, BuildOptions, Counters, Culling, Primitive, Query, Ray, TreeShape, TriangleMesh, build,
};
use bilux_math::hash::{hash_words, unit_f32};
use bilux_math::registry::ParameterKind;
use bilux_math::{DVec3, Vec3, transcendental};
use std::sync::Arc;

type Triangle = [[f32; 3]; 3];

/// Deterministic pseudo-random numbers, the same on every machine.
struct Numbers(u64);

impl Numbers {
    fn bits(&mut self) -> u64 {
        self.0 += 1;
        hash_words([self.0])
    }
    fn unit(&mut self) -> f32 {
        unit_f32((self.bits() >> 32) as u32)
    }
    fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }
    /// Within the cube from -1 to 1.
    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }
    fn triangle(&mut self, size: f32) -> Triangle {
        let centre = self.vector();
        [0, 1, 2].map(|_| (centre + self.vector() * size).to_array())
    }
}

fn mapped(triangles: &[Triangle], map: impl Fn(Vec3) -> Vec3) -> Vec<Triangle> {
    triangles.iter().map(|triangle| triangle.map(|vertex| map(Vec3::from(vertex)).to_array())).collect()
}

/// A closed surface, partly convex and partly saddle-shaped, with outward normals.
fn torus(around: usize, across: usize) -> Vec<Triangle> {
    let point = |i: usize, j: usize| {
        let turn = |k: usize, of: usize| (k % of) as f32 / of as f32 * std::f32::consts::TAU;
        let (a, b) = (turn(i, around), turn(j, across));
        let radius = 1.0 + 0.4 * transcendental::cos(b);
        [radius * transcendental::cos(a), 0.4 * transcendental::sin(b), radius * transcendental::sin(a)]
    };
    let quad = |k: usize| {
        let (i, j) = (k / across, k % across);
        let [a, b, c, d] = [point(i, j), point(i, j + 1), point(i + 1, j + 1), point(i + 1, j)];
        [[a, b, c], [a, c, d]]
    };
    (0..around * across).flat_map(quad).collect()
}

/// Squares in the plane y = 0, in rows.
fn floor(n: usize) -> Vec<Triangle> {
    let point = |i: usize, j: usize| [i as f32 / n as f32, 0.0, j as f32 / n as f32];
    let square = |k: usize| {
        let (i, j) = (k / n, k % n);
        let [a, b, c, d] = [point(i, j), point(i, j + 1), point(i + 1, j + 1), point(i + 1, j)];
        [[a, b, c], [a, c, d]]
    };
    (0..n * n).flat_map(square).collect()
}

/// Meshes that are degenerate or awkward in some way, by name.
fn meshes() -> Vec<(&'static str, TriangleMesh)> {
    let mut numbers = Numbers(1);
    let soup: Vec<Triangle> = (0..300).map(|_| numbers.triangle(0.15)).collect();
    let large: Vec<Triangle> = (0..80).map(|_| numbers.triangle(1.0)).collect();
    let slivers: Vec<Triangle> = (0..150)
        .map(|_| {
            let (a, b) = (numbers.vector(), numbers.vector());
            [a, b, (a + b) * 0.5 + numbers.vector() * 1e-6].map(|v| v.to_array())
        })
        .collect();
    let points: Vec<Triangle> = (0..60)
        .map(|k| {
            let (a, b) = (numbers.vector(), numbers.vector());
            if k % 2 == 0 { [a; 3] } else { [a, b, a.lerp(b, 0.25)] }.map(|v| v.to_array())
        })
        .collect();
    let mut broken = soup.clone();
    for (k, triangle) in broken.iter_mut().enumerate().filter(|(k, _)| k % 7 == 0) {
        triangle[k % 3][k % 2] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY][k % 3];
    }
    let fan = |k: usize| {
        let rim = |k: usize| {
            let angle = k as f32 / 40.0 * std::f32::consts::TAU;
            [transcendental::cos(angle), 0.1, transcendental::sin(angle)]
        };
        [[0.0; 3], rim(k), rim(k + 1)]
    };
    let torus = torus(24, 12);
    let slanted = |v: Vec3| Vec3::new(v.x - v.z, v.x + v.z, 0.5 * v.x);
    let two = [mapped(&torus, |v| v - 1.0), mapped(&torus, |v| v + 1.0)].concat();
    let scaled = |factor: f32| mapped(&soup, |v| v * factor);
    [
        ("soup", soup.clone()),
        ("large", large),
        ("slivers", slivers),
        ("points and segments", points.clone()),
        ("with points and segments", [soup.clone(), points].concat()),
        ("broken", broken),
        ("nothing but broken", vec![[[f32::NAN; 3]; 3]; 3]),
        ("empty", Vec::new()),
        ("one", soup[..1].to_vec()),
        ("the same 100 times", vec![soup[0]; 100]),
        ("twice", [torus.clone(), torus.clone()].concat()),
        ("fan", (0..40).map(fan).collect()),
        ("floor", floor(10)),
        ("slanted floor", mapped(&floor(10), slanted)),
        ("far away", mapped(&torus, |v| v * 0.1 + Vec3::new(1000.0, -2000.0, 500.0))),
        ("flat", mapped(&soup, |v| v * Vec3::new(1.0, 1.0, 1e-7))),
        ("large and small", [mapped(&torus, |v| v * 0.001), mapped(&floor(1), |v| v * 100.0)].concat()),
        ("huge", scaled(1e30)),
        ("greatest", scaled(2e38)),
        ("tiny", scaled(1e-30)),
        ("subnormal", scaled(1e-40)),
        ("torus", torus),
        ("two tori", two),
    ]
    .map(|(name, triangles)| {
        let n = triangles.len() as u32;
        let groups = [0..n / 4, n / 4..n / 2, n / 2..n / 2, n / 2..n].into();
        (name, TriangleMesh::from_corners(triangles).and_then(|mesh| mesh.with_groups(groups)).unwrap())
    })
    .into()
}

/// Rays at vertices, along edges, along axes, from surfaces, from far and near; long, short and bounded.
fn rays(mesh: &TriangleMesh, count: usize) -> Vec<Ray> {
    let mut numbers = Numbers(1 << 32);
    let bounds = mesh.bounds();
    let (centre, extent) = if bounds.is_empty() {
        (Vec3::ZERO, Vec3::ONE)
    } else {
        (bounds.centre(), bounds.max * 0.5 - bounds.min * 0.5)
    };
    let size = extent.max_element().max(f32::MIN_POSITIVE);
    let on_surface = |numbers: &mut Numbers| {
        if mesh.is_empty() {
            return Vec3::ZERO;
        }
        let [a, b, c] = mesh.triangles()[numbers.below(mesh.len())].map(Vec3::from);
        match numbers.below(4) {
            0 => a,
            1 => a.lerp(b, numbers.unit()),
            2 => (a + b + c) / 3.0,
            _ => a.lerp(b, numbers.unit()).lerp(c, numbers.unit()),
        }
    };
    (0..count)
        .map(|k| {
            let near = centre + numbers.vector() * extent * 1.2;
            let origin = match numbers.below(6) {
                0 => on_surface(&mut numbers),
                1 => centre + numbers.vector() * (size * 50.0),
                _ => near,
            };
            let target = on_surface(&mut numbers);
            let mut direction = match numbers.below(8) {
                0 => numbers.vector(),
                1 => [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z][numbers.below(6)],
                2 => (target - origin) * Vec3::from([[1.0, 0.0, 1.0], [-0.0, 1.0, 1.0]][numbers.below(2)]),
                3 => target - on_surface(&mut numbers),
                _ => target - origin,
            };
            if numbers.below(3) == 0 {
                direction *= [1e-3, 1e6, 1e-25, 1e25, 1e-38][numbers.below(5)];
            }
            let (mut ray, index) = (Ray::new(origin.to_array(), direction.to_array()), k as u32 / 2);
            match numbers.below(6) {
                0 => ray.t_max = numbers.unit() * 1.5,
                1 => (ray.t_min, ray.t_max) = (-1.0, 1.0),
                2 => ray.exclude = Primitive { instance: 0, index: index % mesh.len().max(1) as u32 },
                _ => {}
            }
            ray
        })
        .collect()
}

fn queries() -> impl Iterator<Item = Query<'static>> {
    (0..8).map(|bits| Query {
        culling: if bits & 1 == 0 { Culling::None } else { Culling::Back },
        early_out: bits & 2 == 0,
        cull_by_partition: bits & 4 == 0,
        ..Query::default()
    })
}

fn trees(mesh: &TriangleMesh) -> Vec<(String, BspTree)> {
    let mut trees = Vec::new();
    for split in [BspSplit::Mean, BspSplit::Fuchs] {
        for group in [BspGroup::Polygons, BspGroup::Objects] {
            trees.push((format!("{split:?} {group:?}"), BspTree::paper(mesh, split, group).unwrap()));
        }
    }
    for quality in [Quality::Fast, Quality::Balanced, Quality::Best] {
        trees.push((format!("Sah {quality:?}"), BspTree::sah(mesh, quality).unwrap()));
    }
    trees
}

/// The first ray for which a tree's answer differs from brute force.
fn disagreement(mesh: &TriangleMesh, tree: &dyn Accelerator, count: usize) -> Option<String> {
    let brute = build("brute", Arc::new(mesh.clone()), &BuildOptions::default()).unwrap();
    for ray in rays(mesh, count) {
        for query in queries() {
            let (truth, answer) = (brute.closest_hit(&ray, &query), tree.closest_hit(&ray, &query));
            if truth.map(bits) != answer.map(bits) {
                return Some(format!("{truth:?} is not {answer:?}: {ray:?} {query:?}"));
            }
            if tree.any_hit(&ray, &query) != truth.is_some() {
                return Some(format!("anything, {truth:?}: {ray:?} {query:?}"));
            }
        }
    }
    None
}

fn bits(hit: crate::Hit) -> [u32; 5] {
    [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.primitive, hit.instance]
}

#[test]
fn every_tree_answers_as_brute_force_does() {
    for (name, mesh) in meshes() {
        for (rule, tree) in trees(&mesh) {
            if let Some(what) = disagreement(&mesh, &tree, 400) {
                panic!("{rule} over {name}: {what}");
            }
        }
    }
}

#[test]
fn every_point_of_a_triangle_is_in_a_leaf_that_holds_it() {
    for (name, mesh) in meshes() {
        for (rule, tree) in trees(&mesh) {
            assert_eq!(tree.validate(&mesh, 5), Ok(()), "{rule} over {name}");
        }
    }
}

/// The planted bug that the two tests above must detect: one side of a plane lacks a triangle that belongs there.
#[test]
fn a_lost_reference_is_detected() {
    let mesh = TriangleMesh::from_corners(floor(4)).unwrap();
    let space = Space::new(&mesh.bounds());
    let tree = |plane: Plane| {
        let children = Box::new([Branch::Leaf((0..16).collect()), Branch::Leaf((16..32).collect())]);
        let root = Branch::Fork { plane, on: Vec::new(), children };
        BspTree::new(&mesh, &space, &root, false).unwrap()
    };
    let right = tree(Plane::perpendicular(0, 0.0));
    assert_eq!(right.validate(&mesh, 5), Ok(()));
    assert_eq!(disagreement(&mesh, &right, 500), None);
    let wrong = tree(Plane::perpendicular(0, 0.01));
    assert!(wrong.validate(&mesh, 20).is_err());
    assert!(disagreement(&mesh, &wrong, 2000).is_some());
}

/// The work done by rays that see the whole mesh from outside.
fn work(mesh: &TriangleMesh, tree: &dyn Accelerator, query: Query) -> Counters {
    let mut counters = Counters::default();
    let mut numbers = Numbers(7);
    for _ in 0..500 {
        let origin = mesh.bounds().centre() + numbers.vector().normalize() * mesh.bounds().radius() * 2.0;
        let target = mesh.bounds().centre() + numbers.vector() * mesh.bounds().extent() * 0.4;
        let ray = Ray::new(origin.to_array(), (target - origin).to_array());
        tree.closest_hit_counted(&ray, &query, &mut counters);
    }
    counters
}

#[test]
fn back_faces_are_rejected_by_side_and_only_when_asked() {
    let mesh = TriangleMesh::from_corners(torus(40, 20)).unwrap();
    for split in [BspSplit::Mean, BspSplit::Fuchs] {
        let tree = BspTree::paper(&mesh, split, BspGroup::Polygons).unwrap();
        // Where every leaf on the way is visited, about half of its triangles face away.
        let culling = Query { culling: Culling::Back, early_out: false, ..Query::default() };
        let with = work(&mesh, &tree, culling);
        let without = work(&mesh, &tree, Query { cull_by_partition: false, ..culling });
        assert_eq!(work(&mesh, &tree, Query::default()).culled_back_faces, 0);
        assert_eq!(without.culled_back_faces, 0);
        assert_eq!(with.triangles + with.culled_back_faces, without.triangles, "{split:?}");
        let culled = with.culled_back_faces as f64 / without.triangles as f64;
        assert!(culled > 0.4 && culled < 0.6, "{split:?}: {culled}");
    }
}

#[test]
fn early_outs_save_work_and_can_be_switched_off() {
    let mesh = TriangleMesh::from_corners(torus(40, 20)).unwrap();
    for (rule, tree) in trees(&mesh).iter().filter(|(rule, _)| !rule.contains("Objects")) {
        let on = work(&mesh, tree, Query::default());
        let off = work(&mesh, tree, Query { early_out: false, ..Query::default() });
        assert!(on.early_outs > 0 && off.early_outs == 0, "{rule}");
        assert!(on.triangles < off.triangles && on.nodes < off.nodes, "{rule}: {on:?} {off:?}");
    }
}

#[test]
fn most_triangles_are_never_tested() {
    let mesh = TriangleMesh::from_corners(torus(80, 40)).unwrap();
    for (rule, most) in [("Mean Polygons", 150.0), ("Fuchs Polygons", 50.0), ("Sah Balanced", 5.0)] {
        let (_, tree) = trees(&mesh).into_iter().find(|(name, _)| name == rule).unwrap();
        let counters = work(&mesh, &tree, Query::default());
        let tests = counters.triangles as f64 / counters.rays as f64;
        assert!(tests < most, "{rule}: {tests}");
    }
}

#[test]
fn references_and_depth_stay_within_their_limits() {
    for (name, mesh) in meshes() {
        for (rule, tree) in trees(&mesh) {
            let cap = if rule.contains("Sah") { super::sah::GROWTH } else { super::paper::GROWTH };
            let TreeShape { references, depth, .. } = tree.shape();
            assert!(references as f64 <= cap * mesh.len() as f64, "{rule} over {name}: {references}");
            assert!(depth <= super::tree::MAX_DEPTH + 2, "{rule} over {name}: {depth}");
        }
    }
}

/// Triangles that no plane can separate end in one leaf, whichever rule searches for a plane.
#[test]
fn planes_that_make_no_progress_end_in_a_leaf() {
    let spokes = |k: usize| {
        let mut numbers = Numbers(k as u64 * 8);
        let (a, b) = (numbers.vector(), numbers.vector());
        [a, b, -(a + b)].map(|v| v.to_array())
    };
    let through_the_middle: Vec<Triangle> = (0..200).map(spokes).collect();
    for triangles in [vec![floor(1)[0]; 500], through_the_middle] {
        let mesh = TriangleMesh::from_corners(triangles).unwrap();
        for (rule, tree) in trees(&mesh) {
            let shape = tree.shape();
            assert!(shape.references <= 8 * mesh.len(), "{rule}: {shape:?}");
            assert!(shape.depth < 40, "{rule}: {shape:?}");
            assert_eq!(disagreement(&mesh, &tree, 50), None, "{rule}");
        }
    }
}

#[test]
fn fuchs_keeps_coplanar_polygons_in_their_plane() {
    let stairs: Vec<Triangle> =
        (0..6).flat_map(|k| mapped(&floor(4), move |v| v + Vec3::new(0.0, k as f32, 0.0))).collect();
    let mesh = TriangleMesh::from_corners(stairs).unwrap();
    let tree = BspTree::paper(&mesh, BspSplit::Fuchs, BspGroup::Polygons).unwrap();
    // Each plane takes a whole floor of 32 triangles, and nothing is cut.
    assert_eq!(tree.shape().references, mesh.len());
    assert!(tree.shape().leaf_sizes[16] >= 5, "{:?}", tree.shape());
}

#[test]
fn objects_stay_whole() {
    let parts: Vec<Triangle> =
        (0..8).flat_map(|k| mapped(&torus(12, 6), move |v| v * 0.3 + Vec3::splat(k as f32))).collect();
    let each = parts.len() as u32 / 8;
    let groups = (0..8).map(|k| k * each..(k + 1) * each).collect();
    let mesh = TriangleMesh::from_corners(parts).unwrap().with_groups(groups).unwrap();
    for split in [BspSplit::Mean, BspSplit::Fuchs] {
        let tree = BspTree::paper(&mesh, split, BspGroup::Objects).unwrap();
        let shape = tree.shape();
        assert_eq!(shape.references % each as usize, 0);
        assert_eq!(shape.leaf_sizes[1..16], [0; 15], "{split:?}");
        assert!(shape.leaves >= 8 && shape.references < mesh.len() * 2, "{split:?}: {shape:?}");
        assert_eq!(disagreement(&mesh, &tree, 300), None);
    }
}

#[test]
fn trees_do_not_depend_on_threads() {
    let mesh = TriangleMesh::from_corners(torus(60, 40)).unwrap();
    let grown = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| format!("{:?}", trees(&mesh)))
    };
    assert!(grown(1) == grown(4));
}

#[test]
fn axis_aligned_planes_are_recognised() {
    let plane = Plane::through(DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0)).unwrap();
    assert_eq!(plane.axis(), None);
    assert_eq!(Plane::through(DVec3::ONE, DVec3::new(0.0, -2.0, 0.0)).unwrap().axis(), Some(1));
    assert!(Plane::through(DVec3::ONE, DVec3::ZERO).is_none());
}

#[test]
fn every_listed_choice_parses_and_the_listed_default_is_the_default() {
    for parameter in super::paper::ENTRY.entry.parameters {
        let ParameterKind::Choice(choices) = parameter.kind else { panic!("{}", parameter.name) };
        let known = |choice: &str| match parameter.name {
            "bsp_split" => BspSplit::from_name(choice).map(|split| split == BspSplit::default()),
            "bsp_group" => BspGroup::from_name(choice).map(|group| group == BspGroup::default()),
            other => panic!("{other}"),
        };
        for &choice in choices {
            assert_eq!(known(choice), Some(choice == parameter.default), "{choice}");
        }
        assert_eq!(known("none"), None);
    }
}
