//! Which settings change no sample of a picture.

use super::Settings;

impl Settings {
    /// Settings with the samples of others: of these, they have whatever changes no sample ([`super::Effect`]).
    pub(crate) fn with_samples_of(&self, other: &Settings) -> Settings {
        // A setting that is added counts, until it is named here.
        Settings {
            spp: self.spp,
            stop: self.stop,
            threads: self.threads,
            fps: self.fps,
            exposure: self.exposure,
            states_exposure: self.states_exposure,
            auto_exposure: self.auto_exposure,
            tonemap: self.tonemap.clone(),
            denoise: self.denoise.clone(),
            linear_transfer: self.linear_transfer,
            // The studio knows whether there is one at all.
            background: self.background,
            given: self.given.clone(),
            ..other.clone()
        }
    }

    /// True if a picture with these settings has the samples of one with the others, as far as both take them: they
    /// differ in nothing but the number of samples, the number of threads, and how the picture is shown.
    pub fn takes_samples_of(&self, other: &Settings) -> bool {
        let plain = |settings: Settings| {
            let plain = Settings { own_light: None, camera_at: Default::default(), ..settings };
            format!("{plain:?}")
        };
        plain(self.clone()) == plain(self.with_samples_of(other))
    }
}

#[cfg(test)]
mod tests {
    use super::Settings;
    use bilux_scene::{Parameters, Value};

    /// Single settings are tested by their rows, in `tests/suite/fingerprint.rs`.
    #[test]
    fn backgrounds_that_are_cut_out_and_no_parameter_of_an_integrator_keep_the_samples() {
        let with = |key: &str, value: Value| {
            let mut all = Parameters::default();
            all.set("integrator", "path");
            all.set(key, value);
            Settings::resolve(&all).unwrap()
        };
        let behind = |colour: &str| with("background", colour.into());
        let [white, blue] = ["white", "#102030"].map(behind);
        assert!(white.takes_samples_of(&blue) && white.takes_samples_of(&behind("transparent")));
        assert!(!white.takes_samples_of(&behind("surroundings")));
        let [three, four] = [3, 4].map(|depth| with("roulette_depth", Value::Integer(depth)));
        assert!(three.takes_samples_of(&three) && !three.takes_samples_of(&four));
    }
}
