//! Flat discs.

use super::rounding::{outwards, wide};
use crate::ray::Ray;
use crate::triangle::Crossing;
use bilux_math::glam::DVec3;

/// A flat disc; its front is the side that the normal points to. In a hit, `u` is the distance from the centre in
/// radii.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// The centre.
    pub centre: [f32; 3],
    /// Of any length but zero.
    pub normal: [f32; 3],
    /// A disc whose radius is not positive is never hit.
    pub radius: f32,
}

impl Disc {
    /// Minimum and maximum corner of the bounding box.
    pub fn bounds(&self) -> [[f32; 3]; 2] {
        let normal = wide(self.normal).normalize_or_zero();
        let reach = (DVec3::ONE - normal * normal).max(DVec3::ZERO).to_array().map(f64::sqrt);
        let (centre, reach) = (wide(self.centre), DVec3::from(reach) * f64::from(self.radius));
        outwards(centre - reach, centre + reach)
    }

    pub(super) fn crossings(&self, ray: &Ray, visit: &mut dyn FnMut(Crossing)) {
        let (origin, direction) = (wide(ray.origin), wide(ray.direction));
        let (centre, normal) = (wide(self.centre), wide(self.normal));
        let steepness = direction.dot(normal);
        let t = (centre - origin).dot(normal) / steepness;
        let from_centre = (origin + direction * t - centre).length() / f64::from(self.radius);
        if steepness != 0.0 && self.radius > 0.0 && from_centre <= 1.0 {
            visit(Crossing { t: t as f32, u: from_centre as f32, v: 0.0, back: steepness > 0.0 });
        }
    }
}
