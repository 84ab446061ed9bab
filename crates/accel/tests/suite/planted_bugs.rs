//! Structures with a deliberate mistake, each of which the harness must detect.

use crate::one_answer::rays_per_mesh;
use crate::support::{Truth, build_variant, closed, meshes, rays};
use bilux_accel::accelerator::{Traverse, TreeShape};
use bilux_accel::counters::Count;
use bilux_accel::slab::SlabRay;
use bilux_accel::triangle::{Crossing, Nearest, PreparedRay};
use bilux_accel::{BuildOptions, Hit, Query, Ray, TriangleMesh};
use bilux_math::Aabb;
use std::sync::Arc;

/// Boxes around four triangles each, one after the other, with optional mistakes.
struct Boxes {
    mesh: Arc<TriangleMesh>,
    /// Factor on the pad; 1 is correct.
    pad: f32,
    /// Fraction of each box's size that is cut off on every side; 0 is correct.
    shrink: f32,
    /// False is correct.
    prunes_ties: bool,
}

impl Traverse for Boxes {
    fn closest<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> Option<Hit> {
        count.ray();
        let prepared = PreparedRay::new(ray)?;
        let pad = prepared.pad(&self.mesh.bounds()) * self.pad;
        let slabs = SlabRay::new(ray.origin, ray.direction, ray.t_min, pad);
        let mut nearest = Nearest::new(ray);
        for first in (0..self.mesh.len()).step_by(4) {
            let group = first..(first + 4).min(self.mesh.len());
            let bounds =
                group.clone().fold(Aabb::EMPTY, |all, i| all.union(self.mesh.triangle_bounds(i as u32)));
            let extent = bounds.extent();
            let bounds =
                Aabb { min: bounds.min + extent * self.shrink, max: bounds.max - extent * self.shrink };
            let [enter, leave] = slabs.span_of(&bounds);
            let limit = slabs.limit(nearest.t);
            let late = if self.prunes_ties { enter * 1.000_01 >= limit } else { enter > limit };
            if query.early_out && late || enter > leave || leave < slabs.nearest {
                continue;
            }
            for i in group {
                nearest.test(&prepared, query, &self.mesh.triangles()[i], i as u32);
            }
        }
        nearest.hit()
    }
    fn any<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> bool {
        self.closest(ray, query, count).is_some()
    }
    fn bounds(&self) -> Aabb {
        self.mesh.bounds()
    }
    fn memory_bytes(&self) -> usize {
        0
    }
    fn shape(&self) -> TreeShape {
        TreeShape::default()
    }
}

fn differences(make: impl Fn(Arc<TriangleMesh>) -> Boxes) -> usize {
    let differing = |(seed, (_, mesh)): (usize, (_, TriangleMesh))| {
        let mesh = Arc::new(mesh);
        let brute = build_variant("brute", &BuildOptions::default(), &mesh);
        let truth = Truth::new(brute.as_ref(), &rays::nasty(&mesh, rays_per_mesh(), seed as u64));
        truth.differences(&make(mesh)).len()
    };
    meshes::all().into_iter().enumerate().map(differing).sum()
}

#[test]
fn boxes_without_a_pad_are_detected() {
    let with = |pad| differences(|mesh| Boxes { mesh, pad, shrink: 0.0, prunes_ties: false });
    assert_eq!(with(1.0), 0);
    assert!(with(0.0) > 0, "boxes without a pad went unnoticed");
}

#[test]
fn slightly_too_small_boxes_are_detected() {
    assert!(differences(|mesh| Boxes { mesh, pad: 1.0, shrink: 1e-3, prunes_ties: false }) > 0);
}

#[test]
fn pruning_ties_is_detected() {
    assert!(differences(|mesh| Boxes { mesh, pad: 1.0, shrink: 0.0, prunes_ties: true }) > 0);
}

/// A loop over all triangles with its own triangle test.
struct Loop<F>(Arc<TriangleMesh>, F);

