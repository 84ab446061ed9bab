//! Incoherent rays in a batch, which walk the upper levels of a tree together: each gets the hit that it gets on its
//! own, bit for bit, however many there are, and however their paths part.

use crate::support::{Numbers, SIEVE, bits, build_variant, is_blocker, variants};
use bilux_accel::{Accelerator, BuildOptions, CpuLevel, Culling, Hit, Primitive, Query, Ray, TriangleMesh};
use std::sync::Arc;

type Triangle = [[f32; 3]; 3];

/// Trees at every level and of every quality that `bvh8` can be built at, each with its name.
fn trees(corners: &[Triangle]) -> Vec<(String, Arc<dyn Accelerator>)> {
    let mesh = Arc::new(TriangleMesh::from_corners(corners.to_vec()).expect("few triangles"));
    let of_bvh8 = |(_, accelerator, _): &(String, &str, BuildOptions)| *accelerator == "bvh8";
    let build = |(name, accelerator, options): (String, &str, BuildOptions)| {
        (name, build_variant(accelerator, &options, &mesh))
    };
    variants().into_iter().filter(of_bvh8).map(build).collect()
}

/// All options of a query that a kernel sees.
fn queries() -> [Query<'static>; 5] {
    let plain = Query::default();
    [
        plain,
        Query { culling: Culling::Back, ..plain },
        Query { early_out: false, ..plain },
        Query { filter: Some(SIEVE), ..plain },
        Query { filter: Some(SIEVE), culling: Culling::Back, ..plain },
    ]
}

/// Checks batches of the given lengths, one after the other, against single rays; returns the number of hits.
fn check(name: &str, tree: &dyn Accelerator, rays: &[Ray], lengths: impl Iterator<Item = usize>) -> usize {
    let lengths: Vec<usize> = lengths.collect();
    let mut count = 0;
    for query in &queries() {
        let alone: Vec<Option<Hit>> = rays.iter().map(|ray| tree.closest_hit(ray, query)).collect();
        let mut begin = 0;
        for &length in &lengths {
            if begin + length > rays.len() {
                begin = 0;
            }
            let batch = &rays[begin..begin + length];
            let (mut hits, mut any) = (vec![None; length], vec![false; length]);
            tree.closest_hits(batch, query, &mut hits);
            tree.any_hits(batch, query, &mut any);
            let mut blockers = vec![None; length];
            tree.blockers(batch, query, &mut blockers);
            for (i, ray) in batch.iter().enumerate() {
                let what = || format!("{name}, {query:?}: ray {i} of {length}, {ray:?}");
                assert_eq!(bits(hits[i]), bits(alone[begin + i]), "{}", what());
                assert_eq!(any[i], alone[begin + i].is_some(), "{}", what());
                assert!(is_blocker(tree, ray, query, (blockers[i], alone[begin + i])), "{}", what());
                count += usize::from(any[i]);
            }
            begin += length;
        }
    }
    count
}

/// Small triangles all over a cube.
fn cloud(count: usize, size: f32, seed: u64) -> Vec<Triangle> {
    let mut numbers = Numbers::new(seed);
    let mut triangle = || {
        let at = numbers.vector();
        std::array::from_fn(|_| {
            let d = numbers.vector();
            std::array::from_fn(|k| at[k] + d[k] * size)
        })
    };
    (0..count).map(|_| triangle()).collect()
}

/// Rays in all directions, each 16 from nearly the same point, as bounces are; some are shorter than the rest, begin
/// later or exclude a primitive.
fn bounces(count: usize, primitives: usize, seed: u64) -> Vec<Ray> {
    let mut numbers = Numbers::new(seed);
    let mut from = [0.0; 3];
    let mut ray = |i: usize| {
        if i.is_multiple_of(16) {
            from = numbers.vector();
        }
        let away = numbers.vector();
        let mut ray = Ray::new(std::array::from_fn(|k| from[k] + away[k] * 0.01), numbers.vector());
        match numbers.below(8) {
            0 => ray.t_max = numbers.unit(),
            1 => ray.t_min = numbers.unit(),
            2 => ray.exclude = Primitive { instance: 0, index: numbers.below(primitives) as u32 },
            _ => {}
        }
        ray
    };
    (0..count).map(&mut ray).collect()
}

#[test]
fn every_length_gives_the_hits_of_single_rays() {
    let rays = bounces(1024, 3000, 1);
    for (name, tree) in trees(&cloud(3000, 0.08, 2)) {
        let hits = check(&name, tree.as_ref(), &rays, 1..=130);
        assert!(hits > 10_000, "{hits}");
    }
}

