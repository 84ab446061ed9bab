//! Queries other than the closest hit: with a filter, with a mask, and for all hits along the ray.

use crate::support::{SIEVE, build_variant, meshes, rays, variants};
use bilux_accel::instancing::TopLevel;
use bilux_accel::ray::Filter;
use bilux_accel::triangle::PreparedRay;
use bilux_accel::{Accelerator, BuildOptions, Culling, Hit, Instance, Query, Ray, TriangleMesh, TwoLevel};
use bilux_math::glam::{DMat4, DVec3};
use bilux_math::{Motion, Transform};
use rayon::prelude::*;
use std::sync::Arc;

/// By the triangle test alone, and sorting.
fn all_hits_by_hand(mesh: &TriangleMesh, ray: &Ray, query: &Query) -> Vec<Hit> {
    let Some(prepared) = PreparedRay::new(ray) else { return Vec::new() };
    let mut hits: Vec<Hit> = (0..)
        .zip(mesh.triangles())
        .filter_map(|(primitive, triangle)| {
            let crossing = prepared.cross(triangle)?;
            let hit = Hit { t: crossing.t, u: crossing.u, v: crossing.v, primitive, instance: 0 };
            let counts = hit.t >= ray.t_min && hit.t <= ray.t_max && primitive != ray.exclude.index;
            let seen = !(crossing.back && query.culling == Culling::Back);
            (counts && seen && query.filter.is_none_or(|filter| filter(&hit))).then_some(hit)
        })
        .collect();
    hits.sort_by(|a, b| {
        a.t.partial_cmp(&b.t).expect("no hit is nowhere").then(a.primitive.cmp(&b.primitive))
    });
    hits
}

#[test]
fn all_hits_are_found_once_and_in_order() {
    let plain = Query::default();
    let queries = [plain, Query { culling: Culling::Back, ..plain }, Query { filter: Some(SIEVE), ..plain }];
    for (seed, (mesh_name, mesh)) in meshes::all().into_iter().enumerate() {
        let mesh = Arc::new(mesh);
        let rays = rays::nasty(&mesh, 100, 40 + seed as u64);
        variants().par_iter().for_each(|(name, accelerator, options)| {
            let tree = build_variant(accelerator, options, &mesh);
            for ray in &rays {
                for query in &queries {
                    let truth = all_hits_by_hand(&mesh, ray, query);
                    assert_eq!(tree.all_hits(ray, query), truth, "{name} on {mesh_name}: {ray:?}");
                    assert_eq!(tree.closest_hit(ray, query), truth.first().copied());
                }
            }
        });
    }
}

fn square(z: f32) -> Arc<dyn Accelerator> {
    let corners = vec![[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]];
    let mesh = TriangleMesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]).expect("indices of four corners");
    build_variant("auto", &BuildOptions::default(), &Arc::new(mesh))
}

fn behind(i: u32) -> Transform {
    let matrix = DMat4::from_translation(DVec3::new(0.0, 0.0, -f64::from(i)));
    Transform::from_matrix(matrix).expect("a shift can be undone")
}

/// Squares one behind the other, at z = 0, -1 and -2, each with its own mask bit.
fn stack(top: TopLevel) -> TwoLevel {
    let square = square(0.0);
    let instance =
        |i: u32| Instance { mask: 1 << i, ..Instance::new(square.clone(), Motion::still(behind(i))) };
    TwoLevel::new(&[0, 1, 2].map(instance), [0.0, 1.0], top)
}

#[test]
fn a_ray_hits_the_instances_that_share_a_mask_bit() {
    for top in [TopLevel::List, TopLevel::Bvh] {
        let stack = stack(top);
        for mask in 0..8u32 {
            let ray = Ray { mask, ..Ray::new([0.25, 0.5, 1.0], [0.0, 0.0, -1.0]) };
            let first = (0..3).find(|i| mask >> i & 1 == 1);
            let hit = stack.closest_hit(&ray, &Query::default());
            assert_eq!(hit.map(|hit| hit.instance), first, "{mask:03b}");
            assert_eq!(stack.any_hit(&ray, &Query::default()), first.is_some(), "{mask:03b}");
        }
    }
}

#[test]
fn a_filter_sees_the_instance_and_all_hits_go_through_all_of_them() {
    for top in [TopLevel::List, TopLevel::Bvh] {
        let stack = stack(top);
        let ray = Ray::new([0.25, 0.5, 1.0], [0.0, 0.0, -1.0]);
        let behind: Filter<'_> = &|hit| hit.instance > 0;
        let query = Query { filter: Some(behind), ..Query::default() };
        assert_eq!(stack.closest_hit(&ray, &query).map(|hit| (hit.instance, hit.t)), Some((1, 2.0)));
        let nothing: Filter<'_> = &|_| false;
        assert!(!stack.any_hit(&ray, &Query { filter: Some(nothing), ..query }));
        let all = stack.all_hits(&ray, &Query::default());
        assert_eq!(
            all.iter().map(|hit| (hit.instance, hit.t)).collect::<Vec<_>>(),
            [(0, 1.0), (1, 2.0), (2, 3.0)]
        );
    }
}
