//! Trees over parts of a mesh answer as brute force over the whole mesh does, bit for bit, one ray at a time and in
//! batches.

use crate::support::{Numbers, Truth, bits, build_variant, is_blocker, meshes, queries, rays, variants};
use bilux_accel::{
    Accelerator, BuildOptions, Counters, Forest, Hit, Primitive, Query, Ray, TriangleMesh, build,
};
use bilux_math::Aabb;
use bilux_testing::effort;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Ranges of triangles, dealt to so many trees at random.
fn deal(count: usize, trees: usize, seed: u64) -> Vec<Vec<Range<u32>>> {
    let (mut numbers, mut dealt, mut start) = (Numbers::new(seed), vec![Vec::new(); trees], 0);
    while start < count {
        let end = count.min(start + 1 + numbers.below(1 + count / (2 * trees)));
        dealt[numbers.below(trees)].push(start as u32..end as u32);
        start = end;
    }
    dealt
}

/// A forest of trees that `build` makes.
fn forest(
    mesh: &TriangleMesh,
    dealt: Vec<Vec<Range<u32>>>,
    build: impl Fn(&Arc<TriangleMesh>) -> Arc<dyn Accelerator>,
) -> Forest {
    let tree = |ranges: Vec<Range<u32>>| {
        let of = |range: &Range<u32>| mesh.triangles()[range.start as usize..range.end as usize].to_vec();
        let corners = ranges.iter().flat_map(of).collect();
        (build(&Arc::new(TriangleMesh::from_corners(corners).expect("few triangles"))), ranges)
    };
    Forest::new(dealt.into_iter().map(tree).collect())
}

#[test]
fn a_forest_gives_the_hits_of_brute() {
    for (seed, (mesh_name, mesh)) in meshes::all().into_iter().enumerate() {
        let mesh = Arc::new(mesh);
        let brute = build_variant("brute", &BuildOptions::default(), &mesh);
        let truth = Truth::new(brute.as_ref(), &rays::nasty(&mesh, effort(50, 300), seed as u64));
        variants().par_iter().enumerate().for_each(|(i, (name, accelerator, options))| {
            let trees = [1, 2, 3, 12][(seed + i) % 4];
            let dealt = deal(mesh.len(), trees, seed as u64);
            let forest = forest(&mesh, dealt, |mesh| build_variant(accelerator, options, mesh));
            let found = truth.differences(&forest);
            assert!(found.is_empty(), "{name} on {mesh_name}: {} differ, first {:#?}", found.len(), found[0]);
            let of = |b: Aabb| [b.min, b.max].map(|p| p.to_array().map(f32::to_bits));
            assert_eq!(of(Accelerator::bounds(&forest)), of(mesh.bounds()), "{name} on {mesh_name}");
        });
    }
}

#[test]
fn in_batches_each_ray_gets_its_own_hit() {
    for (seed, (mesh_name, mesh)) in meshes::all().into_iter().enumerate() {
        let auto = |mesh: &Arc<TriangleMesh>| build_variant("bvh8", &BuildOptions::default(), mesh);
        let forest = forest(&mesh, deal(mesh.len(), 3, seed as u64), auto);
        let rays = rays::nasty(&mesh, 500, seed as u64 + 9);
        for query in queries() {
            let alone = rays.iter().map(|ray| bits(forest.closest_hit(ray, &query)));
            let (mut hits, mut any) = (vec![None; rays.len() + 1], vec![true; rays.len() + 1]);
            forest.closest_hits(&rays, &query, &mut hits);
            forest.any_hits(&rays, &query, &mut any);
            let mut blockers = vec![None; rays.len()];
            forest.blockers(&rays, &query, &mut blockers);
            for (i, alone) in alone.enumerate() {
                assert_eq!(bits(hits[i]), alone, "{mesh_name}, ray {i}, {query:?}");
                assert_eq!(any[i], alone.is_some(), "{mesh_name}, ray {i}, {query:?}");
                let of_ray = (blockers[i], hits[i]);
                assert!(is_blocker(&forest, &rays[i], &query, of_ray), "{mesh_name}, ray {i}, {query:?}");
            }
            assert!(any[rays.len()], "one more than there are rays");
        }
    }
}

/// Two triangles at the same place, the lower one in the second tree.
fn twins() -> Forest {
    let one = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let far = one.map(|[x, y, z]: [f32; 3]| [x + 5.0, y, z]);
    let mesh = TriangleMesh::from_corners(vec![one, far, one]).expect("few triangles");
    let tree = |mesh: &Arc<TriangleMesh>| {
        Arc::from(build("auto", mesh.clone(), &BuildOptions::default()).expect("a few triangles"))
    };
    forest(&mesh, vec![vec![1..3], vec![0..1]], tree)
}

#[test]
fn ties_exclusions_and_filters_are_those_of_the_whole_mesh() {
    let (forest, plain) = (twins(), Query::default());
    let ray = Ray::new([0.25, 0.25, 1.0], [0.0, 0.0, -1.0]);
    let primitive = |hit: Option<Hit>| hit.map(|hit| hit.primitive);
    assert_eq!(primitive(forest.closest_hit(&ray, &plain)), Some(0), "the lowest triangle wins");
    let without = |index: u32| Ray { exclude: Primitive { instance: 0, index }, ..ray };
    assert_eq!(primitive(forest.closest_hit(&without(0), &plain)), Some(2));
    assert_eq!(primitive(forest.closest_hit(&without(2), &plain)), Some(0));
    let not_the_first = |hit: &Hit| hit.primitive != 0;
    let query = Query { filter: Some(&not_the_first), ..plain };
    assert_eq!(primitive(forest.closest_hit(&ray, &query)), Some(2));
    assert!(!forest.any_hit(&without(2), &query));
    let mut hits = [None; 3];
    forest.closest_hits(&[ray, without(0), without(2)], &plain, &mut hits);
    assert_eq!(hits.map(primitive), [Some(0), Some(2), Some(0)]);
    let all: Vec<u32> = forest.all_hits(&ray, &plain).iter().map(|hit| hit.primitive).collect();
    assert_eq!(all, [0, 2]);
    let mut counters = Counters::default();
    forest.closest_hit_counted(&ray, &plain, &mut counters);
    assert_eq!(counters.rays, 1, "a ray counts once, whatever the number of trees");
}
