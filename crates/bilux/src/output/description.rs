//! Metadata of a picture: the version that made it, the fingerprint of its scene and settings, the settings that make it again,
//! and its view. Nothing that differs from one run to the next: no date, no time, no threads.

pub use crate::output::metadata::{FINGERPRINT, SETTINGS, SOFTWARE, is_handed_on};
use crate::settings::{RENDER, Settings};
use bilux_math::Mat4;
use bilux_scene::{Parameters, Value};

/// Settings that change no picture with a fixed number of samples.
const WITHOUT_EFFECT: [&str; 11] = [
    "accel",
    "build",
    "cpu",
    "bsp_split",
    "bsp_group",
    "early_out",
    "cull_by_partition",
    "threads",
    "fps",
    "noise",
    "time_limit",
];

/// A matrix for row vectors, row by row, as OpenEXR stores it.
pub(crate) fn row_vectors(matrix: &Mat4) -> String {
    matrix.to_cols_array().map(|x| (x + 0.0).to_string()).join(" ")
}

/// The options that give these settings, whatever the scene file says.
pub(crate) fn options(settings: &Settings, spp: u32, denoiser: Option<&str>) -> String {
    let mut all = Parameters::default();
    let own = settings.integrator.entry.parameters.iter();
    for parameter in RENDER.parameters.iter().chain(own) {
        if let Some((value, _)) = settings.given.find(parameter.name) {
            all.set(parameter.name, value.clone());
        }
    }
    let size = format!("{}x{}", settings.width, settings.height);
    for (key, value) in [
        ("integrator", Value::from(settings.integrator.entry.name)),
        ("size", Value::from(size)),
        ("spp", Value::Integer(i64::from(spp))),
        ("seed", Value::Integer(settings.seed as i64)),
        ("max_depth", Value::Integer(i64::from(settings.max_depth))),
        ("time", Value::from(settings.time)),
        ("denoise", Value::from(denoiser.unwrap_or("off"))),
    ] {
        all.set(key, value);
    }
    // Whoever gave them in another order gets the same text.
    all.0.sort_by(|(a, ..), (b, ..)| a.cmp(b));
    let is_needed = |key: &str| !WITHOUT_EFFECT.contains(&key);
    let set = all.0.iter().filter(|(key, ..)| is_needed(key));
    set.map(|(key, value, _)| format!("--set {}", quoted(&format!("{key}={}", text(value)))))
        .collect::<Vec<_>>()
        .join(" ")
}

/// A value as `--set` reads it.
fn text(value: &Value) -> String {
    match value {
        Value::Bool(value) => value.to_string(),
        Value::Integer(value) => value.to_string(),
        Value::Number(value) => value.to_string(),
        Value::Text(value) => value.clone(),
        Value::List(values) => values.iter().map(text).collect::<Vec<_>>().join(","),
        // No setting is one.
        Value::Texture(_) | Value::Material(_) | Value::Grid(_) | Value::Distribution(_) => String::new(),
    }
}

/// A word as shells read it.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "=.,:/_-+".contains(c);
    if word.chars().all(is_plain) { word.to_owned() } else { format!("'{}'", word.replace('\'', "'\\''")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_give_the_settings_again() {
        let mut all = Parameters::default();
        for (key, value) in [
            ("integrator", Value::from("path")),
            ("size", Value::from("64x48")),
            ("camera", Value::from("the cook's eye")),
            ("roulette_depth", Value::Integer(3)),
            ("threads", Value::Integer(2)),
            ("noise", Value::Number(0.01)),
            ("eye", Value::List(vec![Value::Integer(1), Value::Number(0.5), Value::Integer(-2)])),
        ] {
            all.set(key, value);
        }
        let settings = Settings::resolve(&all).expect("these settings are right");
        let options = options(&settings, 77, None);
        for part in
            ["integrator=path", "spp=77", "'camera=the cook'\\''s eye'", "eye=1,0.5,-2", "denoise=off"]
        {
            assert!(options.contains(&format!("--set {part}")), "{part} in {options}");
        }
        for part in ["threads", "noise=0.01"] {
            assert!(!options.contains(part), "{part} in {options}");
        }
    }
}
