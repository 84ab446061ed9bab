//! Rough glass: microfacets that reflect and refract by Fresnel's equations and Snell's law. [Walter 2007]

use super::conductor::facet_between;
use super::dielectric::shares;
use super::facets::Smith;
use super::{
    Beckmann, BsdfEntry, BsdfSample, Dielectric, Facets, Ggx, Lobe, ThinFilm, TransportMode,
    fresnel_dielectric, refract,
};
use bilux_math::frame::reflect;
use bilux_math::registry::Entry;
use bilux_math::{Rgb, Vec2, Vec3};

/// Row of [`super::BSDFS`].
pub(super) const ENTRY: BsdfEntry = BsdfEntry {
    entry: Entry {
        name: "rough dielectric",
        summary: "rough dielectric: microfacet reflection and transmission",
        source: "Walter 2007",
        parameters: &[],
    },
    reciprocal: false,
    lossless: false,
    cases: || {
        let glass = |eta, thin, facets: Facets| {
            Lobe::RoughDielectric(RoughDielectric {
                film: None,
                eta,
                dispersion: 0.0,
                tint: Rgb::WHITE,
                thin,
                facets,
            })
        };
        vec![
            ("frosted", glass(1.5, false, Ggx::new(0.3).into())),
            ("etched", glass(1.5, false, Ggx::new(0.1).into())),
            ("bubble", glass(1.0 / 1.33, false, Ggx::new(0.2).into())),
            ("diamond, scratched", glass(2.4, false, Ggx::anisotropic(0.1, 0.6, 0.4).into())),
            ("pane", glass(1.5, true, Ggx::new(0.25).into())),
            ("frosted, Beckmann", glass(1.5, false, Beckmann::new(0.4).into())),
            ("bubble, Beckmann", glass(1.0 / 1.33, false, Beckmann::new(0.2).into())),
            ("diamond, Beckmann", glass(2.4, false, Beckmann::anisotropic(0.1, 0.6, 0.4).into())),
            ("pane, Beckmann", glass(1.5, true, Beckmann::new(0.25).into())),
        ]
    },
};

/// Rough glass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughDielectric {
    /// Refractive index of the inside over that of the outside, at the d line.
    pub eta: f32,
    /// 1 over the Abbe number: how strongly the index depends on the wavelength.
    pub dispersion: f32,
    /// Factor on all light, 0..=1; white for real glass.
    pub tint: Rgb,
    /// A thin pane: transmitted light continues as the mirror image of reflected light, on the other side.
    pub thin: bool,
    /// Microfacets of the surface; not smooth.
    pub facets: Facets,
    /// A thin film on the outside; a pane has it on both sides.
    pub film: Option<ThinFilm>,
}

impl RoughDielectric {
    /// True where the roughness matters.
    ///
    /// With an index near 1, microfacets hardly bend light: it passes as through a smooth boundary, and the lobe's
    /// width is lost to rounding.
    pub fn is_rough(eta: f32, thin: bool, facets: &Facets) -> bool {
        !facets.is_smooth() && (thin || (eta - 1.0).abs() > 1e-2)
    }

    /// Replaces the index; the lobe becomes smooth if that is close to the index of the outside.
    pub fn of_index(self, eta: f32) -> Lobe {
        let RoughDielectric { dispersion, tint, thin, facets, film, .. } = self;
        if RoughDielectric::is_rough(eta, thin, &facets) {
            Lobe::RoughDielectric(RoughDielectric { eta, ..self })
        } else {
            Lobe::Dielectric(Dielectric { eta, dispersion, tint, thin, film })
        }
    }

    #[inline]
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Rgb {
        self.eval_and_pdf(wo, wi, mode).0
    }

    #[inline]
    pub(super) fn pdf_solid_angle(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.eval_and_pdf(wo, wi, TransportMode::Importance).1
    }

    pub(super) fn eval_and_pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> (Rgb, f32) {
        let (f, pdf, colours) = match (wo.z * wi.z > 0.0, self.thin) {
            (true, _) => self.reflected(wo, wi, |reflected| reflected),
            (false, true) => self.reflected(wo, Vec3::new(wi.x, wi.y, -wi.z), |reflected| 1.0 - reflected),
            (false, false) => self.refracted(wo, wi, mode),
        };
        let passes = usize::from(wo.z * wi.z < 0.0);
        (self.tint * colours[passes] * f, pdf)
    }

    /// Light reflected by the microfacets, or transmitted by those of a pane; `share` maps Fresnel's reflectance to its
    /// factor. With the density, and the [colours](RoughDielectric::fresnel) of light.
    #[inline]
    fn reflected(&self, wo: Vec3, wi: Vec3, share: impl Fn(f32) -> f32) -> (f32, f32, [Rgb; 2]) {
        let (eta, outside) = (self.eta_from(wo), wo.z > 0.0);
        let Some((wo, wi, m)) = facet_between(self.facets.is_smooth(), wo, wi) else {
            return NOTHING;
        };
        let (reflected, colours) = self.fresnel(wo.dot(m), eta, outside);
        let density = self.facets.distribution(m) * share(reflected);
        (density * self.facets.visible(wo, wi), density * 0.25 * self.facets.seen(wo), colours)
    }

