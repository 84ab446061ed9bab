//! Capsules: thick lines with round ends.

use super::roots::{roots, without_origin};
use super::{Crossing, Sphere, outwards, wide};
use crate::ray::Ray;
use bilux_math::glam::DVec3;

/// All points within a radius of a line segment: a cylinder between two half spheres. Outside is the front. Of a hit,
/// `u` is the way from the first end to the second, 0..=1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// Ends of the segment. Where they are the same, this is a sphere.
    pub ends: [[f32; 3]; 2],
    /// Of a radius that is not positive nothing is met.
    pub radius: f32,
}

impl Capsule {
    /// Least and greatest corner of the box around it.
    pub fn bounds(&self) -> [[f32; 3]; 2] {
        let ([a, b], radius) = (self.ends.map(wide), DVec3::splat(f64::from(self.radius)));
        outwards(a.min(b) - radius, a.max(b) + radius)
    }

    /// Where the line of a ray enters and leaves, in lengths of its direction, whatever part of it the ray is; `None`
    /// where it passes. The solid is convex, so that there is one way in and one way out. [Ericson 2005, 5.3.7]
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
        // By the distance of the axis from the line, which keeps its digits. [Haines 2019, section 2]
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

    /// How far along the segment the point nearest to `p` lies, 0..=1.
    pub fn nearest(&self, p: [f64; 3]) -> f64 {
        let [a, b] = self.ends.map(wide);
        let along = (DVec3::from(p) - a).dot(b - a) / (b - a).length_squared();
        // Of a segment without a length it is no number.
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
