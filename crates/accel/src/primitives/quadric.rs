//! Second-degree surfaces, clipped to a box.

use super::roots::{roots, without_origin};
use super::rounding::{outwards, wide};
use crate::ray::Ray;
use crate::triangle::Crossing;
use bilux_math::glam::DVec3;

/// The points `p` of a box with `p·S p + 2 l·p + k = 0`: ellipsoids, paraboloids, hyperboloids, saddles. The front is
/// where the left-hand side is positive. Hits have no `u` and `v` (both are 0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadric {
    /// The symmetric `S`: xx, yy, zz, then xy, xz, yz.
    pub square: [f32; 6],
    /// `l`.
    pub linear: [f32; 3],
    /// `k`.
    pub constant: f32,
    /// Minimum and maximum corner of the box; both finite.
    pub within: [[f32; 3]; 2],
}

impl Quadric {
    /// Box that clips the surface, rounded outwards.
    pub fn bounds(&self) -> [[f32; 3]; 2] {
        let [low, high] = self.within.map(wide);
        outwards(low, high)
    }

    fn times(&self, v: DVec3) -> DVec3 {
        let [xx, yy, zz, xy, xz, yz] = self.square.map(f64::from);
        DVec3::new(
            xx * v.x + xy * v.y + xz * v.z,
            xy * v.x + yy * v.y + yz * v.z,
            xz * v.x + yz * v.y + zz * v.z,
        )
    }

    pub(super) fn crossings(&self, ray: &Ray, leaves: bool, visit: &mut dyn FnMut(Crossing)) {
        let (origin, direction) = (wide(ray.origin), wide(ray.direction));
        let (linear, [low, high]) = (wide(self.linear), self.within.map(wide));
        // Half the gradient at the origin, and how it changes along the ray.
        let (gradient, change) = (self.times(origin) + linear, self.times(direction));
        let (a, h) = (direction.dot(change), direction.dot(gradient));
        let c = origin.dot(gradient) + linear.dot(origin) + f64::from(self.constant);
        let Some(found) = roots(a, h, c, h * h - a * c) else { return };
        for t in if leaves { without_origin(found) } else { found } {
            let p = origin + direction * t;
            if p.cmpge(low).all() && p.cmple(high).all() {
                let back = direction.dot(gradient + change * t) > 0.0;
                visit(Crossing { t: t as f32, u: 0.0, v: 0.0, back });
            }
        }
    }
}
