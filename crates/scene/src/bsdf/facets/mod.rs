//! The microfacets of a rough surface, by either distribution.

mod beckmann;
mod ggx;
mod smith;
mod stretch;

pub use beckmann::Beckmann;
pub use ggx::Ggx;
pub(super) use smith::Smith;
pub(super) use stretch::MIN_ALPHA;

use bilux_math::{Vec2, Vec3};

/// Microfacets of one of the distributions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Facets {
    /// With long tails: most real surfaces.
    Ggx(Ggx),
    /// Without tails.
    Beckmann(Beckmann),
}

macro_rules! each {
    ($facets:expr, $f:ident => $body:expr) => {
        match $facets {
            Facets::Ggx($f) => $body,
            Facets::Beckmann($f) => $body,
        }
    };
}

impl From<Ggx> for Facets {
    fn from(ggx: Ggx) -> Facets {
        Facets::Ggx(ggx)
    }
}

impl From<Beckmann> for Facets {
    fn from(beckmann: Beckmann) -> Facets {
        Facets::Beckmann(beckmann)
    }
}

impl Facets {
    /// A smooth surface.
    pub const SMOOTH: Facets = Facets::Ggx(Ggx::SMOOTH);

    /// True for a surface that reflects as a delta distribution.
    #[inline]
    pub fn is_smooth(&self) -> bool {
        each!(self, facets => facets.is_smooth())
    }

    /// The density over solid angle of directions reflected at microfacets of [`Facets::sample_reflecting`], divided by the
    /// microfacet distribution.
    #[inline]
    pub(in crate::bsdf) fn reflected(&self, wo: Vec3) -> f32 {
        match self {
            Facets::Ggx(ggx) => ggx.reflected_within_bound(wo),
            Facets::Beckmann(beckmann) => 0.25 * beckmann.seen(wo),
        }
    }

    /// Samples a microfacet that can reflect `wo`, which is above the surface, upwards, though it may not.
    #[inline]
    pub(in crate::bsdf) fn sample_reflecting(&self, wo: Vec3, u: Vec2) -> Vec3 {
        match self {
            Facets::Ggx(ggx) => ggx.sample_visible(wo, u, ggx.bound(wo)),
            Facets::Beckmann(beckmann) => beckmann.sample_visible(wo, u),
        }
    }

    /// Samples a microfacet visible to `wo`, which is above the surface.
    #[inline]
    pub(in crate::bsdf) fn sample_visible(&self, wo: Vec3, u: Vec2) -> Vec3 {
        match self {
            Facets::Ggx(ggx) => ggx.sample_visible(wo, u, Ggx::FULL),
            Facets::Beckmann(beckmann) => beckmann.sample_visible(wo, u),
        }
    }
}

impl Smith for Facets {
    #[inline]
    fn distribution(&self, m: Vec3) -> f32 {
        each!(self, facets => facets.distribution(m))
    }

    #[inline]
    fn shadow(&self, v: Vec3) -> f32 {
        each!(self, facets => facets.shadow(v))
    }
}
