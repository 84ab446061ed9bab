//! Sensors, laser scanners, and light by the time that it takes.

pub mod lidar;
pub mod sensing;
pub mod transient;

#[cfg(test)]
mod tests {
    use super::{lidar::scanner, sensing::Sensing};
    use bilux_math::registry::{Entry, Parameter, ParameterKind};
    use bilux_pictures::sensor::SENSOR;
    use bilux_scene::{Parameters, Value};
    use bilux_transport::lidar::LIDAR;
    use std::collections::BTreeMap;

    /// Fields by their names, as Debug writes them.
    fn fields(debug: &str) -> BTreeMap<String, String> {
        let (_, inside) = debug.split_once("{ ").unwrap();
        let (mut all, mut last) = (BTreeMap::<String, String>::new(), String::new());
        for part in inside.split(", ") {
            let (name, value) = part.split_once(": ").unwrap_or((&last, part));
            *all.entry(name.to_owned()).or_default() += &format!(" {value}");
            last = name.to_owned();
        }
        all
    }

    /// Another value than the default of a parameter.
    fn another(parameter: &Parameter) -> Value {
        let number: f64 =
            parameter.default.split(' ').next().and_then(|text| text.parse().ok()).unwrap_or(0.0);
        match parameter.kind {
            ParameterKind::Integer { max, .. } if number + 1.0 <= max as f64 => {
                Value::Integer(number as i64 + 1)
            }
            ParameterKind::Integer { .. } => Value::Integer(number as i64 - 1),
            ParameterKind::Number { max, .. } if number + 0.25 <= max => Value::Number(number + 0.25),
            ParameterKind::Number { .. } => Value::Number(0.75 * number),
            ParameterKind::Choice(words) => {
                Value::from(*words.iter().find(|word| **word != parameter.default).unwrap())
            }
            _ => Value::List([0.5, 0.25, 0.75].map(|part| Value::Number(part * number)).to_vec()),
        }
    }

    /// Each parameter of a row that changes other fields than the one of its name, with those that it changes.
    fn astray(row: &Entry, made: impl Fn(&Parameters) -> String) -> Vec<String> {
        let usual = fields(&made(&Parameters::default()));
        let changes = |parameter: &Parameter| {
            let mut given = Parameters::default();
            given.set(parameter.name, another(parameter));
            let found = fields(&made(&given));
            let changed: Vec<_> = found.into_iter().filter(|(name, value)| usual[name] != *value).collect();
            let names: Vec<&str> = changed.iter().map(|(name, _)| name.as_str()).collect();
            (names != [parameter.name]).then(|| format!("{} {}", parameter.name, names.join(" ")))
        };
        row.parameters.iter().filter_map(changes).collect()
    }

    #[test]
    fn every_parameter_changes_the_field_of_its_name_and_no_other() {
        let sensor = |given: &Parameters| format!("{:?}", Sensing::new(given).unwrap().sensor);
        assert_eq!(astray(&SENSOR, sensor), ["output "], "that is none of the sensor");
        let beams = |given: &Parameters| format!("{:?}", scanner(given).unwrap());
        let known = ["min_range range", "max_range range", "returns keep"];
        assert_eq!(astray(&LIDAR, beams), known);
    }
}
