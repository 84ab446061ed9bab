//! The examples run, and their assertions hold.

use crate::support::{build_variant, variants};
use bilux_accel::{Hit, Query, Ray, TriangleMesh};
use std::sync::Arc;

#[path = "../../examples/ambient_occlusion.rs"]
mod ambient_occlusion;
#[path = "../../examples/closest_hit.rs"]
mod closest_hit;
#[path = "../../examples/moving.rs"]
mod moving;

#[test]
fn every_example_runs() {
    closest_hit::main().unwrap();
    ambient_occlusion::main().unwrap();
    moving::main().unwrap();
}

#[test]
fn a_hit_knows_its_point_and_its_normal_and_has_no_negative_zero() {
    let corners = vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]];
    let mesh = Arc::new(TriangleMesh::new(corners, vec![[0, 1, 2]]).unwrap());
    // On the edges and at the corners, from both sides, and from the triangle itself.
    let places = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (2.0, 0.0), (0.0, 2.0), (0.5, 0.5)];
    let heights = [4.0f32, -4.0, 0.0, -0.0];
    let ray = |(x, z), y: f32| Ray::new([x, y, z], [0.0, -1f32.copysign(y), 0.0]);
    let rays: Vec<Ray> = places.into_iter().flat_map(|place| heights.map(|y| ray(place, y))).collect();
    for (name, accelerator, options) in variants() {
        let tree = build_variant(accelerator, &options, &mesh);
        let check = |ray: &Ray, hit: Hit| {
            let [x, _, z] = ray.origin;
            assert_eq!((hit.point(ray), hit.normal(&mesh)), ([x, 0.0, z], [0.0, -1.0, 0.0]), "{name}");
            let signs = [hit.t, hit.u, hit.v].map(f32::is_sign_negative);
            assert_eq!(signs, [false; 3], "{name}: {hit:?} of {ray:?}");
        };
        for ray in &rays {
            check(ray, tree.closest_hit(ray, &Query::default()).unwrap());
            check(ray, tree.all_hits(ray, &Query::default())[0]);
        }
        // Together, and as packets of rays side by side.
        let alike = rays.iter().map(|&ray| vec![ray; 64]);
        for batch in [rays.clone()].into_iter().chain(alike) {
            let mut hits = vec![None; batch.len()];
            tree.closest_hits(&batch, &Query::default(), &mut hits);
            batch.iter().zip(hits).for_each(|(ray, hit)| check(ray, hit.unwrap()));
        }
    }
}
