//! Diffuse reflection: f = albedo / π on the side of `wo`.

use super::{BsdfEntry, BsdfSample, Lobe, TransportMode};
use bilux_math::registry::Entry;
use bilux_math::{Rgb, Vec2, Vec3, warp};
use std::f32::consts::FRAC_1_PI;

/// Row of [`super::BSDFS`].
pub(super) const ENTRY: BsdfEntry = BsdfEntry {
    entry: Entry {
        name: "lambert",
        summary: "Lambertian diffuse reflection",
        source: "Lambert 1760",
        parameters: &[],
    },
    reciprocal: true,
    lossless: true,
    cases: || {
        vec![
            ("white", Lobe::Lambert(Lambert { albedo: Rgb::WHITE })),
            ("orange", Lobe::Lambert(Lambert { albedo: Rgb::new(0.8, 0.4, 0.1) })),
        ]
    },
};

/// Diffuse reflection, the same on both sides of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lambert {
    /// Reflected fraction of the light, 0..=1.
    pub albedo: Rgb,
}

impl Lambert {
    #[inline]
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3, _mode: TransportMode) -> Rgb {
        if wo.z * wi.z > 0.0 { self.albedo * (FRAC_1_PI * wi.z.abs()) } else { Rgb::BLACK }
    }

    #[inline]
    pub(super) fn pdf_solid_angle(&self, wo: Vec3, wi: Vec3) -> f32 {
        if wo.z * wi.z > 0.0 { warp::cosine_hemisphere_pdf_solid_angle(wi.z.abs()) } else { 0.0 }
    }

    #[inline]
    pub(super) fn eval_and_pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> (Rgb, f32) {
        (self.eval(wo, wi, mode), self.pdf_solid_angle(wo, wi))
    }

    #[inline]
    pub(super) fn sample(
        &self,
        wo: Vec3,
        _u_choice: f32,
        u: Vec2,
        mode: TransportMode,
    ) -> Option<BsdfSample> {
        let mut wi = warp::sample_cosine_hemisphere(u);
        wi.z *= 1f32.copysign(wo.z);
        let pdf_solid_angle = self.pdf_solid_angle(wo, wi);
        BsdfSample::reflected(wi, self.eval(wo, wi, mode), pdf_solid_angle)
    }

    #[inline]
    pub(super) fn strength(&self) -> f32 {
        self.albedo.luminance()
    }
}
