//! Every structure gives the hits of `brute`, bit for bit, on input that has broken ray tracers.

use crate::support::{Truth, build_variant, meshes, rays, variants};
use bilux_accel::registry::Quality;
use bilux_accel::{ACCELERATORS, BuildOptions, Bvh, Bvh8, Query, RefitError, TriangleMesh};
use bilux_testing::effort;
use rayon::prelude::*;
use std::sync::Arc;

/// Rays per mesh; each is queried in about eight variants.
pub(crate) fn rays_per_mesh() -> usize {
    effort(80, 400)
}

#[test]
fn every_structure_gives_the_hits_of_brute() {
    for (seed, (mesh_name, mesh)) in meshes::all().into_iter().enumerate() {
        let mesh = Arc::new(mesh);
        let brute = build_variant("brute", &BuildOptions::default(), &mesh);
        let truth = Truth::new(brute.as_ref(), &rays::nasty(&mesh, rays_per_mesh(), seed as u64));
        assert!(
            mesh.is_empty() || truth.hits() > rays_per_mesh() / 4,
            "{mesh_name}: only {} hits",
            truth.hits()
        );
        variants().par_iter().for_each(|(name, accelerator, options)| {
            let found = truth.differences(build_variant(accelerator, options, &mesh).as_ref());
            assert!(found.is_empty(), "{name} on {mesh_name}: {} differ, first {:#?}", found.len(), found[0]);
        });
    }
}

#[test]
fn invalid_rays_hit_nothing_in_any_structure() {
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

#[test]
fn a_refitted_tree_gives_the_hits_of_the_moved_mesh() {
    for (seed, (name, mesh)) in meshes::all().into_iter().enumerate() {
        let bend = |p: [f32; 3]| [p[0] * 0.6 + p[1] * 0.3, p[1] * 0.7, p[2] * 0.8 - p[0] * 0.2];
        let moved = mesh.triangles().iter().map(|triangle| triangle.map(bend)).collect();
        let moved = Arc::new(TriangleMesh::from_corners(moved).expect("as many triangles as before"));
        let mut tree = Bvh::new(&mesh);
        assert!(tree.refit(&moved), "{name}");
        let brute = build_variant("brute", &BuildOptions::default(), &moved);
        let truth = Truth::new(brute.as_ref(), &rays::nasty(&moved, rays_per_mesh() / 4, seed as u64));
        let found = truth.differences(&tree);
        assert!(found.is_empty(), "{name}: {} differ, first {:#?}", found.len(), found[0]);
        if name == "not numbers" {
            let finite = vec![[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]; mesh.len()];
            assert!(!tree.refit(&TriangleMesh::from_corners(finite).expect("few triangles")));
        }
    }
}

#[test]
fn a_refitted_wide_tree_gives_the_hits_of_the_moved_mesh() {
    for (seed, (name, mesh)) in meshes::all().into_iter().enumerate() {
        let bend = |p: [f32; 3]| [p[0] * 0.6 + p[1] * 0.3, p[1] * 0.7, p[2] * 0.8 - p[0] * 0.2];
        let moved = |mesh: &TriangleMesh| {
            let moved = mesh.triangles().iter().map(|triangle| triangle.map(bend)).collect();
            TriangleMesh::from_corners(moved).expect("as many triangles as before")
        };
        let (once, twice) = (moved(&mesh), moved(&moved(&mesh)));
        for quality in [Quality::Fast, Quality::Balanced] {
            let mut tree =
                Bvh8::new(&mesh, &BuildOptions { quality, ..BuildOptions::default() }).expect("few");
            for mesh in [&once, &twice] {
                assert_eq!(tree.refit(mesh), Ok(()), "{name}");
                let brute = build_variant("brute", &BuildOptions::default(), &Arc::new(mesh.clone()));
                let truth = Truth::new(brute.as_ref(), &rays::nasty(mesh, rays_per_mesh() / 4, seed as u64));
                let found = truth.differences(&tree);
                assert!(found.is_empty(), "{name}: {} differ, first {:#?}", found.len(), found[0]);
            }
        }
    }
}

#[test]
fn a_wide_tree_is_not_refitted_to_another_mesh() {
    let one = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let mesh = |triangles: Vec<[[f32; 3]; 3]>| TriangleMesh::from_corners(triangles).expect("few triangles");
    let mut tree = Bvh8::new(&mesh(vec![one; 9]), &BuildOptions::default()).expect("few");
    let mut broken = vec![one; 9];
    broken[4][1][2] = f32::NAN;
    assert_eq!(tree.refit(&mesh(broken.clone())), Err(RefitError::OtherTriangles(4)));
    assert_eq!(tree.refit(&mesh(vec![one; 8])), Err(RefitError::OtherTriangles(8)));
    let mut tree = Bvh8::new(&mesh(broken.clone()), &BuildOptions::default()).expect("few");
    assert_eq!(tree.refit(&mesh(broken)), Ok(()));
    assert_eq!(tree.refit(&mesh(vec![one; 9])), Err(RefitError::OtherTriangles(4)));
    // Two crossing blades among many small triangles, where a cut is worthwhile.
    let blades = [
        [[0.0, 0.0, 0.0], [9.0, 9.0, 9.0], [9.0, 9.1, 9.0]],
        [[9.0, 0.0, 0.0], [0.0, 9.0, 9.0], [0.0, 9.1, 9.0]],
    ];
    let small = (0..200).map(|i| one.map(|p: [f32; 3]| p.map(|x| x * 0.1 + (i % 90) as f32 * 0.1)));
    let cut = mesh(small.chain(blades).collect());
    let options = BuildOptions { quality: Quality::Best, ..BuildOptions::default() };
    assert_eq!(Bvh8::new(&cut, &options).expect("few").refit(&cut), Err(RefitError::Pieces));
}
