//! Perfect reflection.

use super::{BsdfEntry, BsdfSample, Lobe, TransportMode};
use bilux_math::registry::Entry;
use bilux_math::{Rgb, Vec2, Vec3};

/// Row of [`super::BSDFS`].
pub(super) const ENTRY: BsdfEntry = BsdfEntry {
    entry: Entry { name: "mirror", summary: "a perfect mirror", source: "", parameters: &[] },
    reciprocal: true,
    lossless: true,
    cases: || {
        vec![
            ("white", Lobe::Mirror(Mirror { reflectance: Rgb::WHITE })),
            ("gold", Lobe::Mirror(Mirror { reflectance: Rgb::new(1.0, 0.78, 0.34) })),
        ]
    },
};

/// A perfect mirror, the same on both sides of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    /// Reflected fraction of the light, 0..=1.
    pub reflectance: Rgb,
}

impl Mirror {
    #[inline]
    pub(super) fn eval(&self, _wo: Vec3, _wi: Vec3, _mode: TransportMode) -> Rgb {
        Rgb::BLACK
    }

    #[inline]
    pub(super) fn pdf_solid_angle(&self, _wo: Vec3, _wi: Vec3) -> f32 {
        0.0
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
        _u: Vec2,
        _mode: TransportMode,
    ) -> Option<BsdfSample> {
        Some(BsdfSample {
            wi: Vec3::new(-wo.x, -wo.y, wo.z),
            weight: self.reflectance,
            pdf_solid_angle: 1.0,
            is_delta: true,
            transmits: false,
            eta: 1.0,
        })
    }

    #[inline]
    pub(super) fn strength(&self) -> f32 {
        self.reflectance.luminance()
    }
}
