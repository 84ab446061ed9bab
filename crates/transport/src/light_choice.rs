//! Which lights to sample: all if there are few; otherwise one, chosen more often the more light it brings.

use bilux_math::hash::{hash_words, unit_f32};
use bilux_math::{Vec2, Vec3};
use bilux_scene::{Light, Scene};
use std::ops::Range;

/// A probability for every light of a scene.
///
/// Where there are few lights, each is always sampled: a shadow ray costs less than the noise of a choice that ignores
/// position. Otherwise the probability follows the unoccluded light that it brings to the scene's objects, with a tenth
/// distributed uniformly, so that a weak light close by is never neglected.
#[derive(Clone, Debug)]
pub struct LightChoice {
    probabilities: Vec<f32>,
    /// `cdf[i]` is the sum of the probabilities `0..=i`.
    cdf: Vec<f32>,
    few: bool,
}

/// Up to this many lights are all sampled.
const FEW: usize = 4;

const SHARED_ALIKE: f64 = 0.1;

impl LightChoice {
    /// Computes the probabilities of a scene's lights, in their order.
    pub fn new(scene: &Scene) -> LightChoice {
        let places = places(scene);
        LightChoice::weighted(scene.lights().iter().map(|l| irradiance(&*l.light, &places, scene)))
    }

    fn weighted(irradiances: impl Iterator<Item = f32>) -> LightChoice {
        let mut probabilities = weights(irradiances);
        let few = probabilities.iter().filter(|p| **p > 0.0).count() <= FEW;
        if few {
            probabilities.iter_mut().filter(|p| **p > 0.0).for_each(|p| *p = 1.0);
        }
        LightChoice { cdf: sums(&probabilities), probabilities, few }
    }

    /// True when all lights are always sampled, whatever the random number.
    #[inline]
    pub fn takes_all(&self) -> bool {
        self.few
    }

    /// The lights to sample: those of the range whose probability is above 0.
    #[inline]
    pub fn sample(&self, u: f32) -> Range<usize> {
        if self.few {
            return 0..self.cdf.len();
        }
        let wanted = u * self.cdf[self.cdf.len() - 1];
        let index = self.cdf.partition_point(|&sum| sum <= wanted).min(self.cdf.len() - 1);
        index..index + 1
    }

    /// The probability of a light.
    #[inline]
    pub fn probability(&self, light: usize) -> f32 {
        self.probabilities[light]
    }
}

/// Number of points at which lights are compared.
const PLACES: u64 = 64;
/// Number of points to leave out, those where a light is strongest: nothing but its own shade is that close to a light.
const CLOSEST: usize = 8;

/// Vertices of some objects, each object equally likely. Power would be no measure: for infinite lights it grows with
/// the scene's bounds, and so with every empty yard of a floor.
fn places(scene: &Scene) -> Vec<Vec3> {
    let (objects, spheres) = (scene.geometry().objects(), scene.geometry().spheres());
    let count = (objects.len() + spheres.len()) as u64;
    let place = |i: u64| {
        let picked = (hash_words([i, 0]) % count.max(1)) as usize;
        let Some(object) = objects.get(picked) else {
            return spheres.get(picked - objects.len()).map(|s| s.centre);
        };
        let vertex = hash_words([i, 1]) % (object.mesh.positions.len() as u64).max(1);
        let p = *object.mesh.positions.get(vertex as usize)?;
        Some(object.motion.at(scene.shutter()[0]).point(p))
    };
    (0..PLACES).filter_map(place).collect()
}

/// The mean unoccluded irradiance of a light at some points, as luminance; never 0 for a light that emits.
fn irradiance(light: &dyn Light, places: &[Vec3], scene: &Scene) -> f32 {
    let at = |(i, place): (usize, &Vec3)| {
        let number = |k: u64| unit_f32(hash_words([i as u64, k]) as u32);
        let sample = light.sample_li(*place, scene.shutter()[0], Vec2::new(number(2), number(3)))?;
        let irradiance = sample.li.luminance() / sample.pdf_solid_angle;
        irradiance.is_finite().then_some(irradiance)
    };
    let mut found: Vec<f32> = places.iter().enumerate().map(|place| at(place).unwrap_or(0.0)).collect();
    found.sort_by(f32::total_cmp);
    let sum: f32 = found[..found.len().saturating_sub(CLOSEST)].iter().sum();
    let least = if light.power(&scene.bounds()) > 0.0 { f32::MIN_POSITIVE } else { 0.0 };
    sum.max(least)
}

/// Probabilities for lights of these powers.
pub(crate) fn weights(powers: impl Iterator<Item = f32>) -> Vec<f32> {
    let sound = |p: f32| if p.is_finite() && p > 0.0 { f64::from(p) } else { 0.0 };
    let powers: Vec<f64> = powers.map(sound).collect();
    let total: f64 = powers.iter().sum();
    let shining = powers.iter().filter(|p| **p > 0.0).count().max(1) as f64;
    let by_power = |p: &f64| match *p {
        p if p > 0.0 => (p / total * (1.0 - SHARED_ALIKE) + SHARED_ALIKE / shining) as f32,
        _ => 0.0,
    };
    powers.iter().map(by_power).collect()
}

/// Cumulative sums.
pub(crate) fn sums(probabilities: &[f32]) -> Vec<f32> {
    let mut sum = 0.0;
    let add = |p: &f32| {
        sum += p;
        sum
    };
    probabilities.iter().map(add).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_light_is_picked_as_often_as_it_says() {
        let powers = [3.0, 0.0, 1.0, f32::NAN, 80.0, 12.0, 4.0];
        let choice = LightChoice::weighted(powers.into_iter());
        let mut counts = [0; 7];
        for i in 0..100_000 {
            let picked = choice.sample((i as f32 + 0.5) / 100_000.0);
            assert_eq!(picked.len(), 1);
            counts[picked.start] += 1;
        }
        for (light, n) in counts.into_iter().enumerate() {
            let share = n as f32 / 100_000.0;
            assert!((share - choice.probability(light)).abs() < 1e-4, "light {light}: {share}");
        }
        assert!(choice.probability(2) > 0.02 && choice.probability(1) == 0.0);
    }

    #[test]
    fn few_emitting_lights_are_all_sampled() {
        let choice = LightChoice::weighted([1.0, 0.0, 1e9].into_iter());
        assert_eq!(choice.sample(0.5), 0..3);
        assert_eq!([0, 1, 2].map(|light| choice.probability(light)), [1.0, 0.0, 1.0]);
    }

    #[test]
    fn without_emission_no_light_is_sampled() {
        let dark = LightChoice::weighted([0.0].into_iter());
        assert_eq!(dark.probability(0), 0.0);
        assert!(LightChoice::weighted([].into_iter()).sample(0.5).is_empty());
    }
}
