//! Which settings change no sample of a picture.

use super::{Background, Settings};

impl Settings {
    /// True if a picture with these settings has the samples of one with the others, as far as both take them: they
    /// differ in nothing but the number of samples, the number of threads, and how the picture is shown.
    pub fn takes_samples_of(&self, other: &Settings) -> bool {
        // A setting that is added counts, until it is named here.
        let plain = |settings: &Settings| {
            let background = match settings.background {
                Background::Colour(_) => Background::Transparent,
                other => other,
            };
            let plain = Settings {
                spp: 0,
                threads: 0,
                fps: 0.0,
                exposure: 0.0,
                states_exposure: false,
                own_light: None,
                auto_exposure: false,
                tonemap: String::new(),
                denoise: String::new(),
                linear_transfer: false,
                camera_at: Default::default(),
                background,
                given: Default::default(),
                ..settings.clone()
            };
            format!("{plain:?}")
        };
        plain(self) == plain(other)
    }
}

#[cfg(test)]
mod tests {
    use super::Settings;
    use bilux_scene::{Parameters, Value};

    #[test]
    fn only_settings_of_the_display_keep_the_samples() {
        let with = |key: &str, value: &str| {
            let mut all = Parameters::default();
            all.set("size", "32x32");
            all.set("integrator", "path");
            let value = match key {
                "spp" | "threads" | "seed" | "roulette_depth" => Value::Integer(value.parse().unwrap()),
                "exposure" | "time" => Value::Number(value.parse().unwrap()),
                _ => Value::from(value),
            };
            if !key.is_empty() {
                all.set(key, value);
            }
            Settings::resolve(&all).unwrap()
        };
        let plain = with("", "");
        for (key, value) in [
            ("exposure", "1.5"),
            ("tonemap", "aces"),
            ("denoise", "off"),
            ("transfer", "linear"),
            ("threads", "1"),
            ("spp", "77"),
        ] {
            assert!(plain.takes_samples_of(&with(key, value)), "{key}");
        }
        for (key, value) in [
            ("size", "33x32"),
            ("seed", "1"),
            ("camera", "1"),
            ("time", "0.5"),
            ("filter", "gaussian"),
            ("background", "transparent"),
            ("roulette_depth", "3"),
            ("integrator", "bdpt"),
            ("orbit", "10,20"),
            ("eye", "0,1,4"),
        ] {
            assert!(!plain.takes_samples_of(&with(key, value)), "{key}");
        }
        assert!(with("background", "white").takes_samples_of(&with("background", "#102030")));
    }
}
