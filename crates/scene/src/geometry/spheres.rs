//! Analytic spheres, round at every size, without triangles. All spheres of a scene share one tree, an instance like
//! any other, whatever structure holds the triangles.

use crate::surface::{Surface, gamma};
use bilux_accel::instancing::Instance;
use bilux_accel::primitives::{PrimitiveTree, Shape, Sphere};
use bilux_accel::{Accelerator, Hit, Primitive, Query, Ray};
use bilux_math::glam::DVec3;
use bilux_math::motion::Motion;
use bilux_math::transcendental::{acos, atan2};
use bilux_math::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, TAU};
use std::sync::Arc;

/// A sphere in world space; it does not move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedSphere {
    /// Centre of the sphere.
    pub centre: Vec3,
    /// Positive.
    pub radius: f32,
    /// Index of its material.
    pub material: u32,
}

impl PlacedSphere {
    fn shape(&self) -> Sphere {
        Sphere { centre: self.centre.to_array(), radius: self.radius }
    }

    /// Distances at which the infinite line of a ray enters and leaves, in lengths of the ray's direction; `None` where it misses.
    pub(crate) fn chord(&self, ray: &Ray) -> Option<[f64; 2]> {
        self.shape().chord(ray)
    }

    /// The point with this unit normal, and the bound on its error, per axis.
    pub(crate) fn point(&self, n: DVec3) -> (Vec3, Vec3) {
        let p = (self.centre.as_dvec3() + n * f64::from(self.radius)).as_vec3();
        (p, (p.abs() + (self.centre.abs() + self.radius) * WIDE) * gamma(1))
    }
}

/// The tree of all spheres.
pub(crate) type SphereTree = Arc<PrimitiveTree<Vec<Shape>>>;

/// All spheres of a scene.
pub(crate) struct Spheres {
    all: Vec<PlacedSphere>,
    tree: SphereTree,
    /// The object index of the first sphere.
    first_object: u32,
    /// The instance of the spheres; `u32::MAX` if there are none.
    instance: u32,
}

/// A bound on the error of f64 relative to that of f32.
const WIDE: f32 = 1.0 / (1u32 << 26) as f32;

impl Spheres {
    /// Spheres with their tree, if it is known already.
    pub(crate) fn new(
        all: Vec<PlacedSphere>,
        tree: Option<SphereTree>,
        first_object: u32,
        instance: u32,
    ) -> Spheres {
        let instance = if all.is_empty() { u32::MAX } else { instance };
        let shapes = || all.iter().map(|sphere| Shape::Sphere(sphere.shape())).collect();
        let tree = tree.unwrap_or_else(|| Arc::new(PrimitiveTree::new(shapes())));
        Spheres { all, tree, first_object, instance }
    }

    /// The tree, to be kept.
    pub(crate) fn shared_tree(&self) -> SphereTree {
        self.tree.clone()
    }

    /// The tree of all spheres, in world space.
    pub(crate) fn tree(&self) -> Option<Instance> {
        (!self.all.is_empty()).then(|| Instance::new(self.tree.clone(), Motion::REST))
    }

    /// The ray for the only tree of triangles: one that leaves a sphere excludes no triangle.
    pub(crate) fn aside(ray: &Ray) -> Ray {
        Ray { exclude: if ray.exclude.instance == 0 { ray.exclude } else { Primitive::NONE }, ..*ray }
    }

    /// The ray for the spheres.
    fn own(&self, ray: &Ray) -> Ray {
        let exclude = match ray.exclude {
            Primitive { instance, index } if instance == self.instance => Primitive { instance: 0, index },
            _ => Primitive::NONE,
        };
        Ray { exclude, ..*ray }
    }

    /// The closest sphere that a ray hits, up to `t_max`.
    pub(crate) fn closest_hit(&self, ray: &Ray, t_max: f32, query: &Query) -> Option<Hit> {
        let keeps =
            |hit: &Hit| query.filter.is_none_or(|filter| filter(&Hit { instance: self.instance, ..*hit }));
        let query = Query { filter: query.filter.and(Some(&keeps)), ..*query };
        let hit = self.tree.closest_hit(&Ray { t_max, ..self.own(ray) }, &query)?;
        Some(Hit { instance: self.instance, ..hit })
    }

    /// Whether the ray hits any sphere.
    pub(crate) fn any_hit(&self, ray: &Ray, query: &Query) -> bool {
        let keeps =
            |hit: &Hit| query.filter.is_none_or(|filter| filter(&Hit { instance: self.instance, ..*hit }));
        self.tree.any_hit(&self.own(ray), &Query { filter: query.filter.and(Some(&keeps)), ..*query })
    }

    pub(crate) fn all(&self) -> &[PlacedSphere] {
        &self.all
    }

    #[inline]
    pub(crate) fn instance(&self) -> u32 {
        self.instance
    }

    pub(crate) fn primitive(&self, sphere: u32) -> Primitive {
        Primitive { instance: self.instance, index: sphere }
    }

    pub(crate) fn object(&self, sphere: u32) -> u32 {
        self.first_object + sphere
    }

    pub(crate) fn material(&self, object: u32) -> u32 {
        self.all[(object - self.first_object) as usize].material
    }

    /// All that shading needs about a hit.
    ///
    /// The point lies on the sphere to the last bit of an f32, however far away the ray started: its distance along the
    /// ray is recomputed in f64.
    pub(crate) fn surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        let sphere = &self.all[hit.primitive as usize];
        let wide = |v: [f32; 3]| DVec3::from(v.map(f64::from));
        let [enter, leave] = sphere.chord(ray).unwrap_or([f64::from(hit.t); 2]);
        // If two roots round to the same number, take the nearer one, unless the ray starts past it.
        let enters = hit.t == enter as f32 && ray.exclude != hit.primitive();
        let t = if enters { enter } else { leave };
        let from = wide(ray.origin) - sphere.centre.as_dvec3();
        let n = (from + wide(ray.direction) * t).try_normalize().unwrap_or(DVec3::Y);
        let (p, p_error) = sphere.point(n);
        let n = n.as_vec3();
        let uv = Vec2::new(0.5 + atan2(n.x, n.z) / TAU, acos(n.y.clamp(-1.0, 1.0)) * FRAC_1_PI);
        Surface {
            t: hit.t,
            p,
            p_error,
            n_geom: n,
            n_shade: n,
            n_smooth: n,
            tangent: Vec3::ZERO,
            handedness: 1.0,
            uv,
            uv2: uv,
            uv_width: [Vec2::ZERO; 2],
            vertex_kd: None,
            vertex_ks: None,
            primitive: hit.primitive(),
            object: self.object(hit.primitive),
            time: ray.time,
        }
    }
}
