//! A smooth boundary between two media that do not absorb: Fresnel's equations and Snell's law.

use super::{BsdfEntry, BsdfSample, Lobe, ThinFilm, TransportMode};
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
        let eta = self.eta_from(wo);
        let mut reflected = fresnel_dielectric(wo.z.abs(), if self.thin { self.eta } else { eta });
        if self.thin && reflected < 1.0 {
            // Light that bounces between the two faces adds up. [pbrt 2023, eq. 9.12]
            reflected = 2.0 * reflected / (1.0 + reflected);
        }
        let mut colours = [Rgb::WHITE; 2];
        if let Some(film) = &self.film {
            (reflected, colours) = shares(film.over_clear(wo.z.abs(), self.eta, wo.z > 0.0, self.thin));
        }
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

/// The reflectance of a smooth boundary for unpolarised light.
///
/// `cos_theta`, 0..=1, belongs to the incident direction, and `eta` is the index of the far side over the near side.
/// The result is 1 under total internal reflection. [pbrt 2023, 9.3.5]
pub fn fresnel_dielectric(cos_theta: f32, eta: f32) -> f32 {
    let cos_i = cos_theta.clamp(0.0, 1.0);
    let sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
    if sin2_t >= 1.0 {
        return 1.0;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    (parallel * parallel + perpendicular * perpendicular) * 0.5
}

/// Schlick's approximation to [`fresnel_dielectric`], including total internal reflection: from the denser side it uses
/// the cosine of the refracted direction. [Schlick 1994, eq. 15]
pub fn schlick(cos_theta: f32, eta: f32) -> f32 {
    let cos_i = cos_theta.clamp(0.0, 1.0);
    let r0 = ((1.0 - eta) / (1.0 + eta)) * ((1.0 - eta) / (1.0 + eta));
    let cos = if eta < 1.0 {
        let sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
        if sin2_t >= 1.0 {
            return 1.0;
        }
        (1.0 - sin2_t).sqrt()
    } else {
        cos_i
    };
    let m = 1.0 - cos;
    r0 + (1.0 - r0) * (m * m) * (m * m) * m
}

/// The refracted direction, away from the surface; `n` is on the side of `wo`, and `eta` is the index of the far side
/// over the near side. `None` under total internal reflection.
pub fn refract(wo: Vec3, n: Vec3, eta: f32) -> Option<Vec3> {
    let cos_i = wo.dot(n);
    let sin2_t = (1.0 - cos_i * cos_i).max(0.0) / (eta * eta);
    if sin2_t >= 1.0 {
        return None;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    Some((n * (cos_i / eta - cos_t) - wo / eta).normalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn snell_holds() {
        let n = Vec3::Z;
        for eta in [1.5, 1.0 / 1.5, 1.33] {
            for degrees in [1.0f32, 20.0, 40.0] {
                let (sin, cos) = bilux_math::transcendental::sin_cos(degrees.to_radians());
                let wi = refract(Vec3::new(sin, 0.0, cos), n, eta).unwrap();
                assert!((sin - eta * -wi.x).abs() < 1e-6, "eta {eta}, {degrees} degrees");
                assert!(wi.z < 0.0);
            }
        }
    }

    #[test]
    fn beyond_the_critical_angle_all_is_reflected() {
        let grazing = Vec3::new(0.8, 0.0, 0.6);
        assert!(refract(grazing, Vec3::Z, 1.0 / 1.5).is_none());
        assert_eq!(fresnel_dielectric(0.6, 1.0 / 1.5), 1.0);
        assert_eq!(schlick(0.6, 1.0 / 1.5), 1.0);
    }

    #[test]
    fn schlick_is_near_fresnel() {
        for i in 0..=100 {
            let cos = i as f32 / 100.0;
            assert!((schlick(cos, 1.5) - fresnel_dielectric(cos, 1.5)).abs() < 0.06, "cos {cos}");
        }
    }
}
