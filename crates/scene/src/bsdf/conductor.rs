//! Metal: opaque microfacets that reflect by Fresnel's equations, smooth or rough. [Walter 2007]

use super::{BsdfEntry, BsdfSample, Ggx, Lobe, TransportMode};
use bilux_math::frame::reflect;
use bilux_math::registry::Entry;
use bilux_math::{Rgb, Vec2, Vec3};

/// Row of [`super::BSDFS`].
pub(super) const ENTRY: BsdfEntry = BsdfEntry {
    entry: Entry {
        name: "conductor",
        summary: "conductor: Fresnel reflection, smooth or with GGX microfacets",
        source: "Walter 2007",
        parameters: &[],
    },
    reciprocal: true,
    lossless: false,
    cases: || {
        let metal = |ggx| {
            let fresnel = Fresnel::Complex { eta: Rgb::new(0.21, 1.04, 1.29), k: Rgb::new(3.3, 2.6, 2.4) };
            Lobe::Conductor(Conductor { fresnel, ggx })
        };
        let white =
            |ggx| Lobe::Conductor(Conductor { fresnel: Fresnel::tinted(Rgb::WHITE, Rgb::WHITE), ggx });
        vec![
            ("polished", metal(Ggx::SMOOTH)),
            ("satin", metal(Ggx::new(0.1))),
            ("white", white(Ggx::new(0.4))),
            ("brushed", metal(Ggx::anisotropic(0.08, 0.5, 0.6))),
            ("sandblasted", metal(Ggx::anisotropic(1.2, 1.0, -1.0))),
        ]
    },
};

/// The reflectance of a microfacet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fresnel {
    /// From the complex refractive index eta + i·k, relative to the outside.
    Complex {
        /// Its real part, above 0.
        eta: Rgb,
        /// Its imaginary part, the extinction, 0 or more.
        k: Rgb,
    },
    /// From the reflectance at normal incidence; see [`Fresnel::tinted`].
    Tinted {
        /// The reflectance at normal incidence, 0..=1.
        straight: Rgb,
        /// The amount subtracted near grazing.
        dip: Rgb,
    },
}

/// The cosine of 82 degrees, near which Schlick's curve is steepest and the reflectance of real metals dips.
const COS_82: f32 = 0.139_173_1;

impl Fresnel {
    /// The reflectance at normal incidence, 0..=1, and the factor on Schlick's approximation at 82 degrees, 0..=1;
    /// white leaves the approximation as it is. [Kutz 2021, eq. 5]
    pub fn tinted(straight: Rgb, edge: Rgb) -> Fresnel {
        let straight = straight.clamp(0.0, 1.0);
        let at_82 = schlick_from(straight, COS_82);
        let dip = at_82 * edge.map(|e| 1.0 - e.clamp(0.0, 1.0)) / dent(COS_82);
        Fresnel::Tinted { straight, dip }
    }

    /// The cosine-weighted mean of the reflectance over all directions; for measured metals, the reflectance at normal
    /// incidence.
    pub fn mean(&self) -> Rgb {
        match self {
            Fresnel::Complex { .. } => self.at(1.0),
            // ∫ (1-µ)⁵ 2µ dµ and ∫ µ (1-µ)⁶ 2µ dµ
            Fresnel::Tinted { straight, dip } => {
                (straight.lerp(Rgb::WHITE, 1.0 / 21.0) + *dip * (-1.0 / 126.0)).clamp(0.0, 1.0)
            }
        }
    }

    /// The reflectance, where `cos_theta`, 0..=1, is between the direction and the microfacet's normal.
    #[inline]
    pub fn at(&self, cos_theta: f32) -> Rgb {
        let c = cos_theta.clamp(0.0, 1.0);
        match self {
            Fresnel::Complex { eta, k } => {
                let channel = |i: usize| fresnel_conductor(c, eta[i], k[i]);
                Rgb::new(channel(0), channel(1), channel(2))
            }
            Fresnel::Tinted { straight, dip } => {
                (schlick_from(*straight, c) + *dip * -dent(c)).clamp(0.0, 1.0)
            }
        }
    }
}

/// [Schlick 1994, eq. 15]
fn schlick_from(straight: Rgb, cos: f32) -> Rgb {
    let m = 1.0 - cos;
    straight.lerp(Rgb::WHITE, (m * m) * (m * m) * m)
}

fn dent(cos: f32) -> f32 {
    let m = 1.0 - cos;
    cos * (m * m) * (m * m) * (m * m)
}

