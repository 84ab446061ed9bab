//! Phong's highlight as a BRDF: a power of the cosine around the mirrored direction, normalised so that it never
//! reflects more light than it receives. [Lafortune 1994]

use super::{BsdfEntry, BsdfSample, Lobe, TransportMode};
use bilux_math::registry::Entry;
use bilux_math::transcendental::powf;
use bilux_math::{Frame, Rgb, Vec2, Vec3, warp};
use std::f32::consts::TAU;

/// Row of [`super::BSDFS`].
pub(super) const ENTRY: BsdfEntry = BsdfEntry {
    entry: Entry {
        name: "phong",
        summary: "Phong lobe: a cosine power around the mirror direction",
        source: "Lafortune 1994",
        parameters: &[],
    },
    reciprocal: true,
    lossless: false,
    cases: || {
        let lobe = |exponent| Lobe::Phong(PhongLobe { reflectance: Rgb::WHITE, exponent });
        vec![("wide", lobe(2.0)), ("satin", lobe(32.0)), ("sharp", lobe(500.0))]
    },
};

/// A normalised Phong highlight, the same on both sides of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhongLobe {
    /// The reflectance at normal incidence, 0..=1.
    pub reflectance: Rgb,
    /// Power of the cosine, 0 or more.
    pub exponent: f32,
}

impl PhongLobe {
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3, _mode: TransportMode) -> Rgb {
        if wo.z * wi.z <= 0.0 {
            return Rgb::BLACK;
        }
        let cos_alpha = Vec3::new(-wo.x, -wo.y, wo.z).dot(wi).max(0.0);
        self.reflectance * ((self.exponent + 2.0) / TAU * powf(cos_alpha, self.exponent) * wi.z.abs())
    }

    pub(super) fn pdf_solid_angle(&self, wo: Vec3, wi: Vec3) -> f32 {
        if wo.z * wi.z <= 0.0 {
            return 0.0;
        }
        warp::power_cosine_pdf_solid_angle(Vec3::new(-wo.x, -wo.y, wo.z).dot(wi), self.exponent)
    }

    pub(super) fn eval_and_pdf(&self, wo: Vec3, wi: Vec3, _mode: TransportMode) -> (Rgb, f32) {
        if wo.z * wi.z <= 0.0 {
            return (Rgb::BLACK, 0.0);
        }
        let cos_alpha = Vec3::new(-wo.x, -wo.y, wo.z).dot(wi);
        let power = powf(cos_alpha.max(0.0), self.exponent);
        let scattered = self.reflectance * ((self.exponent + 2.0) / TAU * power * wi.z.abs());
        (scattered, if cos_alpha <= 0.0 { 0.0 } else { (self.exponent + 1.0) / TAU * power })
    }

    pub(super) fn sample(
        &self,
        wo: Vec3,
        _u_choice: f32,
        u: Vec2,
        mode: TransportMode,
    ) -> Option<BsdfSample> {
        let mirrored = Frame::from_normal(Vec3::new(-wo.x, -wo.y, wo.z));
        let wi = mirrored.to_world(warp::sample_power_cosine(u, self.exponent)).normalize();
        let pdf_solid_angle = self.pdf_solid_angle(wo, wi);
        // Directions below the surface carry nothing: their part of the density is lost, as it should be.
        BsdfSample::reflected(wi, self.eval(wo, wi, mode), pdf_solid_angle)
    }

    pub(super) fn strength(&self) -> f32 {
        self.reflectance.luminance()
    }
}