    /// Light refracted by the microfacets. [Walter 2007, eq. 21]
    #[inline]
    fn refracted(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> (f32, f32, [Rgb; 2]) {
        let (eta, outside) = (self.eta_from(wo), wo.z > 0.0);
        let side = 1f32.copysign(wo.z);
        let (wo, wi) = (Vec3::new(wo.x, wo.y, wo.z * side), Vec3::new(wi.x, wi.y, wi.z * side));
        let Some(m) = (wo + wi * eta).try_normalize().map(|m| m * 1f32.copysign(m.z)) else {
            return NOTHING;
        };
        let (cos_o, cos_i) = (wo.dot(m), -wi.dot(m));
        if cos_o <= 0.0 || cos_i <= 0.0 || wo.z == 0.0 || wi.z == 0.0 {
            return NOTHING;
        }
        let spread = cos_o - eta * cos_i;
        let per_angle = cos_i * cos_o * eta * eta / (spread * spread);
        // Use the cosine on the outside, from which both ends compute the same value to the last digits.
        let above = if outside { cos_o } else { cos_i };
        let (passes, colours) = match &self.film {
            Some(_) => {
                let (reflected, colours) = self.fresnel(above, self.eta, true);
                (1.0 - reflected, colours)
            }
            None => (passed(cos_o, cos_i, eta), [Rgb::WHITE; 2]),
        };
        let density = self.facets.distribution(m) * passes * per_angle;
        let below = Vec3::new(wi.x, wi.y, -wi.z);
        let f = density * 4.0 * self.facets.visible(wo, below);
        let f = if mode == TransportMode::Radiance { f / (eta * eta) } else { f };
        if f.is_finite() { (f, density * self.facets.seen(wo), colours) } else { NOTHING }
    }

    pub(super) fn sample(&self, wo: Vec3, u_choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        let BsdfSample { wi, transmits, eta, .. } = self.direction(wo, u_choice, u)?;
        let (f, pdf_solid_angle) = self.eval_and_pdf(wo, wi, mode);
        let sample = BsdfSample::reflected(wi, f, pdf_solid_angle)?;
        Some(BsdfSample { transmits, eta, ..sample })
    }

    /// The direction of [`RoughDielectric::sample`], whose weight and density are not known yet.
    pub(super) fn direction(&self, wo: Vec3, u_choice: f32, u: Vec2) -> Option<BsdfSample> {
        let eta = self.eta_from(wo);
        let above = Vec3::new(wo.x, wo.y, wo.z.abs());
        let m = self.facets.sample_visible(above, u);
        let reflects = u_choice < self.fresnel(above.dot(m), eta, wo.z > 0.0).0;
        let wi = match (reflects, self.thin) {
            (true, _) => reflect(above, m),
            (false, true) => reflect(above, m) * Vec3::new(1.0, 1.0, -1.0),
            (false, false) => refract(above, m, eta)?,
        };
        if (wi.z > 0.0) != reflects {
            return None;
        }
        let wi = Vec3::new(wi.x, wi.y, wi.z * 1f32.copysign(wo.z)).normalize();
        let eta = if reflects || self.thin { 1.0 } else { eta };
        let (weight, pdf_solid_angle) = (Rgb::BLACK, 0.0);
        Some(BsdfSample { wi, weight, pdf_solid_angle, is_delta: false, transmits: !reflects, eta })
    }

    /// The reflectance of a microfacet, averaged over the channels; for a pane, of both faces. With it the colours of
    /// what is reflected and of what passes, relative to their means.
    #[inline]
    fn fresnel(&self, cos: f32, eta: f32, outside: bool) -> (f32, [Rgb; 2]) {
        if let Some(film) = &self.film {
            return shares(film.over_clear(cos, self.eta, outside, self.thin));
        }
        if !self.thin {
            return (fresnel_dielectric(cos, eta), [Rgb::WHITE; 2]);
        }
        let once = fresnel_dielectric(cos, self.eta);
        (2.0 * once / (1.0 + once), [Rgb::WHITE; 2])
    }

    /// The index of the far side over that of the side of `wo`.
    #[inline]
    fn eta_from(&self, wo: Vec3) -> f32 {
        if wo.z > 0.0 { self.eta } else { 1.0 / self.eta }
    }

    #[inline]
    pub(super) fn strength(&self) -> f32 {
        self.tint.luminance()
    }
}

/// No light, where no microfacet scatters from one direction to the other.
const NOTHING: (f32, f32, [Rgb; 2]) = (0.0, 0.0, [Rgb::WHITE; 2]);

/// 1 minus [`fresnel_dielectric`], from the cosines on both sides: equal from both, and exact where almost nothing is
/// transmitted. `eta` is the index of the second side over that of the first.
#[inline]
fn passed(cos_o: f32, cos_i: f32, eta: f32) -> f32 {
    let (parallel, perpendicular) = (eta * cos_o + cos_i, cos_o + eta * cos_i);
    let product = 2.0 * eta * cos_o * cos_i;
    product / (parallel * parallel) + product / (perpendicular * perpendicular)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reflectance_and_transmittance_sum_to_one() {
        for eta in [1.5f32, 1.0 / 1.5, 2.4] {
            for i in 1..=40 {
                let cos = i as f32 / 40.0;
                let below = (1.0 - (1.0 - cos * cos) / (eta * eta)).max(0.0).sqrt();
                let wanted = 1.0 - fresnel_dielectric(cos, eta);
                let found = if below > 0.0 { passed(cos, below, eta) } else { 0.0 };
                assert!((found - wanted).abs() < 1e-5, "eta {eta}, cos {cos}: {found}, {wanted}");
            }
        }
    }
}
