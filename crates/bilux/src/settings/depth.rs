//! Number of scattering events that a path may have.

use bilux_scene::{Parameters, Reader};

/// Scattering events of a path where the user asks for fog and says nothing of them: what is not scattered so often within it is black.
const EVENTS_IN_FOG: u32 = 100;

/// The depth that a user, a scene or a preset gives; otherwise what the scene needs.
pub(super) fn max_depth(all: &Parameters, reader: &Reader) -> u32 {
    let is_said = all.find("max_depth").is_some();
    let said = reader.integer("max_depth") as u32;
    if !is_said && reader.number("fog") > 0.0 { EVENTS_IN_FOG } else { said }
}

#[cfg(test)]
mod tests {
    use crate::Settings;
    use bilux_scene::{Parameters, Value};

    #[test]
    fn fog_that_is_asked_for_has_more_events_unless_they_are_said() {
        let depth = |pairs: &[(&str, Value)]| {
            let mut all = Parameters::default();
            pairs.iter().for_each(|(key, value)| all.set(key, value.clone()));
            Settings::resolve(&all).unwrap().max_depth
        };
        let (fog, none) = (("fog", Value::Number(3.0)), ("fog", Value::Number(0.0)));
        assert_eq!([depth(&[]), depth(&[none]), depth(std::slice::from_ref(&fog))], [16, 16, 100]);
        assert_eq!(depth(&[("max_depth", Value::Integer(7)), fog]), 7);
    }
}
