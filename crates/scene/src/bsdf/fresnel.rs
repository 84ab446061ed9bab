//! Fresnel's equations and Snell's law: how much of the light a boundary reflects, and where the rest goes.

use bilux_math::{Rgb, Vec3};

/// The reflectance of a microfacet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fresnel {
    /// From the complex refractive index eta + i·k, relative to the outside.
    Complex {
        /// Real part of the index, above 0.
        eta: Rgb,
        /// Imaginary part of the index, the extinction coefficient, 0 or more.
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
pub(super) const COS_82: f32 = 0.139_173_1;

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
#[inline(always)]
pub(super) fn schlick_from(straight: Rgb, cos: f32) -> Rgb {
    let m = 1.0 - cos;
    straight.lerp(Rgb::WHITE, (m * m) * (m * m) * m)
}

/// Curve that [`Fresnel::tinted`] subtracts, but for a factor.
#[inline(always)]
pub(super) fn dent(cos: f32) -> f32 {
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

/// The reflectance of a smooth boundary for unpolarised light.
///
/// `cos_theta`, 0..=1, belongs to the incident direction, and `eta` is the index of the far side over the near side.
/// The result is 1 under total internal reflection. It has no branch, so that loops over many can be vectorised.
/// [pbrt 2023, 9.3.5]
#[inline(always)]
pub fn fresnel_dielectric(cos_theta: f32, eta: f32) -> f32 {
    let cos_i = cos_theta.clamp(0.0, 1.0);
    let sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
    let cos_t = (1.0 - sin2_t).sqrt();
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let reflected = (parallel * parallel + perpendicular * perpendicular) * 0.5;
    if sin2_t >= 1.0 { 1.0 } else { reflected }
}

/// [`fresnel_dielectric`] for an index of at least 1; 0 for an index of 1, where there is no boundary.
#[inline(always)]
pub(super) fn fresnel_on_denser(cos_theta: f32, eta: f32) -> f32 {
    let reflected = fresnel_dielectric(cos_theta, eta);
    if eta > 1.0 { reflected } else { 0.0 }
}

/// The refracted direction, away from the surface; `n` is on the side of `wo`, and `eta` is the index of the far side
/// over the near side. `None` under total internal reflection.
pub fn refract(wo: Vec3, n: Vec3, eta: f32) -> Option<Vec3> {
    let (wi, is_total) = refract_or_not(wo, n, eta);
    (!is_total).then_some(wi)
}

/// [`refract`] without a branch: the direction, which has no meaning under total internal reflection, and whether there is
/// that.
#[inline(always)]
pub(super) fn refract_or_not(wo: Vec3, n: Vec3, eta: f32) -> (Vec3, bool) {
    let cos_i = wo.dot(n);
    let sin2_i = 1.0 - cos_i * cos_i;
    let sin2_t = (if sin2_i > 0.0 { sin2_i } else { 0.0 }) / (eta * eta);
    let cos_t = (1.0 - sin2_t).sqrt();
    let wi = n * (cos_i / eta - cos_t) - wo / eta;
    (wi * (1.0 / wi.length_squared().sqrt()), sin2_t >= 1.0)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_extinction_a_metal_is_glass() {
        for eta in [1.33, 1.5, 2.4] {
            for i in 0..=50 {
                let cos = i as f32 / 50.0;
                let (metal, glass) = (fresnel_conductor(cos, eta, 0.0), fresnel_dielectric(cos, eta));
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
