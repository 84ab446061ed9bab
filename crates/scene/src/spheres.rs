//! Spheres as they are, round at every size: none of their triangles is ever seen. All of a scene stand in one tree, an
//! instance like any other, whatever structure holds the triangles.

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

/// A sphere where it is; it does not move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedSphere {
    /// Its middle.
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

    /// The point with this unit normal, and the bound on its error, per axis.
    pub(crate) fn point(&self, n: DVec3) -> (Vec3, Vec3) {
        let p = (self.centre.as_dvec3() + n * f64::from(self.radius)).as_vec3();
        (p, (p.abs() + (self.centre.abs() + self.radius) * WIDE) * gamma(1))
    }
}

/// All of a scene.
pub(crate) struct Spheres {
    all: Vec<PlacedSphere>,
    tree: Arc<PrimitiveTree<Vec<Shape>>>,
    /// The object that the first of them is.
    first_object: u32,
    /// The instance that they are; `u32::MAX` where there are none.
    instance: u32,
}

/// How far f64 is off, beside f32.
const WIDE: f32 = 1.0 / (1u32 << 26) as f32;

impl Spheres {
    pub(crate) fn new(all: Vec<PlacedSphere>, first_object: u32, instance: u32) -> Spheres {
        let instance = if all.is_empty() { u32::MAX } else { instance };
        let shapes = all.iter().map(|sphere| Shape::Sphere(sphere.shape())).collect();
        Spheres { all, tree: Arc::new(PrimitiveTree::new(shapes)), first_object, instance }
    }

    /// The tree of all of them, in the world.
    pub(crate) fn tree(&self) -> Option<Instance> {
        (!self.all.is_empty()).then(|| Instance::new(self.tree.clone(), Motion::REST))
    }

    /// A ray as the only tree of triangles is to be asked beside spheres: one that leaves a sphere leaves none of them.
    pub(crate) fn aside(ray: &Ray) -> Ray {
        Ray { exclude: if ray.exclude.instance == 0 { ray.exclude } else { Primitive::NONE }, ..*ray }
    }

    /// The same for the spheres.
    fn own(&self, ray: &Ray) -> Ray {
        let exclude = match ray.exclude {
            Primitive { instance, index } if instance == self.instance => Primitive { instance: 0, index },
            _ => Primitive::NONE,
        };
        Ray { exclude, ..*ray }
    }

    /// Which of them a ray meets first, up to `t_max`.
    pub(crate) fn closest_hit(&self, ray: &Ray, t_max: f32, query: &Query) -> Option<Hit> {
        let keeps =
            |hit: &Hit| query.filter.is_none_or(|filter| filter(&Hit { instance: self.instance, ..*hit }));
        let query = Query { filter: query.filter.and(Some(&keeps)), ..*query };
        let hit = self.tree.closest_hit(&Ray { t_max, ..self.own(ray) }, &query)?;
        Some(Hit { instance: self.instance, ..hit })
    }

    /// Whether it meets any.
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

    /// All that shading needs to know of a hit. The point lies on the sphere to the last bit of an f32, however far away
    /// the ray began: its distance along the ray is found anew, in f64.
    pub(crate) fn surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        let sphere = &self.all[hit.primitive as usize];
        let wide = |v: [f32; 3]| DVec3::from(v.map(f64::from));
        let [enter, leave] = sphere.shape().chord(ray).unwrap_or([f64::from(hit.t); 2]);
        // Of two that are rounded to one it is the nearer, unless the ray is past that.
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
