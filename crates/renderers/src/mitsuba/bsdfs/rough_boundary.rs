//! Fractions of diffuse light that a rough boundary lets through, and reflects back inside. [Walter 2007]
//!
//! Mitsuba counts facets that light meets once, and takes what meets several as lost; so the base below is darker than one that
//! loses nothing, by a third at an alpha of 0.3. Ours loses nothing: its colour makes up for that. [Jakob 2022]

use bilux_import::appearance::fresnel::fresnel;
use bilux_math::Vec3;
use bilux_math::transcendental::{ln, sin_cos};
use std::f32::consts::PI;

/// Directions of light by the square of their cosine; facets by slope and by azimuth, of which one half mirrors the other.
const DIRECTIONS: u32 = 16;
const SLOPES: u32 = 32;
const AZIMUTHS: u32 = 24;

/// A distribution of facets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Facets {
    Beckmann,
    Ggx,
}

/// Fractions of diffuse light at a boundary; both are means over the hemisphere, weighted by the cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RoughBoundary {
    /// The fraction of light from outside that passes.
    pub(super) passed: f32,
    /// The fraction of light from inside that is reflected.
    pub(super) reflected_inside: f32,
}

impl RoughBoundary {
    /// A boundary with an index, inside over outside, of at least 1.
    pub(super) fn new(facets: Facets, alpha: f32, index: f32) -> RoughBoundary {
        let (mut passed, mut reflected_inside) = (0.0, 0.0);
        for (wi, m, share) in meetings(facets, alpha) {
            let cos = wi.dot(m);
            let masked = |wo: Vec3| facets.unmasked(alpha, wo, m) * share;
            let straight = (1.0 - (1.0 - cos * cos) / (index * index)).max(0.0).sqrt();
            let refracted = m * (cos / index - straight) - wi / index;
            if refracted.z < 0.0 {
                passed += (1.0 - fresnel(cos, index)) * masked(-refracted);
            }
            let reflected = m * (2.0 * cos) - wi;
            if reflected.z > 0.0 {
                reflected_inside += fresnel(cos, 1.0 / index) * masked(reflected);
            }
        }
        // The mean there is of a table of 64 cosines with both of its ends, of which the one at 0 counts for nothing.
        RoughBoundary { passed, reflected_inside: reflected_inside * 63.0 / 64.0 }
    }
}

/// Directions, each with the facets that it sees and the share of the light that meets them.
fn meetings(facets: Facets, alpha: f32) -> impl Iterator<Item = (Vec3, Vec3, f32)> {
    let middle = |i: u32, count: u32| (i as f32 + 0.5) / count as f32;
    (0..DIRECTIONS * SLOPES * AZIMUTHS).filter_map(move |i| {
        let square = middle(i % DIRECTIONS, DIRECTIONS);
        let wi = Vec3::new((1.0 - square).sqrt(), 0.0, square.sqrt());
        let slope = middle(i / DIRECTIONS % SLOPES, SLOPES);
        // More of the steep ones, which are seen from the side.
        let (rest, density) = (slope * slope, 2.0 * slope);
        let tangent = alpha
            * match facets {
                Facets::Beckmann => (-ln(rest)).sqrt(),
                Facets::Ggx => ((1.0 - rest) / rest).sqrt(),
            };
        let cos = 1.0 / (1.0 + tangent * tangent).sqrt();
        let (y, x) = sin_cos(middle(i / DIRECTIONS / SLOPES, AZIMUTHS) * PI);
        let m = Vec3::new(x * tangent, y * tangent, 1.0) * cos;
        let seen = wi.dot(m);
        let share = facets.unmasked(alpha, wi, m) * density * seen / (wi.z * m.z);
        (seen > 0.0).then_some((wi, m, share / (DIRECTIONS * SLOPES * AZIMUTHS) as f32))
    })
}

impl Facets {
    /// The fraction of the facets with this normal that are not hidden by others along a direction above the surface. [Walter 2007]
    fn unmasked(self, alpha: f32, v: Vec3, m: Vec3) -> f32 {
        if v.dot(m) <= 0.0 {
            return 0.0;
        }
        let tangent = alpha * (1.0 - v.z * v.z).max(0.0).sqrt() / v.z;
        match self {
            Facets::Ggx => 2.0 / (1.0 + (1.0 + tangent * tangent).sqrt()),
            Facets::Beckmann => {
                let a = 1.0 / tangent.max(f32::MIN_POSITIVE);
                if a >= 1.6 {
                    return 1.0;
                }
                (3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The albedo of a base of 0.5 without highlights, as Mitsuba 3.9.1 has it: means of `bsdf.eval`, divided by 0.5.
    #[test]
    fn a_base_is_as_dark_as_mitsubas() {
        let index = 1.49 / 1.000_277;
        for (facets, alpha, linear, changed) in [
            (Facets::Ggx, 0.05, 0.8774, 0.5278),
            (Facets::Ggx, 0.3, 0.6287, 0.4672),
            (Facets::Ggx, 0.8, 0.3369, 0.3070),
            (Facets::Beckmann, 0.1, 0.8869, 0.5294),
            (Facets::Beckmann, 0.5, 0.6810, 0.4917),
        ] {
            let boundary = RoughBoundary::new(facets, alpha, index);
            let of = |inside: f32| boundary.passed * boundary.passed / (index * index * (1.0 - inside));
            for (ours, theirs) in
                [(of(boundary.reflected_inside), linear), (of(0.5 * boundary.reflected_inside), changed)]
            {
                assert!((ours / theirs - 1.0).abs() < 0.01, "{facets:?} {alpha}: {ours}, not {theirs}");
            }
        }
    }
}
