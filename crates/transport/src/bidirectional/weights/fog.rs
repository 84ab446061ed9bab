//! The fog of these tests.

use bilux_math::{Aabb, Vec3};

/// Fog that is the same wherever it is.
#[derive(Clone, Copy)]
pub(super) struct Fog {
    /// The extinction coefficient, in the sample's channel.
    pub(super) extinction: f32,
    /// Regions of the fog; none if it fills the scene.
    pub(super) parts: &'static [Aabb],
}

impl Fog {
    /// Length of the line between two points that is in the fog, in metres.
    pub(super) fn between(&self, a: Vec3, b: Vec3) -> f64 {
        let [a, b] = [a, b].map(Vec3::as_dvec3);
        let length = a.distance(b);
        if self.parts.is_empty() {
            return length;
        }
        let within = |part: &Aabb| {
            let [low, high] = [part.min, part.max].map(|corner| (corner.as_dvec3() - a) / (b - a));
            let (begin, end) = (low.min(high).max_element().max(0.0), low.max(high).min_element().min(1.0));
            (end - begin).max(0.0)
        };
        self.parts.iter().map(within).sum::<f64>() * length
    }
}
