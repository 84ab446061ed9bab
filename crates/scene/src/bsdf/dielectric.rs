//! A smooth boundary between two media that do not absorb: Fresnel's equations and Snell's law.

use super::{BsdfEntry, BsdfSample, Lobe, SmoothLobe, ThinFilm, TransportMode, refract};
use bilux_math::registry::Entry;
use bilux_math::{Rgb, Vec2, Vec3};

/// Row of [`super::BSDFS`].
pub(super) const ENTRY: BsdfEntry = BsdfEntry {
    entry: Entry {
        name: "dielectric",
        summary: "smooth dielectric: specular reflection and transmission",
        source: "Fresnel 1823",
        parameters: &[],
    },
    reciprocal: false,
    lossless: true,
    cases: || {
        let glass = |eta, thin| {
            Lobe::Dielectric(Dielectric { film: None, eta, dispersion: 0.0, tint: Rgb::WHITE, thin })
        };
        vec![
            ("glass", glass(1.5, false)),
            ("air in water", glass(1.0 / 1.33, false)),
            ("pane", glass(1.5, true)),
        ]
    },
};

/// Smooth glass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric {
    /// Refractive index of the inside over that of the outside, at the d line.
    pub eta: f32,
    /// 1 over the Abbe number: how strongly the index depends on the wavelength.
    pub dispersion: f32,
    /// Factor on all light, 0..=1; white for real glass.
    pub tint: Rgb,
    /// A thin pane: both of its faces at once, with light transmitted straight through. [pbrt 2023, 9.5.1]
    pub thin: bool,
    /// A thin film on the outside; a pane has it on both sides.
    pub film: Option<ThinFilm>,
}

impl Dielectric {
    /// Replaces the index.
    #[inline]
    pub(super) fn of_index(self, eta: f32) -> Dielectric {
        Dielectric { eta, ..self }
    }

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
        u_choice: f32,
        _u: Vec2,
        mode: TransportMode,
    ) -> Option<BsdfSample> {
        let Some(film) = &self.film else { return Some(self.without_film().bsdf_sample(wo, u_choice, mode)) };
        let eta = self.eta_from(wo);
        let (reflected, colours) = shares(film.over_clear(wo.z.abs(), self.eta, wo.z > 0.0, self.thin));
        if u_choice < reflected {
            let sample = self.towards(Vec3::new(-wo.x, -wo.y, wo.z), reflected, None);
            return Some(BsdfSample { weight: sample.weight * colours[0], ..sample });
        }
        let wi = self.transmitted(wo)?;
        let eta = if self.thin { 1.0 } else { eta };
        let mut sample = self.towards(wi, 1.0 - reflected, Some(eta));
        sample.weight *= colours[1];
        if mode == TransportMode::Radiance {
            sample.weight = sample.weight / (eta * eta);
        }
        Some(sample)
    }

    #[inline]
    fn without_film(&self) -> SmoothLobe {
        SmoothLobe { tint: self.tint, eta: self.eta, is_mirror: false, thin: self.thin }
    }

    /// The index of the far side over that of the side of `wo`.
    #[inline]
    fn eta_from(&self, wo: Vec3) -> f32 {
        if wo.z > 0.0 { self.eta } else { 1.0 / self.eta }
    }

    /// The transmitted direction; `None` under total internal reflection.
    #[inline]
    pub(super) fn transmitted(&self, wo: Vec3) -> Option<Vec3> {
        let normal = Vec3::new(0.0, 0.0, 1f32.copysign(wo.z));
        if self.thin { Some(-wo) } else { refract(wo, normal, self.eta_from(wo)) }
    }

    /// The weight of a direction is f·|cosθ| / probability: Fresnel's factor cancels against the probability.
    fn towards(&self, wi: Vec3, probability: f32, refracted: Option<f32>) -> BsdfSample {
        BsdfSample {
            wi,
            weight: self.tint,
            pdf_solid_angle: probability,
            is_delta: true,
            transmits: refracted.is_some(),
            eta: refracted.unwrap_or(1.0),
        }
    }

    #[inline]
    pub(super) fn strength(&self) -> f32 {
        self.tint.luminance()
    }
}

/// The mean reflectance of the channels, then reflectance and transmittance of each channel over their means.
pub(super) fn shares(reflected: Rgb) -> (f32, [Rgb; 2]) {
    let mean = (reflected.r + reflected.g + reflected.b) * (1.0 / 3.0);
    let over = |share: Rgb, mean: f32| if mean > 0.0 { share * (1.0 / mean) } else { Rgb::WHITE };
    (mean, [over(reflected, mean), over(Rgb::WHITE + reflected * -1.0, 1.0 - mean)])
}
