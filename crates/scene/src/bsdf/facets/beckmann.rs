//! Beckmann's distribution of microfacets: their slopes are normally distributed, with a variance of alpha² / 2 in each
//! direction. Its highlights have no tails, and less light is lost between its microfacets than between those of GGX.
//! [Walter 2007; Heitz 2014]
//!
//! Directions are local, with the normal as z, and above the surface: callers mirror directions from below.

use super::ggx::Ggx;
use super::smith::Smith;
use super::stretch::Stretch;
use bilux_math::transcendental::{erf, exp, inverse_erf};
use bilux_math::{Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// 1 / √π.
const FRAC_1_SQRT_PI: f32 = 0.564_189_6;

/// Newton's steps and halvings, of which three or four are needed.
const STEPS: usize = 24;

/// Microfacets whose slopes are normally distributed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beckmann(Stretch);

impl Beckmann {
    /// Microfacets of equal roughness in all directions.
    pub fn new(alpha: f32) -> Beckmann {
        Beckmann::anisotropic(alpha, alpha, 0.0)
    }

    /// One alpha along a direction, which is the local x axis turned by `rotation` in radians, and another across it.
    pub fn anisotropic(alpha_along: f32, alpha_across: f32, rotation: f32) -> Beckmann {
        Beckmann(Stretch::new(alpha_along, alpha_across, rotation))
    }

    /// From the parameters of the materials, as [`Ggx::from_roughness`](super::Ggx::from_roughness).
    pub fn from_roughness(roughness: f32, anisotropy: f32, rotation: f32) -> Beckmann {
        Beckmann(Stretch::from_roughness(roughness, anisotropy, rotation))
    }

    /// True for a surface that reflects as a delta distribution.
    #[inline]
    pub fn is_smooth(&self) -> bool {
        self.0.least == 0.0
    }

    /// As rough, with GGX's long tails.
    pub(in crate::bsdf) fn with_tails(&self) -> Ggx {
        Ggx(self.0)
    }

    /// Samples a microfacet visible to `wo`, which is above the surface: its two slopes are independent, and only the one
    /// towards `wo` depends on `wo`. [Jakob 2014]
    pub(in crate::bsdf) fn sample_visible(&self, wo: Vec3, u: Vec2) -> Vec3 {
        let flat = self.0.of(wo.x, wo.y);
        let length = flat.length();
        let towards = if length > 0.0 { flat / length } else { Vec2::X };
        let whole = (length * length + wo.z * wo.z).sqrt();
        let slopes = towards * slope_towards(length / whole, wo.z / whole, u.y)
            + towards.perp() * inverse_erf(2.0 * u.x - 1.0);
        let flat = self.0.of(slopes.x, slopes.y);
        Vec3::new(flat.x, flat.y, 1.0).normalize()
    }
}

impl Smith for Beckmann {
    /// [Walter 2007, eq. 25]
    #[inline]
    fn distribution(&self, m: Vec3) -> f32 {
        let (determinant, back) = self.0.back(m);
        let square = m.z * m.z;
        let peak = exp(-back.length_squared() / square);
        // Facets so steep are none at all.
        if peak > 0.0 { FRAC_1_PI * peak / (determinant * square * square) } else { 0.0 }
    }

    /// With the error function itself: Walter's rational fit of Λ is off by up to a third of a percent. [Heitz 2014, eq. 71]
    #[inline]
    fn shadow(&self, v: Vec3) -> f32 {
        shadow(self.0.of(v.x, v.y).length(), v.z)
    }
}

/// [`Smith::shadow`] of a direction with these horizontal and vertical parts, at an alpha of 1.
#[inline]
fn shadow(flat: f32, up: f32) -> f32 {
    let a = up / flat;
    up * erf(a) + flat * FRAC_1_SQRT_PI * exp(-a * a)
}

/// Samples the slope, towards a direction with this sine and cosine, of the facets that it sees, at an alpha of 1. Their density is
/// the cosine between the two times the distribution.
fn slope_towards(sin: f32, cos: f32, u: f32) -> f32 {
    // Slopes away from the direction, x, are below cos / sin. With b = erf(x) the fraction of light on facets of at most x is
    // (cos · (1 + b) + sin · exp(-x²) / √π) / 2 over its whole, which is concave in b, and linear at normal incidence.
    let wanted = u * 0.5 * (cos + shadow(sin, cos));
    let (mut least, mut most) = (-1.0, erf(cos / sin));
    let mut b: f32 = least + u * (most - least);
    let mut x = inverse_erf(b);
    for _ in 0..STEPS {
        let excess = 0.5 * (cos * (1.0 + b) + sin * FRAC_1_SQRT_PI * exp(-x * x)) - wanted;
        if excess > 0.0 {
            most = b;
        } else {
            least = b;
        }
        let step = excess / (0.5 * (cos - sin * x)).max(f32::MIN_POSITIVE);
        let next = b - step;
        let next = if next > least && next < most { next } else { 0.5 * (least + most) };
        if (next - b).abs() <= f32::EPSILON * (1.0 + b) {
            break;
        }
        (b, x) = (next, inverse_erf(next));
    }
    -x
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::transcendental::{erf_f64, exp_f64, sin_cos};
    use std::f32::consts::{FRAC_PI_2, TAU};
    use std::f64::consts::PI;

    fn direction(theta: f32, phi: f32) -> Vec3 {
        let ((sin, cos), (y, x)) = (sin_cos(theta), sin_cos(phi));
        Vec3::new(sin * x, sin * y, cos)
    }

    /// Mitsuba 3.9.1, `MicrofacetDistribution.eval` and `smith_g1`, which has Walter's rational fit: 0.4% off at most.
    #[test]
    fn density_and_masking_are_those_of_mitsuba() {
        for (alphas, theta, phi, density, masking) in [
            ([0.1, 0.1], 0.1, 0.3, 11.8671, 1.0),
            ([0.2, 0.2], 0.3, 0.0, 0.873_445, 1.0),
            ([0.8, 0.8], 0.5, 0.3, 0.526_014, 1.0),
            ([0.8, 0.8], 1.0, 1.2, 0.131_887, 0.945_484),
            ([0.1, 0.5], 0.1, 0.3, 2.582_43, 1.0),
            ([0.1, 0.5], 0.3, 0.5, 0.004_410_8, 1.0),
            ([0.1, 0.5], 1.45, 1.2, 0.0, 0.603_507),
            ([0.5, 0.5], 1.0, 0.4, 0.000_913_703, 0.995_562),
            ([0.5, 0.5], 1.4, 0.4, 0.0, 0.707_029),
            ([1.0, 1.0], 1.2, 0.0, 0.024_718_6, 0.749_214),
            ([1.0, 1.0], 1.55, 0.0, 0.0, 0.071_027_6),
        ] {
            let (facets, v) = (Beckmann::anisotropic(alphas[0], alphas[1], 0.0), direction(theta, phi));
            let (d, g) = (facets.distribution(v), facets.seen(v) * v.z);
            assert!((d - density).abs() <= 1e-4 * density + 1e-20, "{alphas:?} {theta}: {d}, not {density}");
            assert!((g / masking - 1.0).abs() < 4e-3, "{alphas:?} {theta}: {g}, not {masking}");
        }
    }

    /// The area of all facets over that of the surface, and of those that are seen, both projected along `v`.
    fn projected(distribution: &impl Smith, masking: &impl Smith, v: Vec3) -> [f64; 2] {
        const N: u32 = 200;
        let mut sums = [0f64; 2];
        let [theta_step, phi_step] = [FRAC_PI_2 / N as f32, TAU / (2 * N) as f32];
        for i in 0..2 * N * N {
            let m = direction(((i % N) as f32 + 0.5) * theta_step, ((i / N) as f32 + 0.5) * phi_step);
            let solid_angle = (1.0 - m.z * m.z).sqrt() * theta_step * phi_step;
            let d = distribution.distribution(m) * solid_angle;
            sums[0] += f64::from(d * m.z);
            sums[1] += f64::from(d * v.dot(m).max(0.0) * masking.seen(v) * v.z);
        }
        [sums[0], sums[1] / f64::from(v.z)]
    }

    #[test]
    fn facets_cover_the_surface_and_what_is_seen_of_them_too() {
        for (along, across, turn) in [(0.2, 0.2, 0.0), (0.7, 0.7, 0.0), (0.15, 0.6, 0.5)] {
            let (beckmann, ggx) =
                (Beckmann::anisotropic(along, across, turn), Ggx::anisotropic(along, across, turn));
            for theta in [0.0, 0.8, 1.3, 1.5] {
                let v = direction(theta, 0.9);
                for [all, seen] in [projected(&beckmann, &beckmann, v), projected(&ggx, &ggx, v)] {
                    assert!((all - 1.0).abs() < 2e-3 && (seen - 1.0).abs() < 2e-3, "{theta}: {all} {seen}");
                }
            }
            let v = direction(1.3, 0.9);
            let [_, mixed_up] = projected(&beckmann, &ggx, v);
            assert!((mixed_up - 1.0).abs() > 1e-2, "the masking of another distribution passes: {mixed_up}");
        }
    }

    /// The fraction of the light along a direction that meets facets whose slope towards it is at least this.
    fn met(sin: f64, cos: f64, slope: f64) -> f64 {
        let below = |x: f64| cos * (1.0 + erf_f64(x)) + sin * exp_f64(-x * x) / PI.sqrt();
        below(-slope) / if sin > 0.0 { below(cos / sin) } else { 2.0 * cos }
    }

    #[test]
    fn sampled_slopes_are_where_the_light_is() {
        let mut forgets_the_cosine = 0.0f64;
        for theta in [0.0, 1e-6, 0.1, 0.7, 1.2, 1.5, 1.57, FRAC_PI_2] {
            let (sin, cos) = sin_cos(theta);
            let cos = cos.max(0.0);
            for u in (1..1000).map(|i| i as f32 / 1e3).chain([0.0, 1e-5, 1.0 - f32::EPSILON]) {
                let slope = slope_towards(sin, cos, u);
                assert!(slope.abs() < 4.0 && cos + sin * slope > -1e-3, "{theta} {u}: {slope}");
                let found = met(sin.into(), cos.into(), slope.into());
                // As exact as `inverse_erf`: 1e-6 of a slope below 4, and rounding.
                assert!((found - f64::from(u)).abs() < 5e-6, "{theta} {u}: {slope} is at {found}");
                let without = f64::from(-inverse_erf(2.0 * u - 1.0));
                forgets_the_cosine =
                    forgets_the_cosine.max((met(sin.into(), cos.into(), without) - f64::from(u)).abs());
            }
        }
        assert!(forgets_the_cosine > 0.1, "slopes that do not depend on the direction pass");
    }
}
