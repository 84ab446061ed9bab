//! The settings for how the studio photographs a model.

use crate::Error;
use crate::preparation::presets::{Ground, Studio};
use bilux_scene::{Axis, Reader, SceneError, Value};

/// Turns two or three numbers into the text form of an orbit or a point: `[30, 15]` in scene files is `--set orbit=30,15`.
pub(super) fn as_list_text(value: Value) -> Value {
    let Value::List(list) = &value else { return value };
    let number = |value: &Value| match value {
        Value::Integer(i) => Some(i.to_string()),
        Value::Number(x) => Some(x.to_string()),
        _ => None,
    };
    match list.iter().map(number).collect::<Option<Vec<_>>>() {
        Some(numbers) if (2..=3).contains(&numbers.len()) => Value::Text(numbers.join(",")),
        _ => value,
    }
}

/// Studio that the settings ask for.
pub(super) fn studio(reader: &Reader) -> Result<Studio, Error> {
    let orbit = match reader.is_given("orbit") {
        true => {
            let wrong = |text: &str| {
                let message = format!(
                    "'{text}' is not an orbit: write AZ,EL in degrees, such as 30,15, with EL from -90 to 90"
                );
                SceneError::invalid(message, reader.span("orbit"))
            };
            let text = reader.text("orbit");
            Some(parse_orbit(&text).ok_or_else(|| wrong(&text))?)
        }
        false => None,
    };
    let [up, front] = ["up", "front"].map(|key| Axis::from_name(&reader.text(key)));
    if up.zip(front).is_some_and(|(up, front)| up.index() == front.index()) {
        let message =
            "up and front lie on the same axis: choose two different axes, such as up z and front -y";
        return Err(SceneError::invalid(message, reader.span("front")).into());
    }
    Ok(Studio {
        up,
        front,
        ground: Ground::from_name(&reader.text("ground")),
        fog: Some(reader.number("fog")).filter(|visibility| *visibility > 0.0),
        orbit,
        turn: None,
        focal: reader.is_given("focal").then(|| reader.number("focal")),
        aspect: None,
        cut_out: false,
        lit: None,
        brightness: None,
    })
}

/// Parses `AZ,EL` as azimuth and elevation in degrees; returns `None` for anything else.
pub fn parse_orbit(text: &str) -> Option<[f32; 2]> {
    let (azimuth, elevation) = text.split_once(',')?;
    let [azimuth, elevation]: [f32; 2] = [azimuth.trim().parse().ok()?, elevation.trim().parse().ok()?];
    (azimuth.abs() <= 3600.0 && elevation.abs() <= 90.0).then_some([azimuth, elevation])
}

#[cfg(test)]
mod tests {
    use crate::settings::Settings;
    use bilux_scene::{Parameters, Value};

    #[test]
    fn an_orbit_is_a_pair_however_it_is_written() {
        let orbit = |value: Value| {
            let mut parameters = Parameters::default();
            parameters.set("orbit", value);
            Settings::resolve(&parameters).map(|settings| settings.studio.orbit)
        };
        let list = |of: &[f64]| Value::List(of.iter().map(|x| Value::Number(*x)).collect());
        assert_eq!(orbit(Value::Text("30, 15".to_owned())).unwrap(), Some([30.0, 15.0]));
        assert_eq!(orbit(list(&[30.0, 15.0])).unwrap(), Some([30.0, 15.0]));
        assert_eq!(
            orbit(Value::List(vec![Value::Integer(-30), Value::Number(7.5)])).unwrap(),
            Some([-30.0, 7.5])
        );
        assert!(orbit(list(&[30.0, 15.0, 2.0])).is_err());
        assert!(orbit(list(&[30.0, 95.0])).is_err());
        // A pair is not a size.
        let mut parameters = Parameters::default();
        parameters.set("size", list(&[30.0, 15.0]));
        assert!(Settings::resolve(&parameters).is_err());
    }
}
