//! Settings that have no effect.

use super::{RENDER, Settings};
use bilux_math::registry::Entry;
use bilux_scene::{Parameters, Span, Warning};
use bilux_transport::integrators::INTEGRATORS;

impl Settings {
    /// Warns about settings by the user that belong to other integrators than the one that renders. Scene files may
    /// contain settings for several integrators.
    pub(crate) fn unused_settings(&self, user: &Parameters) -> Vec<Warning> {
        let has = |entry: &Entry, key: &str| entry.parameters.iter().any(|p| p.name == key);
        let chosen = &self.integrator.entry;
        let is_idle = |key: &str| !has(&RENDER, key) && !has(chosen, key);
        let others = |key: &str| {
            let others = INTEGRATORS.iter().map(|row| &row.entry).filter(|entry| has(entry, key));
            others.map(|entry| format!("'{}'", entry.name)).collect::<Vec<_>>().join(", ")
        };
        let warn = |key: &str, at: &Span| {
            let message = format!(
                "'{key}' has no effect here: it is a setting of {}, but the integrator is '{}'",
                others(key),
                chosen.name
            );
            Warning { message, at: at.clone() }
        };
        user.0.iter().filter(|(key, ..)| is_idle(key)).map(|(key, _, at)| warn(key, at)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::Settings;
    use bilux_scene::{Parameters, Value};

    #[test]
    fn settings_of_other_integrators_are_reported() {
        let mut user = Parameters::default();
        user.set("integrator", Value::Text("path".to_owned()));
        user.set("roulette_depth", Value::Integer(3));
        assert!(Settings::resolve(&user).unwrap().unused_settings(&user).is_empty());
        user.set("techniques", Value::Text("vcm".to_owned()));
        let reported = Settings::resolve(&user).unwrap().unused_settings(&user);
        assert_eq!(reported.len(), 1);
        assert!(
            reported[0].message.contains("'techniques'") && reported[0].message.contains("'auto'"),
            "{}",
            reported[0]
        );
    }
}
