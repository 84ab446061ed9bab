//! Metadata of a picture: the version that made it, the fingerprint of its scene and settings, the settings that make it again,
//! and its view. Nothing that differs from one run to the next: no date, no time, no threads.

pub use crate::output::metadata::{FINGERPRINT, SETTINGS, SOFTWARE, is_handed_on};
use crate::settings::{Effect, RENDER, Settings};
use bilux_math::Mat4;
use bilux_scene::{Parameters, Value};

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
    let set = all.0.iter().filter(|(key, ..)| changes_picture(key));
    set.map(|(key, value, _)| format!("--set {}", quoted(&format!("{key}={}", text(value)))))
        .collect::<Vec<_>>()
        .join(" ")
}

/// True if a picture with a fixed number of samples depends on this setting, or on this parameter of an integrator.
fn changes_picture(key: &str) -> bool {
    match Effect::of(key) {
        Some(Effect::Count) => key == "spp",
        Some(Effect::Frames | Effect::Work | Effect::Building) => false,
        Some(Effect::Samples | Effect::Scene | Effect::Display) | None => true,
    }
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
