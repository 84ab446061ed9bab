//! Picking one of many lights, more often where there is more to come.

use bilux_scene::Scene;

/// A probability for every light of a scene: by its power, with a tenth shared out alike, so that a weak light
/// close by is never forgotten.
#[derive(Clone, Debug)]
pub struct LightChoice {
    probabilities: Vec<f32>,
    /// `cdf[i]` is the sum of the probabilities `0..=i`.
    cdf: Vec<f32>,
}

const SHARED_ALIKE: f64 = 0.1;

impl LightChoice {
    /// For the lights of a scene, in their order.
    pub fn new(scene: &Scene) -> LightChoice {
        let bounds = scene.bounds();
        LightChoice::from_powers(scene.lights().iter().map(|l| l.light.power(&bounds)))
    }

    fn from_powers(powers: impl Iterator<Item = f32>) -> LightChoice {
        let sound = |p: f32| if p.is_finite() && p > 0.0 { f64::from(p) } else { 0.0 };
        let powers: Vec<f64> = powers.map(sound).collect();
        let total: f64 = powers.iter().sum();
        let shining = powers.iter().filter(|p| **p > 0.0).count().max(1) as f64;
        let probability = |p: &f64| match *p {
            p if p > 0.0 => (p / total * (1.0 - SHARED_ALIKE) + SHARED_ALIKE / shining) as f32,
            _ => 0.0,
        };
        let probabilities: Vec<f32> = powers.iter().map(probability).collect();
        let mut sum = 0.0;
        let mut cdf: Vec<f32> = Vec::with_capacity(probabilities.len());
        for p in &probabilities {
            sum += p;
            cdf.push(sum);
        }
        LightChoice { probabilities, cdf }
    }

    /// A light and its probability; `None` where none shines.
    #[inline]
    pub fn sample(&self, u: f32) -> Option<(usize, f32)> {
        let wanted = u * self.cdf.last()?;
        let index = self.cdf.partition_point(|&sum| sum <= wanted).min(self.cdf.len() - 1);
        let probability = self.probabilities[index];
        (probability > 0.0).then_some((index, probability))
    }

    /// The probability of a light.
    #[inline]
    pub fn probability(&self, light: usize) -> f32 {
        self.probabilities[light]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_light_is_picked_as_often_as_it_says() {
        let choice = LightChoice::from_powers([3.0, 0.0, 1.0, f32::NAN, 96.0].into_iter());
        let mut counts = [0; 5];
        for i in 0..100_000 {
            let (light, probability) = choice.sample((i as f32 + 0.5) / 100_000.0).unwrap();
            assert_eq!(probability, choice.probability(light));
            counts[light] += 1;
        }
        for (light, n) in counts.into_iter().enumerate() {
            let share = n as f32 / 100_000.0;
            assert!((share - choice.probability(light)).abs() < 1e-4, "light {light}: {share}");
        }
        assert!(choice.probability(2) > 0.03 && choice.probability(1) == 0.0);
    }

    #[test]
    fn where_nothing_shines_nothing_is_picked() {
        assert_eq!(LightChoice::from_powers([0.0].into_iter()).sample(0.5), None);
        assert_eq!(LightChoice::from_powers([].into_iter()).sample(0.5), None);
    }
}
