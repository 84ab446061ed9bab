//! Capsules: thick lines with round ends.

use super::roots::{roots, without_origin};
use super::rounding::{outwards, wide};
use super::sphere::Sphere;
use crate::ray::Ray;
use crate::triangle::Crossing;
use bilux_math::glam::DVec3;

/// All points within a radius of a line segment: a cylinder between two hemispheres. The front is outside. In a hit,
/// `u` is the position along the segment from the first end to the second, 0..=1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// Ends of the segment. Where they coincide, the capsule is a sphere.
    pub ends: [[f32; 3]; 2],
    /// A capsule whose radius is not positive is never hit.
    pub radius: f32,
}

impl Capsule {
    /// Minimum and maximum corner of the bounding box.
    pub fn bounds(&self) -> [[f32; 3]; 2] {
        let ([a, b], radius) = (self.ends.map(wide), DVec3::splat(f64::from(self.radius)));
        outwards(a.min(b) - radius, a.max(b) + radius)
    }

    /// The distances at which the infinite line of a ray enters and leaves, in lengths of the ray's direction; `None`
    /// where it misses. The solid is convex, so there is one entry and one exit. [Ericson 2005, 5.3.7]
    pub fn chord(&self, ray: &Ray) -> Option<[f64; 2]> {
        let [a, b] = self.ends.map(wide);
        let (radius, height) = (f64::from(self.radius), (b - a).length());
        let of_end = |end: usize| Sphere { centre: self.ends[end], radius: self.radius }.chord(ray);
        if !(height > 0.0 && radius > 0.0) {
            return of_end(0);
        }
        let axis = (b - a) / height;
        let (from, direction) = (wide(ray.origin) - a, wide(ray.direction));
        let (y, dy) = (from.dot(axis), direction.dot(axis));
        let mut chord: Option<[f64; 2]> = None;
        let mut add = |t: f64| {
            let [enter, leave] = chord.unwrap_or([t; 2]);
            chord = Some([enter.min(t), leave.max(t)]);
        };
        let (across, drift) = (from - axis * y, direction - axis * dy);
        // From the distance between the axis and the line, which loses no digits. [Haines 2019, section 2]
        let (aa, h) = (drift.length_squared(), across.dot(drift));
        if aa > 0.0 {
            let beside = across - drift * (h / aa);
            let discriminant = aa * (radius * radius - beside.length_squared());
            let found = roots(aa, h, across.length_squared() - radius * radius, discriminant);
            let on_side = |t: &f64| (0.0..=height).contains(&(y + t * dy));
            found.into_iter().flatten().filter(on_side).for_each(&mut add);
        }
        let beyond = [|along: f64, _: f64| along <= 0.0, |along: f64, height: f64| along >= height];
        for (end, beyond) in beyond.into_iter().enumerate() {
            let found = of_end(end).into_iter().flatten();
            found.filter(|t| beyond(y + t * dy, height)).for_each(&mut add);
        }
        chord
    }

    /// The position along the segment of the point nearest to `p`, 0..=1.
    pub fn nearest(&self, p: [f64; 3]) -> f64 {
        let [a, b] = self.ends.map(wide);
        let along = (DVec3::from(p) - a).dot(b - a) / (b - a).length_squared();
        // NaN for a segment without a length.
        if along > 0.0 { along.min(1.0) } else { 0.0 }
    }

    pub(super) fn crossings(&self, ray: &Ray, leaves: bool, visit: &mut dyn FnMut(Crossing)) {
        let Some(chord) = self.chord(ray) else { return };
        let [enter, leave] = if leaves { without_origin(chord) } else { chord };
        let (origin, direction) = (wide(ray.origin), wide(ray.direction));
        for (t, back) in [(enter, false), (leave, true)] {
            let u = self.nearest((origin + direction * t).to_array()) as f32;
            visit(Crossing { t: t as f32, u, v: 0.0, back });
        }
    }
}
