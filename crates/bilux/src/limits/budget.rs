//! When a render stops if nobody sets a limit.

use bilux_scene::{Parameters, Value};
use bilux_transport::integrators::INTEGRATORS;
use std::time::Duration;

/// The default limits of a render: a noise level, as a fraction of the light, and a time in seconds, whichever comes
/// first.
pub const DEFAULT_BUDGET: (f32, f32) = (0.02, 5.0);

/// Adds [`DEFAULT_BUDGET`] to the user's settings if neither the user nor the scene sets samples, noise or time and the
/// integrator is not one of the classic ones. Returns true if it did. Such a picture is not the same on every machine.
///
/// The classic modes take their own number of samples instead: `cook`, which is random, 64 of them, and the others few.
/// They are compared with pictures of their time, and so have to be the same on every machine.
pub fn with_default_budget(scene: &Parameters, user: &mut Parameters) -> bool {
    let said = |key: &str| user.find(key).or_else(|| scene.find(key)).map(|(value, _)| value);
    let is_nothing = |value: &Value| matches!(value, Value::Integer(0) | Value::Number(0.0));
    let any_end = ["spp", "noise", "time_limit"].into_iter().filter_map(said).any(|value| !is_nothing(value));
    let name = match said("integrator") {
        Some(Value::Text(name)) => name.as_str(),
        _ => "auto",
    };
    let counts = INTEGRATORS.iter().any(|row| row.entry.name == name && row.classic);
    if any_end || counts {
        return false;
    }
    let (noise, seconds) = DEFAULT_BUDGET;
    user.set("noise", noise);
    user.set("time_limit", seconds);
    true
}

/// Lets the user's limit of noise or time end the render: otherwise a number of samples that the scene sets could end it
/// before.
pub fn let_limits_decide(user: &mut Parameters) {
    let limit = ["noise", "time_limit"].into_iter().find_map(|key| user.find(key));
    if let (None, Some((_, at))) = (user.find("spp"), limit) {
        let at = at.clone();
        user.set_at("spp", Value::Integer(0), at);
    }
}

/// The time limit of a fast picture, in seconds.
pub const FAST_SECONDS: f32 = 1.0;

/// The maximum number of scattering events after the camera in a fast picture: a thumbnail does not show later ones.
const FAST_DEPTH: i64 = 8;

/// Sets what gives the cleanest picture in about [`FAST_SECONDS`]: plain path tracing without a pilot pass, few
/// scattering events, and a tree that is quick to build. It never overrides a setting of the user's, nor the integrator
/// of a scene that asks for a classic one.
pub fn with_fast_budget(scene: &Parameters, user: &mut Parameters) {
    let mut unless_said = |key: &str, value: Value| {
        if user.find(key).is_none() {
            user.set(key, value);
        }
    };
    unless_said("time_limit", FAST_SECONDS.into());
    unless_said("noise", Value::Integer(0));
    unless_said("spp", Value::Integer(0));
    unless_said("max_depth", Value::Integer(FAST_DEPTH));
    unless_said("build", "fast".into());
    let scenes = scene.find("integrator").map(|(value, _)| value);
    let is_classic = |value: &Value| matches!(value, Value::Text(name) if INTEGRATORS.iter().any(|row| row.entry.name == name && row.classic));
    if !scenes.is_some_and(is_classic) {
        unless_said("integrator", "path".into());
    }
}

/// Rendering gets at least one part in this many of a time limit, however long reading takes.
const LEAST_PART: u32 = 5;

/// Returns the part of a time limit that is left for rendering when other work takes `others`.
pub(crate) fn time_for_rendering(limit: Duration, others: Duration) -> Duration {
    limit.saturating_sub(others).max(limit / LEAST_PART)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_work_reduces_the_time_for_rendering() {
        let [limit, short, long] = [5.0, 0.5, 9.0].map(Duration::from_secs_f32);
        assert_eq!(time_for_rendering(limit, short), Duration::from_secs_f32(4.5));
        assert_eq!(time_for_rendering(limit, long), Duration::from_secs_f32(1.0));
    }

    #[test]
    fn a_fast_picture_keeps_user_settings_and_classic_integrators() {
        let mut user = Parameters::default();
        user.set("max_depth", Value::Integer(3));
        with_fast_budget(&Parameters::default(), &mut user);
        let said = |user: &Parameters, key: &str| user.find(key).map(|(value, _)| value.clone());
        assert_eq!(said(&user, "max_depth"), Some(Value::Integer(3)));
        assert_eq!(said(&user, "integrator"), Some("path".into()));
        assert_eq!(said(&user, "time_limit"), Some(FAST_SECONDS.into()));
        let (mut scene, mut user) = (Parameters::default(), Parameters::default());
        scene.set("integrator", "whitted");
        with_fast_budget(&scene, &mut user);
        assert_eq!(said(&user, "integrator"), None);
    }

    #[test]
    fn limits_of_the_user_take_precedence_over_samples_of_the_scene() {
        let spp = |pairs: &[(&str, Value)]| {
            let mut user = Parameters::default();
            pairs.iter().for_each(|(key, value)| user.set(key, value.clone()));
            let_limits_decide(&mut user);
            user.find("spp").map(|(value, _)| value.clone())
        };
        assert_eq!(spp(&[("noise", Value::Number(0.1))]), Some(Value::Integer(0)));
        assert_eq!(spp(&[("time_limit", Value::Number(2.0))]), Some(Value::Integer(0)));
        assert_eq!(
            spp(&[("noise", Value::Number(0.1)), ("spp", Value::Integer(9))]),
            Some(Value::Integer(9))
        );
        assert_eq!(spp(&[("seed", Value::Integer(1))]), None);
    }

    #[test]
    fn a_budget_is_added_only_when_no_limit_is_set() {
        let budget = |scene: &[(&str, Value)], user: &[(&str, Value)]| {
            let of = |pairs: &[(&str, Value)]| {
                let mut parameters = Parameters::default();
                pairs.iter().for_each(|(key, value)| parameters.set(key, value.clone()));
                parameters
            };
            let mut user = of(user);
            let added = with_default_budget(&of(scene), &mut user);
            assert_eq!(
                added,
                user.find("time_limit").is_some_and(|(value, _)| *value == Value::from(5.0f32))
            );
            added
        };
        assert!(budget(&[], &[]));
        assert!(budget(&[("integrator", "path".into())], &[("seed", Value::Integer(3))]));
        assert!(!budget(&[("spp", Value::Integer(16))], &[]));
        assert!(!budget(&[], &[("spp", Value::Integer(16))]));
        assert!(!budget(&[], &[("noise", Value::Number(0.1))]));
        assert!(!budget(&[("integrator", "whitted".into())], &[]));
        // The user's setting overrides the scene's.
        assert!(budget(&[("integrator", "whitted".into())], &[("integrator", "path".into())]));
    }

    #[test]
    fn every_integrator_ends_with_default_settings() {
        for row in INTEGRATORS {
            let mut user = Parameters::default();
            user.set("integrator", row.entry.name);
            with_default_budget(&Parameters::default(), &mut user);
            let settings = crate::Settings::resolve(&user).unwrap();
            let name = row.entry.name;
            assert!(settings.stop.is_any() != row.classic, "{name}");
            assert!(settings.stop.is_any() || (1..=64).contains(&settings.spp), "{name}");
        }
    }
}
