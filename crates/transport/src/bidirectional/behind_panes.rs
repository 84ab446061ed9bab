//! Subpaths that have passed nothing but panes since they left a light, or a vertex that samples lights: such a vertex samples the
//! light [through the panes](crate::through) too.
//!
//! No density has the odds of passing a pane, since all techniques pass it.

use crate::emission::Start;
use crate::interaction::Interaction;
use crate::task::Context;
use bilux_math::Vec3;
use bilux_scene::Surface;

/// Where a subpath comes from, straight through panes if there have been any.
#[derive(Clone, Copy)]
pub(super) struct BehindPanes {
    from: From,
    /// The probability of no event in the media on the way.
    survival: f32,
    panes: u32,
}

#[derive(Clone, Copy)]
enum From {
    Light(Start),
    /// A vertex of a camera subpath on a surface, and the density of the direction, over solid angle.
    Vertex(Vec3, f32),
}

impl BehindPanes {
    /// A subpath that leaves a light.
    pub(super) fn light(start: Start) -> BehindPanes {
        BehindPanes { from: From::Light(start), survival: 1.0, panes: 0 }
    }

    /// A camera subpath that leaves a vertex on a surface in a direction of this density over solid angle.
    pub(super) fn vertex(p: Vec3, pdf: f32) -> BehindPanes {
        BehindPanes { from: From::Vertex(p, pdf), survival: 1.0, panes: 0 }
    }

    /// The same at the end of its ray, where it comes with this probability.
    pub(super) fn arriving(self, survival: f32) -> BehindPanes {
        BehindPanes { survival: self.survival * survival, ..self }
    }

    /// The same beyond a pane.
    pub(super) fn beyond(self) -> BehindPanes {
        BehindPanes { panes: self.panes + 1, ..self }
    }

    /// How often a vertex on a surface, which this light subpath meets under this cosine, samples where it began, for each time that it comes
    /// there; 0 unless there are panes between.
    pub(super) fn sampled_from(&self, context: &Context, at: &Interaction, cos: f32) -> f32 {
        let (From::Light(start), 1..) = (&self.from, self.panes) else { return 0.0 };
        let light = &context.scene.lights()[start.light].light;
        let probability = context.lights.probability(start.light, at.lit_at());
        let pdf_direct = light.direct_pdf(&start.ray, at.p()) * probability;
        let distance2 = if light.is_infinite() { 1.0 } else { at.p().distance_squared(start.ray.p) };
        pdf_direct * distance2 / (start.ray.pdf_emission * self.survival * cos)
    }

    /// How often the vertex samples what this camera subpath sees of a light, at a surface or in this direction, for each time that it does; 0
    /// unless there are panes between.
    pub(super) fn samples(
        &self,
        context: &Context,
        (light, surface): (usize, Option<&Surface>),
        direction: Vec3,
    ) -> f32 {
        let (From::Vertex(p, pdf), 1..) = (self.from, self.panes) else { return 0.0 };
        let probability = context.lights.probability(light, surface.map(|_| p));
        let source = &context.scene.lights()[light].light;
        source.li_pdf_solid_angle(p, direction, surface) * probability / (pdf * self.survival)
    }
}
