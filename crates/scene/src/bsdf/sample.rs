//! The result of sampling a BSDF.

use bilux_math::{Rgb, Vec3};

/// A sampled direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// The direction.
    pub wi: Vec3,
    /// f·|cosθi| over the density (over the probability, for a delta lobe).
    pub weight: Rgb,
    /// Density over solid angle; for a delta lobe the probability of having chosen it.
    pub pdf_solid_angle: f32,
    /// True for a delta lobe, which `eval` and `pdf` leave out.
    pub is_delta: bool,
    /// True when `wi` is on the other side of the surface.
    pub transmits: bool,
    /// Index of the far side over that of the near side where light is refracted, else 1.
    pub eta: f32,
}

impl BsdfSample {
    /// A direction of a non-delta lobe, whose weight and density are not known yet; `None` if it is not on the side of
    /// `wo`, where the lobe's density is zero.
    #[inline]
    pub(super) fn direction(wo: Vec3, wi: Vec3) -> Option<BsdfSample> {
        let (weight, pdf_solid_angle) = (Rgb::BLACK, 0.0);
        let sample = BsdfSample { wi, weight, pdf_solid_angle, is_delta: false, transmits: false, eta: 1.0 };
        (wo.z * wi.z > 0.0).then_some(sample)
    }

    /// A sample of a non-delta lobe, on the side of `wo`; `None` where its density is zero.
    #[inline]
    pub(super) fn reflected(wi: Vec3, scattered: Rgb, pdf_solid_angle: f32) -> Option<BsdfSample> {
        let weight = scattered / pdf_solid_angle;
        let sample = BsdfSample { wi, weight, pdf_solid_angle, is_delta: false, transmits: false, eta: 1.0 };
        (pdf_solid_angle > 0.0).then_some(sample)
    }
}
