//! The tree that pays off for a picture.

use super::Settings;
use bilux_accel::registry::Quality;
use bilux_scene::AccelChoice;

/// The number of samples per triangle from which the best tree is built. In interiors it pays off from about four, so
/// at this number several times over; where it saves nothing, it costs a fiftieth of the time of the rays here.
const MIN_SAMPLES_FOR_BEST_TREE: u64 = 64;

/// Roughly the number of samples that there is time for, if time ends the picture.
const SAMPLES_A_SECOND: u64 = 1_000_000;

impl Settings {
    /// The acceleration structure for a scene of so many triangles.
    pub(crate) fn accel_for(&self, triangles: usize) -> AccelChoice {
        let mut accel = self.accel.clone();
        let in_time =
            self.stop.time_limit.map_or(u64::MAX, |limit| limit.as_secs_f64() as u64 * SAMPLES_A_SECOND);
        let samples = (u64::from(self.width) * u64::from(self.height) * u64::from(self.spp)).min(in_time);
        let is_wide = matches!(accel.name.as_str(), "auto" | "bvh8");
        if self.build_by_size && is_wide && samples / MIN_SAMPLES_FOR_BEST_TREE >= triangles as u64 {
            accel.options.quality = Quality::Best;
        }
        accel
    }
}

#[cfg(test)]
mod tests {
    use super::{Quality, Settings};
    use bilux_scene::{Parameters, Value};

    #[test]
    fn many_samples_are_worth_the_best_tree_unless_another_is_asked_for() {
        let quality = |pairs: &[(&str, &str)], triangles: usize| {
            let mut parameters = Parameters::default();
            parameters.set("size", Value::Text("100x64".to_owned()));
            parameters.set("spp", Value::Integer(10));
            pairs.iter().for_each(|(key, value)| parameters.set(key, Value::Text((*value).to_owned())));
            Settings::resolve(&parameters).unwrap().accel_for(triangles).options.quality
        };
        assert_eq!(quality(&[], 1000), Quality::Best);
        assert_eq!(quality(&[], 1001), Quality::Balanced);
        assert_eq!(quality(&[("build", "fast")], 10), Quality::Fast);
        assert_eq!(quality(&[("build", "balanced")], 10), Quality::Balanced);
        assert_eq!(quality(&[("build", "best")], 1001), Quality::Best);
        assert_eq!(quality(&[("accel", "bsp-sah")], 10), Quality::Balanced);
    }
}
