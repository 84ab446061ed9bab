//! Spheres.

use super::roots::{roots, without_origin};
use super::rounding::{outwards, wide};
use crate::ray::Ray;
use crate::triangle::Crossing;
use bilux_math::glam::DVec3;

/// A whole sphere; the front is outside. Hits have no `u` and `v` (both are 0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// The centre.
    pub centre: [f32; 3],
    /// A sphere whose radius is not positive is never hit.
    pub radius: f32,
}

impl Sphere {
    /// Minimum and maximum corner of the bounding box.
    pub fn bounds(&self) -> [[f32; 3]; 2] {
        let (centre, radius) = (wide(self.centre), DVec3::splat(f64::from(self.radius)));
        outwards(centre - radius, centre + radius)
    }

    /// The distances at which the infinite line of a ray enters and leaves, in lengths of the ray's direction; `None`
    /// where it misses.
    ///
    /// Computed from the distance between the centre and the line, which loses no digits however far away the ray
    /// starts. [Haines 2019, section 2]
    pub fn chord(&self, ray: &Ray) -> Option<[f64; 2]> {
        let (direction, radius) = (wide(ray.direction), f64::from(self.radius));
        let from = wide(ray.origin) - wide(self.centre);
        let (a, h) = (direction.length_squared(), from.dot(direction));
        let beside = from - direction * (h / a);
        let c = from.length_squared() - radius * radius;
        let discriminant = a * (radius * radius - beside.length_squared());
        if radius > 0.0 { roots(a, h, c, discriminant) } else { None }
    }

    pub(super) fn crossings(&self, ray: &Ray, leaves: bool, visit: &mut dyn FnMut(Crossing)) {
        let Some([first, second]) = self.chord(ray) else { return };
        let [enter, leave] = if leaves { without_origin([first, second]) } else { [first, second] };
        visit(Crossing { t: enter as f32, u: 0.0, v: 0.0, back: false });
        visit(Crossing { t: leave as f32, u: 0.0, v: 0.0, back: true });
    }
}
