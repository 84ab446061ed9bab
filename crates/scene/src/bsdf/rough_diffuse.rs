//! Rough diffuse surfaces such as clay or the moon, whose microfacets are diffuse themselves. They are brighter than
//! Lambert's law when seen from the direction of the light, and towards grazing. Multiple scattering between
//! microfacets comes out in the end, so that white loses nothing. [Portsmouth 2025]

use super::nodes::{GAUSS, NODES};
use bilux_math::{Rgb, Vec3};
use std::f32::consts::{FRAC_1_PI, PI};

/// The scattering of a rough base, relative to a Lambertian one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughDiffuse {
    roughness: f32,
    /// The weight of single scattering: A of [Portsmouth 2025].
    once: f32,
    /// The multiple-scattering colour, divided by the two fractions that single scattering loses.
    again: Rgb,
}

impl RoughDiffuse {
    /// From a roughness, 0..=1, the colour of the microfacets, and the light that reaches them
    /// ([`light_at_nodes`](super::nodes::light_at_nodes)).
    pub(super) fn new(roughness: f32, colour: Rgb, light: &[f32; NODES]) -> RoughDiffuse {
        let once = 1.0 / (1.0 + roughness * (0.5 - 2.0 * FRAC_1_PI / 3.0));
        let unscaled = RoughDiffuse { roughness, once, again: Rgb::WHITE };
        // The light that reaches the microfacets, and the part of it that is scattered again.
        let (mut all, mut left) = (0.0, 0.0);
        for ((t, _), here) in GAUSS.into_iter().zip(light) {
            all += here;
            left += here * unscaled.left(t * t);
        }
        let mean = once * (1.0 + roughness * (2.0 / 3.0 - 28.0 / (15.0 * PI)));
        // Each further bounce multiplies the light by the microfacets' colour.
        let tinted = colour.map(|c| c * mean / (1.0 - c * (1.0 - mean)));
        RoughDiffuse { again: tinted * (all / left.max(f32::MIN_POSITIVE)), ..unscaled }
    }

    /// The fraction of light along a direction that single scattering loses.
    #[inline]
    fn left(&self, cos: f32) -> f32 {
        // The gain from shadowing and from microfacets that face the viewer. The closed form contains arc cosines; this
        // fit is within 6e-4 of it.
        let x = 1.0 - cos;
        let gained = x * (0.057_108_53 + x * (0.491_881_86 + x * (-0.332_181_44 + x * 0.071_442_99)));
        (1.0 - self.once * (1.0 + self.roughness * gained)).max(0.0)
    }

    /// The ratio to Lambert's law, for two directions on one side.
    #[inline]
    pub(super) fn over_lambert(&self, wo: Vec3, wi: Vec3) -> Rgb {
        let (o, i) = (wo.z.abs(), wi.z.abs());
        // How much closer together the directions are than on average.
        let near = wo.x * wi.x + wo.y * wi.y;
        let stretched = if near > 0.0 { near / o.max(i) } else { near };
        let single = self.once * (1.0 + self.roughness * stretched);
        self.again * (self.left(o) * self.left(i)) + Rgb::grey(single.max(0.0))
    }

    /// The probability of uniform sampling, as cosine sampling draws too few directions near the horizon of a grazing
    /// `wo`.
    #[inline]
    pub(super) fn uniform_probability(&self, wo: Vec3) -> f32 {
        let grazing = 1.0 - wo.z.abs().min(1.0);
        0.4 * self.roughness * grazing * grazing
    }
}

#[cfg(test)]
mod tests {
    use super::super::nodes::light_at_nodes;
    use super::*;
    use bilux_math::transcendental::{acos, sin_cos};

    /// The published model, with its arc cosines. [Portsmouth 2025]
    fn expected(roughness: f32, colour: f32, wo: Vec3, wi: Vec3) -> f32 {
        let once = 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * PI)) * roughness);
        let s = wo.dot(wi) - wo.z * wi.z;
        let t = if s > 0.0 { wo.z.max(wi.z) } else { 1.0 };
        let albedo = |cos: f32| {
            let (angle, sin) = (acos(cos), (1.0 - cos * cos).sqrt());
            let g = sin * (angle - sin * cos) + 2.0 / 3.0 * (sin / cos * (1.0 - sin * sin * sin) - sin);
            once * (1.0 + roughness * g / PI)
        };
        let mean = once * (1.0 + (2.0 / 3.0 - 28.0 / (15.0 * PI)) * roughness);
        let again = colour * colour * mean / (1.0 - colour * (1.0 - mean));
        let left = (1.0 - albedo(wo.z)) * (1.0 - albedo(wi.z)) / (1.0 - mean);
        (colour * once * (1.0 + roughness * s / t) + again * left) / PI
    }

    #[test]
    fn it_matches_the_published_model() {
        for (roughness, colour) in [(0.3f32, 0.9f32), (1.0, 0.5)] {
            let bsdf = RoughDiffuse::new(roughness, Rgb::grey(colour), &light_at_nodes(&[1.0; NODES]));
            for (o, i, turn) in [(0.2f32, 0.9f32, 0.0f32), (0.7, 0.6, 2.8), (0.3, 0.2, 0.4), (1.0, 0.5, 0.0)]
            {
                let (sin, cos) = sin_cos(turn);
                let wo = Vec3::new((1.0 - o * o).sqrt(), 0.0, o);
                let wi = Vec3::new((1.0 - i * i).sqrt() * cos, (1.0 - i * i).sqrt() * sin, i);
                let found = bsdf.over_lambert(wo, wi).g * colour * FRAC_1_PI;
                let expected = expected(roughness, colour, wo, wi);
                assert!(
                    (found / expected - 1.0).abs() < 5e-3,
                    "{roughness}, {wo}, {wi}: {found}, {expected}"
                );
            }
        }
    }

    /// White microfacets without a coating scatter all light; and the lost part is what the mean of single scattering
    /// lacks.
    #[test]
    fn nothing_is_lost() {
        for roughness in [0.2f32, 0.6, 1.0] {
            let bsdf = RoughDiffuse::new(roughness, Rgb::WHITE, &light_at_nodes(&[1.0; NODES]));
            for cos in [0.05f32, 0.3, 0.7, 1.0] {
                let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
                const N: u32 = 300;
                let middle = |i: u32| (i as f32 + 0.5) / N as f32;
                let mut all = 0.0;
                for (i, k) in (0..N).flat_map(|i| (0..N).map(move |k| (i, k))) {
                    // Squared cosines, as much is visible near the horizon.
                    let (t, (sin_turn, cos_turn)) = (middle(i), sin_cos(PI * middle(k)));
                    let (z, sin) = (t * t, (1.0 - t * t * t * t).sqrt());
                    let wi = Vec3::new(sin * cos_turn, sin * sin_turn, z);
                    all += f64::from(bsdf.over_lambert(wo, wi).g * z * 4.0 * t) / f64::from(N * N);
                }
                assert!((all - 1.0).abs() < 2e-3, "{roughness}, {cos}: {all}");
            }
        }
    }
}
