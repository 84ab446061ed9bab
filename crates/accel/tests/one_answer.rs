//! Every structure gives the hits of `brute`, bit for bit, on what has hurt ray tracers.

mod support;

use bilux_accel::{ACCELERATORS, BuildOptions, Query};
use std::sync::Arc;
use support::{Truth, build_variant, meshes, rays, variants};

#[test]
fn every_structure_gives_the_hits_of_brute() {
    for (seed, (mesh_name, mesh)) in meshes::all().into_iter().enumerate() {
        let mesh = Arc::new(mesh);
        let brute = build_variant("brute", &BuildOptions::default(), &mesh);
        let truth = Truth::new(brute.as_ref(), &rays::nasty(&mesh, 2000, seed as u64));
        assert!(mesh.is_empty() || truth.hits() > 500, "{mesh_name}: only {} hits", truth.hits());
        for (name, accelerator, options) in variants() {
            let found = truth.differences(build_variant(accelerator, &options, &mesh).as_ref());
            assert!(found.is_empty(), "{name} on {mesh_name}: {} differ, first {:#?}", found.len(), found[0]);
        }
    }
}

#[test]
fn senseless_rays_hit_nothing_anywhere() {
    for (_, mesh) in meshes::all() {
        let mesh = Arc::new(mesh);
        for row in ACCELERATORS {
            let structure = build_variant(row.entry.name, &BuildOptions::default(), &mesh);
            for ray in rays::senseless() {
                assert_eq!(structure.closest_hit(&ray, &Query::default()), None);
                assert!(!structure.any_hit(&ray, &Query::default()));
            }
        }
    }
}
