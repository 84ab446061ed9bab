//! Rays from inside closed meshes always hit: a fraction of what `cargo run --release --example leak_hunt` does.

use crate::support::{build_variant, closed, variants};
use bilux_accel::{BuildOptions, Query};
use bilux_testing::effort;
use rayon::prelude::*;
use std::sync::Arc;

#[test]
fn rays_from_inside_closed_meshes_always_hit() {
    for closed in closed::all() {
        let mesh = Arc::new(closed.mesh());
        variants().par_iter().for_each(|(name, accelerator, options)| {
            let rays =
                if accelerator.starts_with("brute") { effort(100, 500) } else { effort(1_000, 15_000) };
            let structure = build_variant(accelerator, options, &mesh);
            for index in 0..rays {
                let ray = closed::ray(closed, 1, index);
                let hit = structure.closest_hit(&ray, &Query::default());
                assert!(hit.is_some(), "{name} leaks in {}: {ray:?}", closed.name);
            }
        });
    }
}

#[test]
fn an_open_mesh_leaks() {
    let closed = &closed::all()[1];
    let mut corners = closed.mesh().triangles().to_vec();
    corners.swap_remove(100);
    let mesh = Arc::new(bilux_accel::TriangleMesh::from_corners(corners).expect("few triangles"));
    let structure = build_variant("bvh", &BuildOptions::default(), &mesh);
    let leaks =
        |index: &u64| structure.closest_hit(&closed::ray(closed, 1, *index), &Query::default()).is_none();
    assert!((0..30_000).filter(leaks).count() > 0);
}
