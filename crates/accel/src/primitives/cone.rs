//! Truncated cones and cylinders.

use super::roots::{roots, without_origin};
use super::rounding::{outwards, wide};
use crate::ray::Ray;
use crate::triangle::Crossing;
use bilux_math::glam::DVec3;

/// The lateral surface of a cone between two circles; with equal radii, a cylinder. It has no caps; the front is
/// outside. In a hit, `u` is the position from the first circle to the second, 0..=1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Centres of both circles. Where they coincide, the cone is never hit.
    pub ends: [[f32; 3]; 2],
    /// Their radii, not negative.
    pub radii: [f32; 2],
}

impl Cone {
    /// Minimum and maximum corner of the bounding box.
    pub fn bounds(&self) -> [[f32; 3]; 2] {
        let [a, b] = self.ends.map(wide);
        let axis = (b - a).normalize_or_zero();
        let reach = DVec3::from((DVec3::ONE - axis * axis).max(DVec3::ZERO).to_array().map(f64::sqrt));
        let [p, q] = self.radii.map(|radius| reach * f64::from(radius));
        outwards((a - p).min(b - q), (a + p).max(b + q))
    }

    pub(super) fn crossings(&self, ray: &Ray, leaves: bool, visit: &mut dyn FnMut(Crossing)) {
        let [a, b] = self.ends.map(wide);
        let [first, second] = self.radii.map(f64::from);
        let height = (b - a).length();
        if !(height > 0.0 && first >= 0.0 && second >= 0.0) {
            return;
        }
        let (axis, slope) = ((b - a) / height, (second - first) / height);
        let (from, direction) = (wide(ray.origin) - a, wide(ray.direction));
        // Along the axis, and across it: |across|² = (first + slope · along)².
        let (y, dy) = (from.dot(axis), direction.dot(axis));
        let (across, drift) = (from - axis * y, direction - axis * dy);
        let (radius, growth) = (first + slope * y, slope * dy);
        let aa = drift.length_squared() - growth * growth;
        let h = across.dot(drift) - radius * growth;
        let c = across.length_squared() - radius * radius;
        let Some(found) = roots(aa, h, c, h * h - aa * c) else { return };
        for t in if leaves { without_origin(found) } else { found } {
            let along = y + t * dy;
            // The other half of the double cone, behind the apex, does not belong to it.
            if (0.0..=height).contains(&along) && first + slope * along >= 0.0 {
                let at = across + drift * t;
                let back = at.dot(drift) - (radius + t * growth) * growth > 0.0;
                visit(Crossing { t: t as f32, u: (along / height) as f32, v: 0.0, back });
            }
        }
    }
}
