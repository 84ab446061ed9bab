//! Subpaths that have passed nothing but panes since they left a light, or a vertex that samples lights: such a vertex samples the
//! light [through the panes](crate::walk::through) too.
//!
//! No density has the odds of passing a pane, since all techniques pass it.

use crate::light::emission::Start;
use crate::sampling::task::Context;
use bilux_math::Vec3;
use bilux_scene::Surface;

/// Origin of a subpath that has come straight from there, through panes if there have been any.
#[derive(Clone, Copy)]
pub(super) struct BehindPanes {
    /// On a light, or a vertex on a surface.
    p: Vec3,
    /// The density with which it left, over solid angle and on a light over area too, times the probability of no event in the media since.
    pdf: f32,
    panes: u32,
}

impl BehindPanes {
    /// A subpath that leaves a light.
    pub(super) fn light(start: &Start) -> BehindPanes {
        BehindPanes { p: start.ray.p, pdf: start.ray.pdf_emission, panes: 0 }
    }

    /// A camera subpath that leaves a vertex on a surface in a direction of this density.
    pub(super) fn vertex(p: Vec3, pdf: f32) -> BehindPanes {
        BehindPanes { p, pdf, panes: 0 }
    }

    /// Comes to the end of its ray with this probability.
    pub(super) fn arrive(&mut self, survival: f32) {
        self.pdf *= survival;
    }

    /// This origin, beyond one more pane.
    pub(super) fn beyond(self) -> BehindPanes {
        BehindPanes { panes: self.panes + 1, ..self }
    }

    /// Frequency with which a point on a surface samples the start of this light subpath, for each time that the subpath comes
    /// there, under this cosine; 0 unless there are panes between.
    pub(super) fn sampled_from(&self, start: &Start, context: &Context, p: Vec3, cos: f32) -> f32 {
        if self.panes == 0 {
            return 0.0;
        }
        let light = &context.scene.lights()[start.light].light;
        let probability = context.lights.probability(start.light, Some(p));
        let pdf_direct = light.direct_pdf(&start.ray, p) * probability;
        let distance2 = if light.is_infinite() { 1.0 } else { p.distance_squared(self.p) };
        pdf_direct * distance2 / (self.pdf * cos)
    }

    /// Frequency with which the vertex samples what this camera subpath sees of a light, at a surface or in this direction, for
    /// each time that the subpath sees it; 0 unless there are panes between.
    pub(super) fn samples(
        &self,
        context: &Context,
        (light, surface): (usize, Option<&Surface>),
        direction: Vec3,
    ) -> f32 {
        if self.panes == 0 {
            return 0.0;
        }
        let probability = context.lights.probability(light, surface.map(|_| self.p));
        let source = &context.scene.lights()[light].light;
        source.li_pdf_solid_angle(self.p, direction, surface) * probability / self.pdf
    }
}
