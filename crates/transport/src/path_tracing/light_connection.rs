//! The connection of a camera path's vertex with a point of a light.

use crate::sampling::task::{PathVertex, SampleState, VertexKind};
use crate::walk::segment::Segment;
use bilux_math::{Rgb, Vec3};
use bilux_scene::Tracer;

/// A connection from a vertex to a sample of a light, before it is known whether something lies between.
pub(super) struct LightConnection {
    pub(super) segment: Segment,
    /// The light that the vertex would scatter along the path, before it is weighted and divided by the density.
    pub(super) light: Rgb,
    /// The densities over solid angle of sampling the light, and of scattering towards it where the path could also find it so.
    pub(super) light_pdf: f32,
    pub(super) pdf: Option<f32>,
    /// The odds of the path so far: [`crate::walk::Walk::odds`].
    pub(super) odds: Rgb,
}

impl LightConnection {
    /// Light that it brings, and the number of panes on the way.
    #[inline]
    pub(super) fn trace(&self, tracer: &mut Tracer) -> (Rgb, u32) {
        let Some(passage) = self.segment.passage(tracer) else { return (Rgb::BLACK, 0) };
        let weight = self.pdf.map_or(1.0, |pdf| power_heuristic(self.light_pdf, pdf * passage.survival));
        (self.light * (weight / self.light_pdf) * passage.share(self.odds), passage.panes)
    }

    /// Records the connection, if it brings light to the sample.
    pub(super) fn note(&self, sample: &mut SampleState, depth: u32, light: Rgb) {
        if light.is_black() {
            return;
        }
        sample.note_vertex(depth, || {
            let [origin, direction] = [self.segment.ray.origin, self.segment.ray.direction].map(Vec3::from);
            let (kind, at) = match self.segment.through.distance {
                None => (VertexKind::DistantLight, direction),
                Some(_) => (VertexKind::LightSample, origin + direction),
            };
            (PathVertex { kind, at, light }, format!("is lit from {at}, which brings {:?}", light.to_array()))
        });
    }
}

/// MIS weight of a sample of density `a` against another technique of density `b`. [Veach 1997, eq. 9.17]
#[inline(always)]
pub(crate) fn power_heuristic(a: f32, b: f32) -> f32 {
    // The ratio is used so that squares of large densities do not overflow.
    if a > 0.0 { 1.0 / (1.0 + (b / a) * (b / a)) } else { 0.0 }
}