#[test]
fn zeros_and_ties_in_directions_change_nothing() {
    let mut rays = bounces(1024, 3000, 3);
    let mut numbers = Numbers::new(4);
    for ray in &mut rays {
        ray.direction = std::array::from_fn(|_| [0.0, -0.0, 0.7, -0.7, 0.3][numbers.below(5)]);
    }
    // On a grid, so that rays run in the planes of boxes.
    let round = |p: [f32; 3]| p.map(|x| (x * 8.0).round() / 8.0);
    let rays_on_grid: Vec<Ray> = rays.iter().map(|ray| Ray { origin: round(ray.origin), ..*ray }).collect();
    let corners = cloud(3000, 0.2, 5);
    let corners_on_grid: Vec<Triangle> = corners.iter().map(|triangle| triangle.map(round)).collect();
    for (corners, rays) in [(corners, rays), (corners_on_grid, rays_on_grid)] {
        for (name, tree) in trees(&corners) {
            let hits = check(&name, tree.as_ref(), &rays, [1024, 64, 100, 17].into_iter());
            assert!(hits > 1_000, "{hits}");
        }
    }
}

#[test]
fn equal_hits_go_to_the_lowest_primitive() {
    // Each triangle four times, in leaves far apart in the order of primitives.
    let once = cloud(500, 0.3, 6);
    let corners: Vec<Triangle> = (0..4).flat_map(|_| once.clone()).collect();
    let rays = bounces(1024, 2000, 7);
    for (name, tree) in trees(&corners) {
        assert!(check(&name, tree.as_ref(), &rays, [1024, 64].into_iter()) > 1_000);
    }
}

/// One, halved a number of times.
fn halved(times: usize) -> f32 {
    (0..times).fold(1.0, |x, _| x * 0.5)
}

/// Shells around the origin, each half as large as the last: a tree that is a chain.
#[test]
fn a_chain_of_nodes_is_walked_to_its_end() {
    let shell = |i: usize| {
        let scale = halved(i / 4);
        cloud(1, 0.6, 10 + i as u64)[0].map(|p| p.map(|x| x * scale))
    };
    let corners: Vec<Triangle> = (0..400).map(shell).collect();
    let mut rays = bounces(1024, 400, 8);
    let mut numbers = Numbers::new(9);
    for ray in &mut rays {
        let target = numbers.vector().map(|x| x * halved(numbers.below(100)));
        ray.direction = std::array::from_fn(|k| target[k] - ray.origin[k]);
        (ray.t_min, ray.t_max) = (0.0, f32::INFINITY);
    }
    for (name, tree) in trees(&corners) {
        assert!(check(&name, tree.as_ref(), &rays, [1024, 64, 33].into_iter()) > 1_000);
    }
}

/// Sixteen rows of 600 triangles across the paths of four rays each. A ray goes through the box of every triangle of
/// its row, and hits only one of them: it parts from the rays of other rows dozens of times.
#[test]
fn paths_that_part_often_lose_nothing() {
    let (rows, columns) = (16, 600);
    let turned = |row: usize, column: usize| column == (row * 331 + 57) % columns;
    let triangle = |i: usize| {
        let (row, column) = (i % rows, i / rows);
        let at = |y: f32, z: f32| [column as f32 * 0.05, row as f32 + y, z];
        let far = if turned(row, column) { at(0.9, 0.9) } else { at(0.0, 0.0) };
        [at(0.9, 0.0), at(0.0, 0.9), far]
    };
    let corners: Vec<Triangle> = (0..rows * columns).map(triangle).collect();
    let mut numbers = Numbers::new(11);
    let mut ray = |i: usize| {
        let row = (i / 2 % rows) as f32;
        let (y, z) = (row + 0.6 + numbers.unit() * 0.1, 0.6 + numbers.unit() * 0.1);
        let (x, dx) = if i.is_multiple_of(2) { (-1.0, 1.0) } else { (columns as f32 * 0.05 + 1.0, -1.0) };
        Ray::new([x, y, z], [dx, 0.0, 0.0])
    };
    let rays: Vec<Ray> = (0..1024).map(&mut ray).collect();
    for (name, tree) in trees(&corners) {
        // The filter and the side let fewer count.
        assert!(check(&name, tree.as_ref(), &rays, [1024, 64, 128].into_iter()) >= 1024 * 2);
    }
}

#[test]
fn levels_agree_bit_for_bit() {
    let corners = cloud(20_000, 0.05, 12);
    let mesh = Arc::new(TriangleMesh::from_corners(corners).expect("few triangles"));
    let rays = bounces(4096, 20_000, 13);
    let answers = |cpu_level: CpuLevel| {
        let options = BuildOptions { cpu_level: cpu_level.available(), ..BuildOptions::default() };
        let tree = build_variant("bvh8", &options, &mesh);
        let (mut hits, mut any) = (vec![None; rays.len()], vec![false; rays.len()]);
        tree.closest_hits(&rays, &Query::default(), &mut hits);
        tree.any_hits(&rays, &Query::default(), &mut any);
        (hits.into_iter().map(bits).collect::<Vec<_>>(), any)
    };
    let plain = answers(CpuLevel::Baseline);
    for level in CpuLevel::ALL {
        assert!(answers(level) == plain, "{}", level.name());
    }
}
