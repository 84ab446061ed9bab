//! Reflection at the surface itself, by microfacets of glass, metal or a mixture of both. Multiple scattering between
//! the microfacets of metal is not traced: it leaves in a wide lobe that carries just enough light that a white metal
//! loses nothing, and a coloured metal becomes more saturated. [Kulla 2017]

use super::conductor::facet_between;
use super::facets::Smith;
use super::{
    Albedo, BsdfEntry, BsdfSample, Coating, Fresnel, Ggx, Lobe, ThinFilm, TransportMode, fresnel_dielectric,
};
use bilux_math::frame::reflect;
use bilux_math::registry::Entry;
use bilux_math::transcendental::sin_cos;
use bilux_math::{Rgb, Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, TAU};

/// Row of [`super::BSDFS`].
pub(super) const ENTRY: BsdfEntry = BsdfEntry {
    entry: Entry {
        name: "microfacet reflection",
        summary: "microfacet reflection of a dielectric, a conductor or a mixture, with multiple scattering",
        source: "Kulla 2017",
        parameters: &[],
    },
    reciprocal: true,
    lossless: true,
    cases: || {
        let of = |ggx, metal: f32| {
            let tint = Fresnel::tinted(Rgb::new(1.0, 0.78, 0.34), Rgb::new(0.9, 1.0, 0.8));
            Lobe::MicrofacetReflection(MicrofacetReflection::new(
                ggx,
                1.5,
                Rgb::grey(1.0 - metal),
                tint,
                Rgb::grey(metal),
                Coating::NONE,
            ))
        };
        let white = |ggx| {
            let tint = Fresnel::tinted(Rgb::WHITE, Rgb::WHITE);
            Lobe::MicrofacetReflection(MicrofacetReflection::new(
                ggx,
                1.5,
                Rgb::BLACK,
                tint,
                Rgb::WHITE,
                Coating::NONE,
            ))
        };
        vec![
            ("polished plastic", of(Ggx::SMOOTH, 0.0)),
            ("plastic", of(Ggx::new(0.2), 0.0)),
            ("gold", of(Ggx::new(0.3), 1.0)),
            (
                "below oil",
                Lobe::MicrofacetReflection(
                    MicrofacetReflection::new(
                        Ggx::new(0.2),
                        1.5,
                        Rgb::grey(0.5),
                        Fresnel::tinted(Rgb::grey(0.6), Rgb::WHITE),
                        Rgb::grey(0.5),
                        Coating::NONE,
                    )
                    .below(ThinFilm { weight: 0.8, thickness: 420.0, eta: 1.4 }),
                ),
            ),
            ("half gold", of(Ggx::anisotropic(0.1, 0.5, 0.4), 0.5)),
            ("white, smooth", white(Ggx::SMOOTH)),
            ("white, satin", white(Ggx::new(0.08))),
            ("white, rough", white(Ggx::new(0.4))),
            ("white, as rough as can be", white(Ggx::new(1.0))),
        ]
    },
};

/// Reflection at the surface, the same on both of its sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MicrofacetReflection {
    ggx: Ggx,
    /// The index below the glass microfacets over the index above.
    eta: f32,
    /// A factor on the reflection of glass microfacets; black if there are none.
    glass: Rgb,
    metal: Fresnel,
    /// A factor on the reflection of metal microfacets; black if there are none.
    metal_weight: Rgb,
    albedo: Albedo,
    /// The multiple-scattering colour, divided by the two fractions that a single bounce loses.
    again: Rgb,
    /// The probability of sampling multiple scattering, divided by the fraction that a single bounce along `wo` loses.
    again_share: f32,
    cover: Coating,
    film: Option<ThinFilm>,
    /// A factor on light from below.
    from_below: f32,
}

impl MicrofacetReflection {
    /// Microfacets of an index `eta`, at least 1, that reflect `glass` times Fresnel's reflectance, and `metal_weight`
    /// times that of metal. The sum of the two is at most white.
    pub fn new(
        ggx: Ggx,
        eta: f32,
        glass: Rgb,
        metal: Fresnel,
        metal_weight: Rgb,
        cover: Coating,
    ) -> MicrofacetReflection {
        let albedo = Albedo::new(&ggx, eta);
        let mut gloss = MicrofacetReflection {
            ggx,
            eta,
            glass,
            metal,
            metal_weight,
            albedo,
            again: Rgb::BLACK,
            again_share: 0.0,
            cover,
            film: None,
            from_below: 1.0,
        };
        if !metal_weight.is_black() && !ggx.is_smooth() {
            let (mean, microfacet) = (albedo.opaque_mean(), metal.mean());
            let comes_out = microfacet.map(|f| f * f * mean / (1.0 - f * (1.0 - mean)));
            gloss.again = comes_out * metal_weight / (1.0 - mean).max(1e-6);
            gloss.again_share =
                ((comes_out * metal_weight).luminance() / gloss.strength().max(f32::MIN_POSITIVE)).min(1.0);
        }
        gloss
    }

    /// Sets the factor, 0..=1, on light from below the surface.
    pub fn from_below(self, factor: f32) -> MicrofacetReflection {
        MicrofacetReflection { from_below: factor, ..self }
    }

    /// Puts a thin film on the surface.
    pub fn below(self, film: ThinFilm) -> MicrofacetReflection {
        MicrofacetReflection { film: Some(film), ..self }
    }

    /// True for white metal without a coating, which reflects all light.
    pub fn is_white(&self) -> bool {
        let is_bare = self.cover.is_none() && self.from_below == 1.0;
        is_bare && self.metal_weight == Rgb::WHITE && self.metal == Fresnel::tinted(Rgb::WHITE, Rgb::WHITE)
    }

