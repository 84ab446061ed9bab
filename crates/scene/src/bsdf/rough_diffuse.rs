//! Roughness of what scatters diffusely, such as clay or the moon: facets that are matt themselves. Seen from where the
//! light comes they are brighter, and towards grazing than Lambert has it; what they scatter onto each other comes out in
//! the end, so that white loses nothing. [Portsmouth 2025]

use bilux_math::{Rgb, Vec3};
use std::f32::consts::{FRAC_1_PI, PI};

/// How a rough base scatters, over how a matt one would.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughDiffuse {
    roughness: f32,
    /// What a facet scatters at once, over all of it: A of [Portsmouth 2025].
    once: f32,
    /// What comes out after more than once, over the two fractions that once leaves.
    again: Rgb,
}

impl RoughDiffuse {
    /// Of a roughness, 0..=1, and the colour of the facets, where light gets there along a direction as `gets_in` says.
    pub(super) fn new(roughness: f32, colour: Rgb, gets_in: impl Fn(f32) -> f32) -> RoughDiffuse {
        let once = 1.0 / (1.0 + roughness * (0.5 - 2.0 * FRAC_1_PI / 3.0));
        let unscaled = RoughDiffuse { roughness, once, again: Rgb::WHITE };
        // Of what gets there, the part that is scattered again.
        let (mut all, mut left) = (0.0, 0.0);
        for (t, w) in super::coated_diffuse::GAUSS {
            let here = w * 4.0 * t * t * t * gets_in(t * t);
            all += here;
            left += here * unscaled.left(t * t);
        }
        let mean = once * (1.0 + roughness * (2.0 / 3.0 - 28.0 / (15.0 * PI)));
        // Each further time, light takes the facets' colour on.
        let tinted = colour.map(|c| c * mean / (1.0 - c * (1.0 - mean)));
        RoughDiffuse { again: tinted * (all / left.max(f32::MIN_POSITIVE)), ..unscaled }
    }

    /// The part of the light along a direction that one scattering does not send on.
    #[inline]
    fn left(&self, cos: f32) -> f32 {
        // What shadows and facets that face the viewer add to it: the closed form has arcs of cosines in it, and is this
        // within 6e-4.
        let x = 1.0 - cos;
        let gained = x * (0.057_108_53 + x * (0.491_881_86 + x * (-0.332_181_44 + x * 0.071_442_99)));
        (1.0 - self.once * (1.0 + self.roughness * gained)).max(0.0)
    }

    /// What it scatters between two directions on one side, over what Lambert's law has.
    #[inline]
    pub(super) fn over_lambert(&self, wo: Vec3, wi: Vec3) -> Rgb {
        let (o, i) = (wo.z.abs(), wi.z.abs());
        // How much nearer the directions are to each other than they would be on average.
        let near = wo.x * wi.x + wo.y * wi.y;
        let stretched = if near > 0.0 { near / o.max(i) } else { near };
        let single = self.once * (1.0 + self.roughness * stretched);
        self.again * (self.left(o) * self.left(i)) + Rgb::grey(single.max(0.0))
    }

    /// How often a direction is drawn evenly, where a cosine would draw too few that lie near the horizon, as `wo` does.
    #[inline]
    pub(super) fn share_even(&self, wo: Vec3) -> f32 {
        let grazing = 1.0 - wo.z.abs().min(1.0);
        0.4 * self.roughness * grazing * grazing
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::transcendental::{acos, sin_cos};

    /// The model as it is told, with its arcs of cosines. [Portsmouth 2025]
    fn told(roughness: f32, colour: f32, wo: Vec3, wi: Vec3) -> f32 {
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
    fn it_is_the_model_as_told() {
        for (roughness, colour) in [(0.3f32, 0.9f32), (1.0, 0.5)] {
            let grain = RoughDiffuse::new(roughness, Rgb::grey(colour), |_| 1.0);
            for (o, i, turn) in [(0.2f32, 0.9f32, 0.0f32), (0.7, 0.6, 2.8), (0.3, 0.2, 0.4), (1.0, 0.5, 0.0)]
            {
                let (sin, cos) = sin_cos(turn);
                let wo = Vec3::new((1.0 - o * o).sqrt(), 0.0, o);
                let wi = Vec3::new((1.0 - i * i).sqrt() * cos, (1.0 - i * i).sqrt() * sin, i);
                let found = grain.over_lambert(wo, wi).g * colour * FRAC_1_PI;
                let told = told(roughness, colour, wo, wi);
                assert!((found / told - 1.0).abs() < 5e-3, "{roughness}, {wo}, {wi}: {found}, {told}");
            }
        }
    }

    /// White facets, in the open, send all light on; and the part that is left is what the mean of one scattering lacks.
    #[test]
    fn nothing_is_lost() {
        for roughness in [0.2f32, 0.6, 1.0] {
            let grain = RoughDiffuse::new(roughness, Rgb::WHITE, |_| 1.0);
            for cos in [0.05f32, 0.3, 0.7, 1.0] {
                let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
                const N: u32 = 300;
                let middle = |i: u32| (i as f32 + 0.5) / N as f32;
                let mut all = 0.0;
                for (i, k) in (0..N).flat_map(|i| (0..N).map(move |k| (i, k))) {
                    // Cosines by squares, for there is much to be seen near the horizon.
                    let (t, (sin_turn, cos_turn)) = (middle(i), sin_cos(PI * middle(k)));
                    let (z, sin) = (t * t, (1.0 - t * t * t * t).sqrt());
                    let wi = Vec3::new(sin * cos_turn, sin * sin_turn, z);
                    all += f64::from(grain.over_lambert(wo, wi).g * z * 4.0 * t) / f64::from(N * N);
                }
                assert!((all - 1.0).abs() < 2e-3, "{roughness}, {cos}: {all}");
            }
        }
    }
}