/// The reflectance of a smooth metal of index `eta` + i·`k` for unpolarised light. [pbrt 2023, 9.3.6]
pub fn fresnel_conductor(cos_theta: f32, eta: f32, k: f32) -> f32 {
    let (cos2, sin2) = (cos_theta * cos_theta, 1.0 - cos_theta * cos_theta);
    // The square of index times cosine of the refracted direction is a + i·2·eta·k; here are its modulus and root.
    let a = eta * eta - k * k - sin2;
    let absolute = (a * a + 4.0 * eta * eta * k * k).sqrt();
    let root = (0.5 * (absolute + a)).max(0.0).sqrt();
    let (even, odd) = (absolute + cos2, 2.0 * root * cos_theta);
    let perpendicular = (even - odd) / (even + odd);
    let (even, odd) = (absolute * cos2 + sin2 * sin2, odd * sin2);
    0.5 * perpendicular * (1.0 + (even - odd) / (even + odd))
}

/// A metal, the same on both sides of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor {
    /// The reflectance of a microfacet.
    pub fresnel: Fresnel,
    /// The distribution of its microfacets.
    pub ggx: Ggx,
}

impl Conductor {
    #[inline]
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Rgb {
        self.eval_and_pdf(wo, wi, mode).0
    }

    #[inline]
    pub(super) fn pdf_solid_angle(&self, wo: Vec3, wi: Vec3) -> f32 {
        match facet_between(&self.ggx, wo, wi) {
            Some((wo, _, m)) => self.ggx.distribution(m) * self.ggx.reflected_within_bound(wo),
            None => 0.0,
        }
    }

    pub(super) fn eval_and_pdf(&self, wo: Vec3, wi: Vec3, _mode: TransportMode) -> (Rgb, f32) {
        let Some((wo, wi, m)) = facet_between(&self.ggx, wo, wi) else { return (Rgb::BLACK, 0.0) };
        let distribution = self.ggx.distribution(m);
        let reflected = self.fresnel.at(wo.dot(m)) * (distribution * self.ggx.visible(wo, wi));
        (reflected, distribution * self.ggx.reflected_within_bound(wo))
    }

    pub(super) fn sample(
        &self,
        wo: Vec3,
        _u_choice: f32,
        u: Vec2,
        mode: TransportMode,
    ) -> Option<BsdfSample> {
        if self.ggx.is_smooth() {
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
        let m = self.ggx.sample_visible(above, u, self.ggx.bound(above));
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
pub(super) fn facet_between(ggx: &Ggx, wo: Vec3, wi: Vec3) -> Option<(Vec3, Vec3, Vec3)> {
    if wo.z * wi.z <= 0.0 || ggx.is_smooth() {
        return None;
    }
    let (wo, wi) = (Vec3::new(wo.x, wo.y, wo.z.abs()), Vec3::new(wi.x, wi.y, wi.z.abs()));
    Some((wo, wi, (wo + wi).try_normalize()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_extinction_a_metal_is_glass() {
        for eta in [1.33, 1.5, 2.4] {
            for i in 0..=50 {
                let cos = i as f32 / 50.0;
                let (metal, glass) =
                    (fresnel_conductor(cos, eta, 0.0), super::super::fresnel_dielectric(cos, eta));
                assert!((metal - glass).abs() < 1e-5, "eta {eta}, cos {cos}: {metal}, {glass}");
            }
        }
    }

    #[test]
    fn normal_incidence_matches_the_closed_form() {
        for (eta, k) in [(0.2f32, 3.4f32), (1.0, 7.0), (3.0, 3.0)] {
            let wanted = ((eta - 1.0) * (eta - 1.0) + k * k) / ((eta + 1.0) * (eta + 1.0) + k * k);
            assert!((fresnel_conductor(1.0, eta, k) - wanted).abs() < 1e-6);
            assert!((fresnel_conductor(0.0, eta, k) - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn a_tint_is_matched_at_normal_incidence_and_at_82_degrees() {
        let (straight, edge) = (Rgb::new(1.0, 0.7, 0.3), Rgb::new(1.0, 0.9, 0.5));
        let fresnel = Fresnel::tinted(straight, edge);
        assert_eq!(fresnel.at(1.0), straight);
        let wanted = schlick_from(straight, COS_82) * edge;
        let found = fresnel.at(COS_82);
        assert!((0..3).all(|c| (found[c] - wanted[c]).abs() < 1e-5), "{found:?}, {wanted:?}");
    }
}