    #[inline]
    fn fresnel(&self, cos: f32) -> Rgb {
        match &self.film {
            Some(film) => self.fresnel_below(film, cos),
            None => self.fresnel_bare(cos),
        }
    }

    #[inline]
    fn fresnel_bare(&self, cos: f32) -> Rgb {
        let mut reflected = Rgb::BLACK;
        if !self.metal_weight.is_black() {
            reflected = self.metal.at(cos) * self.metal_weight;
        }
        if !self.glass.is_black() {
            reflected += self.glass * fresnel_dielectric(cos, self.eta);
        }
        reflected
    }

    #[inline(never)]
    fn fresnel_below(&self, film: &ThinFilm, cos: f32) -> Rgb {
        let within = film.within(cos);
        let mut reflected = Rgb::BLACK;
        if !self.metal_weight.is_black() {
            reflected = within.over_metal(&self.metal) * self.metal_weight;
        }
        if !self.glass.is_black() {
            reflected += self.glass * within.over_glass(self.eta);
        }
        self.fresnel_bare(cos).lerp(reflected, film.weight)
    }

    /// The layers above.
    #[inline]
    pub(super) fn cover(&self) -> &Coating {
        &self.cover
    }

    /// The fraction of light that passes the coating above the microfacets, of the fractions along both directions.
    #[inline]
    fn covered(&self, [passed_wo, passed_wi]: [f32; 2], wo: Vec3) -> f32 {
        let passed = passed_wo.min(passed_wi);
        if wo.z < 0.0 { passed * self.from_below } else { passed }
    }

    #[inline]
    pub(super) fn is_delta(&self) -> bool {
        self.ggx.is_smooth()
    }

    #[inline]
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Rgb {
        self.eval_and_pdf(wo, wi, mode).0
    }

    #[inline]
    pub(super) fn pdf_solid_angle(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.eval_and_pdf(wo, wi, TransportMode::Radiance).1
    }

    #[inline]
    pub(super) fn eval_and_pdf(&self, wo: Vec3, wi: Vec3, _mode: TransportMode) -> (Rgb, f32) {
        self.eval_and_pdf_below(self.cover.passed_along_both(wo, wi), wo, wi)
    }

    /// [`MicrofacetReflection::eval_and_pdf`] by what the cover lets pass along both directions.
    pub(super) fn eval_and_pdf_below(&self, passed: [f32; 2], wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        let covered = self.covered(passed, wo);
        let Some((wo, wi, m)) = facet_between(self.ggx.is_smooth(), wo, wi) else {
            return (Rgb::BLACK, 0.0);
        };
        let distribution = self.ggx.distribution(m);
        let mut f = self.fresnel(wo.dot(m)) * (distribution * self.ggx.visible(wo, wi));
        let mut pdf = distribution * self.ggx.reflected_within_bound(wo);
        if self.again_share > 0.0 {
            let roots = [wo, wi].map(|v| v.z.clamp(0.0, 1.0).sqrt());
            let [left, left_wi] = self.albedo.opaque_at_roots(roots).map(|albedo| 1.0 - albedo);
            f += self.again * (left * left_wi * FRAC_1_PI * wi.z);
            let again = self.again_share * left;
            pdf = (1.0 - again) * pdf + again * self.albedo.left_pdf(wi.z) * (FRAC_1_PI * wi.z);
        }
        (f * covered, pdf)
    }

    pub(super) fn sample(&self, wo: Vec3, u_choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        if self.ggx.is_smooth() {
            let wi = Vec3::new(-wo.x, -wo.y, wo.z);
            let weight = self.fresnel(wo.z.abs()) * self.covered(self.cover.passed_along_both(wo, wi), wo);
            let sample =
                BsdfSample { wi, weight, pdf_solid_angle: 1.0, is_delta: true, transmits: false, eta: 1.0 };
            return Some(sample);
        }
        let wi = self.direction(wo, u_choice, u);
        let (f, pdf_solid_angle) = self.eval_and_pdf(wo, wi, mode);
        BsdfSample::reflected(wi, f, pdf_solid_angle)
    }

    /// The direction of [`MicrofacetReflection::sample`] for a rough surface.
    pub(super) fn direction(&self, wo: Vec3, u_choice: f32, u: Vec2) -> Vec3 {
        let above = Vec3::new(wo.x, wo.y, wo.z.abs());
        let is_again =
            self.again_share > 0.0 && u_choice < self.again_share * (1.0 - self.albedo.opaque_at(above.z));
        let wi = if is_again {
            let cos = self.albedo.sample_left(u.x);
            let ((sin_turn, cos_turn), sin) = (sin_cos(TAU * u.y), (1.0 - cos * cos).max(0.0).sqrt());
            Vec3::new(sin * cos_turn, sin * sin_turn, cos)
        } else {
            reflect(above, self.ggx.sample_visible(above, u, self.ggx.bound(above)))
        };
        Vec3::new(wi.x, wi.y, wi.z.copysign(wi.z * wo.z)).normalize()
    }

    #[inline]
    pub(super) fn strength(&self) -> f32 {
        self.fresnel(1.0).luminance()
    }

    /// Microfacets reflect more light towards grazing, and smoother surfaces gain more.
    #[inline]
    pub(super) fn rise(&self, strength: f32) -> f32 {
        let grazing = (self.glass + self.metal_weight).luminance();
        (grazing - strength).max(0.0) * (1.0 - self.ggx.least()).max(0.0)
    }
}
