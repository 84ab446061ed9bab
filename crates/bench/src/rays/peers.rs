//! Competitors that are crates, each called as in its own examples. Behind the feature `peers`.

use super::batch::{Answers, Batch};
use super::engine::{Engine, HIT_WITHOUT_LOCATION, Mode, Named, loop_over};
use super::files::indexed;
use bilux::accel::{Hit, Ray, TriangleMesh};
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::RayHit;
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;
use parry3d::math::Vector;
use parry3d::shape::{CompositeShapeRef, TriMesh};
use rayon::ThreadPool;
use std::time::{Duration, Instant};

/// Builds all of them.
pub(super) fn build(mesh: &TriangleMesh, alone: &ThreadPool) -> Vec<Named> {
    let named = |name: &str, engine: Box<dyn Engine>| Named { name: name.to_owned(), ours: false, engine };
    let mut all = vec![
        named("obvhs-cwbvh", Box::new(alone.install(|| Obvhs::new(mesh, cwbvh)))),
        named("obvhs-bvh2", Box::new(alone.install(|| Obvhs::new(mesh, bvh2)))),
    ];
    all.extend(alone.install(|| Parry::new(mesh)).map(|parry| named("parry3d", Box::new(parry))));
    all
}

fn cwbvh(triangles: &[Triangle]) -> CwBvh {
    build_cwbvh_from_tris(triangles, BvhBuildParams::very_slow_build(), &mut Duration::default())
}

fn bvh2(triangles: &[Triangle]) -> Bvh2 {
    build_bvh2_from_tris(triangles, BvhBuildParams::very_slow_build(), &mut Duration::default())
}

/// Queries that obvhs's two trees have in common.
trait ObvhsTree {
    fn closest(&self, ray: obvhs::ray::Ray, triangles: &[RtTriangle]) -> RayHit;
    fn any(&self, ray: obvhs::ray::Ray, triangles: &[RtTriangle]) -> bool;
    fn primitives(&self) -> &[u32];
    fn node_bytes(&self) -> usize;
}

macro_rules! tree {
    ($tree:ty) => {
        impl ObvhsTree for $tree {
            #[inline(always)]
            fn closest(&self, ray: obvhs::ray::Ray, triangles: &[RtTriangle]) -> RayHit {
                let mut hit = RayHit::none();
                self.ray_traverse(ray, &mut hit, |ray, id| triangles[id].intersect(ray));
                hit
            }

            #[inline(always)]
            fn any(&self, ray: obvhs::ray::Ray, triangles: &[RtTriangle]) -> bool {
                !self.ray_traverse_miss(ray, |ray, id| triangles[id].intersect(ray))
            }

            fn primitives(&self) -> &[u32] {
                &self.primitive_indices
            }

            fn node_bytes(&self) -> usize {
                size_of_val(self.nodes.as_slice()) + size_of_val(self.primitive_indices.as_slice())
            }
        }
    };
}

tree!(CwBvh);
tree!(Bvh2);

struct Obvhs<T> {
    tree: T,
    /// In the order of the leaves.
    triangles: Vec<RtTriangle>,
    build_seconds: f64,
}

impl<T: ObvhsTree> Obvhs<T> {
    fn new(mesh: &TriangleMesh, build: fn(&[Triangle]) -> T) -> Obvhs<T> {
        let triangle = |&[a, b, c]: &[[f32; 3]; 3]| Triangle { v0: a.into(), v1: b.into(), v2: c.into() };
        let input: Vec<Triangle> = mesh.triangles().iter().map(triangle).collect();
        let begun = Instant::now();
        let tree = build(&input);
        let in_order = |&id: &u32| {
            let Triangle { v0, v1, v2 } = input[id as usize];
            RtTriangle::new(v0, v1, v2)
        };
        let triangles = tree.primitives().iter().map(in_order).collect();
        Obvhs { tree, triangles, build_seconds: begun.elapsed().as_secs_f64() }
    }
}

impl<T: ObvhsTree> Engine for Obvhs<T> {
    fn mode(&self) -> Mode {
        Mode::Single
    }

    fn build_seconds(&self) -> f64 {
        self.build_seconds
    }

    fn bytes(&self) -> usize {
        self.tree.node_bytes() + size_of_val(self.triangles.as_slice())
    }

    fn trace(&self, batch: &Batch, answers: Option<&mut Answers>) -> f64 {
        let own =
            |ray: &Ray| obvhs::ray::Ray::new(ray.origin.into(), ray.direction.into(), ray.t_min, ray.t_max);
        if batch.any {
            let ask = |ray: &Ray| self.tree.any(own(ray), &self.triangles);
            return loop_over(batch, answers, ask, |hit: &bool| hit.then_some(HIT_WITHOUT_LOCATION));
        }
        let closest = |ray: &Ray| {
            let hit = self.tree.closest(own(ray), &self.triangles);
            (hit.t, hit.primitive_id)
        };
        loop_over(batch, answers, closest, |&(t, id)| {
            let primitive = *self.tree.primitives().get(id as usize)?;
            t.is_finite().then_some(Hit { t, primitive, ..HIT_WITHOUT_LOCATION })
        })
    }
}

struct Parry {
    mesh: TriMesh,
    build_seconds: f64,
}

impl Parry {
    fn new(mesh: &TriangleMesh) -> Option<Parry> {
        let (positions, indices) = indexed(mesh);
        let positions = positions.into_iter().map(|[x, y, z]| Vector::new(x, y, z)).collect();
        let begun = Instant::now();
        let mesh = TriMesh::new(positions, indices).ok()?;
        Some(Parry { mesh, build_seconds: begun.elapsed().as_secs_f64() })
    }

    /// The closest hit. Parry's rays start at t = 0, as all of ours do here.
    #[inline(always)]
    fn closest(&self, ray: &Ray) -> Option<(u32, f32)> {
        let ([a, b, c], [x, y, z]) = (ray.origin, ray.direction);
        let own = parry3d::query::Ray::new(Vector::new(a, b, c), Vector::new(x, y, z));
        CompositeShapeRef(&self.mesh).cast_local_ray(&own, ray.t_max, false)
    }
}

impl Engine for Parry {
    fn mode(&self) -> Mode {
        Mode::Single
    }

    fn build_seconds(&self) -> f64 {
        self.build_seconds
    }

    fn bytes(&self) -> usize {
        self.mesh.total_memory_size()
    }

    fn trace(&self, batch: &Batch, answers: Option<&mut Answers>) -> f64 {
        loop_over(
            batch,
            answers,
            |ray| self.closest(ray),
            |hit| hit.map(|(primitive, t)| Hit { t, primitive, ..HIT_WITHOUT_LOCATION }),
        )
    }
}
