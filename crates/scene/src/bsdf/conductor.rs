//! Metal: opaque microfacets that reflect by Fresnel's equations, smooth or rough. [Walter 2007]

use super::facets::Smith;
use super::{Beckmann, BsdfEntry, BsdfSample, Facets, Fresnel, Ggx, Lobe, TransportMode};
use bilux_math::frame::reflect;
use bilux_math::registry::Entry;
use bilux_math::{Rgb, Vec2, Vec3};

/// Row of [`super::BSDFS`].
pub(super) const ENTRY: BsdfEntry = BsdfEntry {
    entry: Entry {
        name: "conductor",
        summary: "conductor: Fresnel reflection, smooth or with microfacets",
        source: "Walter 2007",
        parameters: &[],
    },
    reciprocal: true,
    lossless: false,
    cases: || {
        let metal = |facets: Facets| {
            let fresnel = Fresnel::Complex { eta: Rgb::new(0.21, 1.04, 1.29), k: Rgb::new(3.3, 2.6, 2.4) };
            Lobe::Conductor(Conductor { fresnel, facets })
        };
        let white =
            |facets| Lobe::Conductor(Conductor { fresnel: Fresnel::tinted(Rgb::WHITE, Rgb::WHITE), facets });
        vec![
            ("polished", metal(Facets::SMOOTH)),
            ("satin", metal(Ggx::new(0.1).into())),
            ("white", white(Ggx::new(0.4).into())),
            ("brushed", metal(Ggx::anisotropic(0.08, 0.5, 0.6).into())),
            ("sandblasted", metal(Ggx::anisotropic(1.2, 1.0, -1.0).into())),
            ("satin, Beckmann", metal(Beckmann::new(0.15).into())),
            ("white, Beckmann", white(Beckmann::new(0.5).into())),
            ("brushed, Beckmann", metal(Beckmann::anisotropic(0.1, 0.6, 0.6).into())),
            ("sandblasted, Beckmann", metal(Beckmann::anisotropic(1.2, 1.0, -1.0).into())),
        ]
    },
};

/// A metal, the same on both sides of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor {
    /// The reflectance of a microfacet.
    pub fresnel: Fresnel,
    /// Microfacets of the surface.
    pub facets: Facets,
}

impl Conductor {
    #[inline]
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Rgb {
        self.eval_and_pdf(wo, wi, mode).0
    }

    #[inline]
    pub(super) fn pdf_solid_angle(&self, wo: Vec3, wi: Vec3) -> f32 {
        match facet_between(self.facets.is_smooth(), wo, wi) {
            Some((wo, _, m)) => self.facets.distribution(m) * self.facets.reflected(wo),
            None => 0.0,
        }
    }

    pub(super) fn eval_and_pdf(&self, wo: Vec3, wi: Vec3, _mode: TransportMode) -> (Rgb, f32) {
        let Some((wo, wi, m)) = facet_between(self.facets.is_smooth(), wo, wi) else {
            return (Rgb::BLACK, 0.0);
        };
        let distribution = self.facets.distribution(m);
        let reflected = self.fresnel.at(wo.dot(m)) * (distribution * self.facets.visible(wo, wi));
        (reflected, distribution * self.facets.reflected(wo))
    }

    pub(super) fn sample(
        &self,
        wo: Vec3,
        _u_choice: f32,
        u: Vec2,
        mode: TransportMode,
    ) -> Option<BsdfSample> {
        if self.facets.is_smooth() {
            let wi = Vec3::new(-wo.x, -wo.y, wo.z);
            return Some(BsdfSample {
                wi,
                weight: self.fresnel.at(wo.z.abs()),
                pdf_solid_angle: 1.0,
                is_delta: true,
                transmits: false,
                eta: 1.0,
            });
        }
        let above = Vec3::new(wo.x, wo.y, wo.z.abs());
        let m = self.facets.sample_reflecting(above, u);
        let wi = reflect(above, m);
        let wi = Vec3::new(wi.x, wi.y, wi.z.copysign(wi.z * wo.z)).normalize();
        let (f, pdf_solid_angle) = self.eval_and_pdf(wo, wi, mode);
        BsdfSample::reflected(wi, f, pdf_solid_angle)
    }

    #[inline]
    pub(super) fn strength(&self) -> f32 {
        self.fresnel.at(1.0).luminance()
    }
}

/// The two directions mirrored to above the surface, and the half-vector; `None` where they are on opposite sides of
/// the surface, or the surface is smooth.
#[inline]
pub(super) fn facet_between(is_smooth: bool, wo: Vec3, wi: Vec3) -> Option<(Vec3, Vec3, Vec3)> {
    if wo.z * wi.z <= 0.0 || is_smooth {
        return None;
    }
    let (wo, wi) = (Vec3::new(wo.x, wo.y, wo.z.abs()), Vec3::new(wi.x, wi.y, wi.z.abs()));
    Some((wo, wi, (wo + wi).try_normalize()?))
}
