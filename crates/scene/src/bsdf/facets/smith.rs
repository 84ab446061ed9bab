//! Smith's masking and shadowing: how many of the microfacets of a rough surface are visible along a direction. It follows from
//! their distribution alone. [Heitz 2014]
//!
//! Directions are local, with the normal as z, and above the surface: callers mirror directions from below.

use bilux_math::Vec3;

/// A distribution of microfacets.
pub(in crate::bsdf) trait Smith {
    /// The density of microfacets over their normals, which integrates to 1 if weighted by their cosine.
    fn distribution(&self, m: Vec3) -> f32;

    /// cosθ·(1 + 2Λ), where Λ is Smith's auxiliary function: finite along the surface too.
    fn shadow(&self, v: Vec3) -> f32;

    /// The height-correlated masking and shadowing of two directions, G2 / (4·cosθo): f·|cosθi| of microfacets that
    /// reflect from `wi` to `wo` with density 1. [Heitz 2014, eq. 99]
    #[inline]
    fn visible(&self, wo: Vec3, wi: Vec3) -> f32 {
        let sum = self.shadow(wo) * wi.z + self.shadow(wi) * wo.z;
        if sum > 0.0 { 0.5 * wi.z / sum } else { 0.0 }
    }

    /// The density over solid angle of the microfacets visible to `wo`, divided by the microfacet distribution and by the
    /// microfacet's cosine with `wo`.
    #[inline]
    fn seen(&self, wo: Vec3) -> f32 {
        2.0 / (wo.z + self.shadow(wo))
    }
}
