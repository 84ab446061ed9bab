//! A lobe below layers that other lobes of a sum have too: what the layers let pass is given.

use super::{Coating, Lobe, TransportMode};
use bilux_math::{Rgb, Vec3};

impl Lobe {
    /// The layers above; none for a lobe that has no place for any.
    #[inline]
    pub(super) fn cover(&self) -> &Coating {
        match self {
            Lobe::MicrofacetReflection(lobe) => lobe.cover(),
            Lobe::CoatedDiffuse(lobe) => lobe.cover(),
            Lobe::CoatedDielectric(lobe) => lobe.cover(),
            _ => &Coating::NONE,
        }
    }

    /// [`Lobe::eval_and_pdf`] by what its cover lets pass along both directions.
    #[inline]
    pub(super) fn eval_and_pdf_below(
        &self,
        passed: [f32; 2],
        wo: Vec3,
        wi: Vec3,
        mode: TransportMode,
    ) -> (Rgb, f32) {
        match self {
            Lobe::MicrofacetReflection(lobe) => lobe.eval_and_pdf_below(passed, wo, wi),
            Lobe::CoatedDiffuse(lobe) => lobe.eval_and_pdf_below(passed, wo, wi),
            Lobe::CoatedDielectric(lobe) => lobe.eval_and_pdf_below(passed, wo, wi, mode),
            _ => self.eval_and_pdf(wo, wi, mode),
        }
    }
}
