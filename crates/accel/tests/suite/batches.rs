//! In a batch, each ray gets the same hit as on its own, bit for bit, whatever else is in the batch.

use crate::support::{Numbers, bits, build_variant, meshes, queries, rays, variants};
use bilux_accel::{Accelerator, BuildOptions, Hit, Query, Ray};
use bilux_testing::effort;
use rayon::prelude::*;
use std::sync::Arc;

/// Lengths around the kernels' group sizes.
const LENGTHS: [usize; 9] = [0, 1, 3, 15, 16, 17, 64, 255, 1000];

/// Marks elements that must not be written.
const UNTOUCHED: Hit = Hit { t: -7.0, u: 0.0, v: 0.0, primitive: 7, instance: 7 };

/// Rays as a camera sends them, tile by tile: coherent, except for a few.
fn camera(eye: [f32; 3], target: [f32; 3], spread: f32, count: usize, seed: u64) -> Vec<Ray> {
    let mut numbers = Numbers::new(seed);
    let one = |i: usize| {
        let (x, y) = ((i % 4 + i / 16 % 8 * 4) as f32, (i / 4 % 4 + i / 128 * 4) as f32);
        let at = [target[0] + x * spread, target[1] + y * spread, target[2] - x * spread * 0.3];
        Ray::new(eye, std::array::from_fn(|k| at[k] - eye[k]))
    };
    let mut all: Vec<Ray> = (0..count).map(one).collect();
    for ray in &mut all {
        match numbers.below(200) {
            0 => ray.t_max = 0.5,
            1 => ray.direction[0] = -ray.direction[0],
            2 => ray.direction[1] = f32::NAN,
            3 => ray.t_min = -1.0,
            4 => ray.direction[2] = -0.0,
            _ => {}
        }
    }
    all
}

/// Every kind of batch over a mesh.
fn kinds(mesh: &bilux_accel::TriangleMesh, seed: u64) -> Vec<(&'static str, Vec<Ray>)> {
    let mut kinds = vec![("nasty", rays::nasty(mesh, 1000, seed))];
    let bounds = mesh.bounds();
    if bounds.is_empty() {
        return kinds;
    }
    let (centre, size) = (bounds.centre().to_array(), bounds.extent().max_element().max(f32::MIN_POSITIVE));
    let around = |numbers: &mut Numbers, reach: f32| -> [f32; 3] {
        let v = numbers.vector();
        std::array::from_fn(|k| centre[k] + v[k] * size * reach)
    };
    let mut numbers = Numbers::new(seed + 100);
    let eye = around(&mut numbers, 1.5);
    kinds.push(("camera", camera(eye, around(&mut numbers, 0.3), size * 0.01, 1000, seed)));
    kinds.push(("wide camera", camera(eye, centre, size * 0.1, 1000, seed)));
    let parallel = camera([0.0; 3], [0.1, -0.4, 0.7], 0.0, 1000, seed).into_iter().enumerate();
    let spread = |i: usize, k: usize| [(i % 4) as f32, (i / 4 % 4) as f32, (i / 16) as f32][k] * 0.02 * size;
    let moved = parallel
        .map(|(i, ray)| Ray { origin: std::array::from_fn(|k| eye[k] + spread(i, k)), ..ray })
        .collect();
    kinds.push(("parallel", moved));
    let light = around(&mut numbers, 1.0);
    let mut to_light = rays::nasty(mesh, 1000, seed + 1);
    for ray in &mut to_light {
        ray.direction = std::array::from_fn(|k| light[k] - ray.origin[k]);
    }
    kinds.push(("to a light", to_light));
    kinds
}

fn check(name: &str, tree: &dyn Accelerator, rays: &[Ray], query: &Query, turn: usize) {
    let alone: Vec<Option<Hit>> = rays.iter().map(|ray| tree.closest_hit(ray, query)).collect();
    let mut from = 0;
    for (i, length) in LENGTHS.into_iter().enumerate() {
        let batch = &rays[from..rays.len().min(from + length)];
        let alone = &alone[from..from + batch.len()];
        from = (from + 29) % 400.min(rays.len());
        // As many elements as rays, fewer, more; in the short form one of these in turn.
        let places = [batch.len(), batch.len() / 2, batch.len() + 5];
        let first = (i + turn) % 3;
        for places in places[effort(first..first + 1, 0..3)].iter().copied() {
            let mut hits = vec![Some(UNTOUCHED); places];
            tree.closest_hits(batch, query, &mut hits);
            let mut any = vec![false; places];
            tree.any_hits(batch, query, &mut any);
            for (i, (hit, any)) in hits.iter().zip(&any).enumerate() {
                let (truth, what) = match alone.get(i) {
                    Some(hit) => (*hit, (name, length, places, i, batch[i])),
                    None => {
                        assert_eq!((*hit, *any), (Some(UNTOUCHED), false), "{name}: written beyond the rays");
                        continue;
                    }
                };
                assert_eq!(bits(*hit), bits(truth), "{what:?}");
                assert_eq!(*any, truth.is_some(), "{what:?}");
            }
        }
    }
}

/// Structures with their own batch traversal get every query; the others only loop.
fn check_kinds(
    name: &str,
    tree: &dyn Accelerator,
    brute: &dyn Accelerator,
    kinds: &[(&'static str, Vec<Ray>)],
) {
    let own = name.starts_with("bvh8 ");
    for (place, (kind, rays)) in kinds[..if own { kinds.len() } else { 1 }].iter().enumerate() {
        let name = format!("{name}, {kind}");
        let filter = |hit: &Hit| !hit.primitive.is_multiple_of(3) && hit.u < 0.7;
        let filtered = Query { filter: Some(&filter), ..Query::default() };
        let queries = queries();
        let queries = queries[..if own { 4 } else { 1 }].iter().chain([&filtered]).enumerate();
        // In the short form every second query, and the others with the next kind.
        for (turn, query) in queries.skip(effort(place % 2, 0)).step_by(effort(2, 1)) {
            check(&name, tree, &rays[..if own { rays.len() } else { 50 }], query, turn);
        }
        let query = Query::default();
        for ray in rays.iter().step_by(if own { 1 } else { 100 }) {
            let (hit, truth) = (tree.closest_hit(ray, &query), brute.closest_hit(ray, &query));
            assert_eq!(bits(hit), bits(truth), "{name}: {ray:?}");
        }
    }
}

#[test]
fn batches_give_the_hits_of_single_rays() {
    meshes::all().into_par_iter().enumerate().for_each(|(seed, (mesh_name, mesh))| {
        let mesh = Arc::new(mesh);
        let kinds = kinds(&mesh, seed as u64);
        let brute = build_variant("brute-simd", &BuildOptions::default(), &mesh);
        for (name, accelerator, options) in variants() {
            let tree = build_variant(accelerator, &options, &mesh);
            check_kinds(&format!("{name} on {mesh_name}"), tree.as_ref(), brute.as_ref(), &kinds);
        }
    });
}
