//! Light that arrives at a point from a light source.

use bilux_math::{Rgb, Vec3};

/// A sample of incident light at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// Unit direction towards the light.
    pub wi: Vec3,
    /// Incident radiance, without occlusion; for a delta light, irradiance on a surface that faces it.
    pub li: Rgb,
    /// Point on the light; `None` when infinitely far.
    pub point: Option<Vec3>,
    /// Normal of the light at that point, towards the receiver; zero if it has none.
    pub n_light: Vec3,
    /// Density of the direction over solid angle; 1 for a delta light.
    pub pdf_solid_angle: f32,
    /// The fraction of the distance before `point` within which a ray may already hit the light's own surface through
    /// rounding; 0 for a light without a surface.
    pub clearance: f32,
    /// The density over area with which light subpaths begin at `point`; `None` where it is that with which this receiver samples the point, or
    /// where [`crate::LightTracing::emission_pdf`] does not ask.
    pub pdf_start: Option<f32>,
}

impl LightSample {
    /// Cosine between the direction and the light's normal; 1 if there is no normal.
    pub fn cos(&self) -> f32 {
        cos_at(self.n_light, self.wi)
    }
}

/// Cosine between a direction and the normal of a light; 1 if it has none.
pub(crate) fn cos_at(n_light: Vec3, direction: Vec3) -> f32 {
    if n_light == Vec3::ZERO { 1.0 } else { n_light.dot(direction).abs() }
}