impl<F: Fn(&mut Nearest, &PreparedRay, &Query, &[[f32; 3]; 3], u32) + Send + Sync> Traverse for Loop<F> {
    fn closest<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> Option<Hit> {
        count.ray();
        let prepared = PreparedRay::new(ray)?;
        let mut nearest = Nearest::new(ray);
        for (index, triangle) in self.0.triangles().iter().enumerate() {
            (self.1)(&mut nearest, &prepared, query, triangle, index as u32);
        }
        nearest.hit()
    }
    fn any<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> bool {
        self.closest(ray, query, count).is_some()
    }
    fn bounds(&self) -> Aabb {
        self.0.bounds()
    }
    fn memory_bytes(&self) -> usize {
        0
    }
    fn shape(&self) -> TreeShape {
        TreeShape::default()
    }
}

#[test]
fn ties_to_the_highest_index_are_detected() {
    let highest = |nearest: &mut Nearest, ray: &PreparedRay, query: &Query, triangle: &_, index: u32| {
        let mut alone = *nearest;
        if let Some(hit) = alone.hit() {
            alone = Nearest::new(&Ray { t_max: hit.t, ..ray.ray });
        }
        alone.test(ray, query, triangle, index);
        if alone.hit().is_some() {
            *nearest = alone;
        }
    };
    let (_, mesh) = meshes::all().into_iter().find(|(name, _)| *name == "duplicated").expect("it is there");
    let mesh = Arc::new(mesh);
    let brute = build_variant("brute", &BuildOptions::default(), &mesh);
    let truth = Truth::new(brute.as_ref(), &rays::nasty(&mesh, 300, 1));
    assert!(!truth.differences(&Loop(mesh, highest)).is_empty());
}

/// The edge functions as a compiler would fuse them: one product rounded, the other not.
fn crossed_by_fused_edges(ray: &Ray, triangle: &[[f32; 3]; 3]) -> Option<Crossing> {
    let largest = (0..3).fold(0, |k, i| if ray.direction[i].abs() > ray.direction[k].abs() { i } else { k });
    let (kx, ky, kz) = ((largest + 1) % 3, (largest + 2) % 3, largest);
    let d = ray.direction;
    let sheared = triangle.map(|p| {
        let z = p[kz] - ray.origin[kz];
        let lean = |k: usize| (p[k] - ray.origin[k]) - d[k] / d[kz] * z;
        [lean(kx), lean(ky), z]
    });
    let fused = |a: f32, b: f32, c: f32, d: f32| (f64::from(a) * f64::from(b) - f64::from(c * d)) as f32;
    let edge = |p: [f32; 3], q: [f32; 3]| fused(p[0], q[1], p[1], q[0]);
    let [a, b, c] = sheared;
    let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
    if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
        return None;
    }
    let det = u + v + w;
    let t = (u * a[2] + v * b[2] + w * c[2]) / (det * d[kz]);
    (det != 0.0).then_some(Crossing { t, u: v / det, v: w / det, back: false })
}

/// The number of rays from inside a closed mesh that hit nothing by this test.
fn leaks(test: impl Fn(&Ray, &[[f32; 3]; 3]) -> Option<Crossing>) -> usize {
    let closed = closed::all();
    let of = |closed: &closed::Closed| {
        let mesh = closed.mesh();
        let missed = |index: &u64| {
            let ray = closed::ray(closed, 2, *index);
            let hit =
                |triangle: &[[f32; 3]; 3]| test(&ray, triangle).is_some_and(|crossing| crossing.t >= 0.0);
            !mesh.triangles().iter().any(hit)
        };
        (0..2000).filter(missed).count()
    };
    closed.iter().take(4).map(of).sum()
}

#[test]
fn fused_edge_functions_leak_and_the_shared_test_does_not() {
    let shared = |ray: &Ray, triangle: &[[f32; 3]; 3]| PreparedRay::new(ray)?.cross(triangle);
    assert_eq!(leaks(shared), 0);
    assert!(leaks(crossed_by_fused_edges) > 0, "fused edge functions went unnoticed");
}
