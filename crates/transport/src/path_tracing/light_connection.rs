//! The connection of a camera path's vertex with a point of a light.

use crate::segment::Segment;
use crate::task::{PathVertex, SampleState, VertexKind};
use bilux_math::{Rgb, Vec3};
use bilux_scene::Tracer;

/// A connection from a vertex to a sample of a light, before it is known whether something lies between.
pub(super) struct LightConnection {
    pub(super) segment: Segment,
    /// The light that the vertex would scatter along the path, without the factor.
    pub(super) light: Rgb,
    /// MIS weight over density.
    pub(super) factor: f32,
}

impl LightConnection {
    /// What it brings.
    #[inline]
    pub(super) fn trace(&self, tracer: &mut Tracer) -> Rgb {
        match self.segment.transmittance(tracer) {
            Some(passed) => self.light * self.factor * passed,
            None => Rgb::BLACK,
        }
    }

    /// Records the connection, if it brings light to the sample.
    pub(super) fn note(&self, sample: &mut SampleState, depth: u32, light: Rgb) {
        if light.is_black() {
            return;
        }
        sample.note_vertex(depth, || {
            let [origin, direction] = [self.segment.ray.origin, self.segment.ray.direction].map(Vec3::from);
            let (kind, at) = match self.segment.distance {
                None => (VertexKind::DistantLight, direction),
                Some(_) => (VertexKind::LightSample, origin + direction),
            };
            (PathVertex { kind, at, light }, format!("is lit from {at}, which brings {:?}", light.to_array()))
        });
    }
}
