//! When a picture ends of which nobody says when.

use bilux_scene::{Parameters, Value};
use bilux_transport::integrators::INTEGRATORS;
use std::time::Duration;

/// What ends a picture of which nobody says when: so little noise, as a part of the light, or so many seconds.
pub const DEFAULT_BUDGET: (f32, f32) = (0.02, 5.0);

/// Adds [`DEFAULT_BUDGET`] to what a user says, and tells so, where neither the user nor the scene says samples, noise or time,
/// and the integrator leaves anything to chance. Such a picture is not the same on every machine.
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

/// What is left of a time limit for rendering, where other things take so much of it: at least half.
pub(crate) fn left_for_light(limit: Duration, others: Duration) -> Duration {
    limit.saturating_sub(others).max(limit / 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_time_is_for_light_whatever_else_takes() {
        let [limit, short, long] = [5.0, 0.5, 9.0].map(Duration::from_secs_f32);
        assert_eq!(left_for_light(limit, short), Duration::from_secs_f32(4.5));
        assert_eq!(left_for_light(limit, long), Duration::from_secs_f32(2.5));
    }

    #[test]
    fn who_says_nothing_gets_a_budget_and_who_says_anything_does_not() {
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
        // The user's word goes before the scene's.
        assert!(budget(&[("integrator", "whitted".into())], &[("integrator", "path".into())]));
    }
}
