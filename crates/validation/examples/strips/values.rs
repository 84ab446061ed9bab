//! Which values a strip shows: from the lists beside this file, or from the parameter's range.

use bilux_math::registry::{Entry, Parameter, ParameterKind};

/// One line of a list.
struct Line<'a> {
    kind: &'a str,
    parameter: &'a str,
    values: Vec<&'a str>,
    settings: Vec<&'a str>,
}

/// Contents of a strip.
#[derive(Debug, PartialEq)]
pub(crate) struct Shown {
    /// As in scene files; `none` leaves the parameter out.
    pub(crate) values: Vec<String>,
    /// The other parameters, as `key = value`.
    pub(crate) settings: Vec<String>,
    /// The stage, or "" for the usual one.
    pub(crate) stage: String,
}

/// Contents of a parameter's strip, by a list.
pub(crate) fn shown(list: &str, entry: &Entry, parameter: &Parameter) -> Shown {
    let lines = || list.lines().filter(|line| !line.starts_with('#')).filter_map(read);
    let find = |kind: &str, name: &str| lines().find(|line| line.kind == kind && line.parameter == name);
    let line = find(entry.name, parameter.name).or_else(|| find("*", parameter.name));
    let mut settings: Vec<String> = Vec::new();
    let mut stage = "";
    let own = line.as_ref().map(|line| line.settings.clone()).unwrap_or_default();
    let common = find(entry.name, "*").map(|line| line.settings).unwrap_or_default();
    for setting in own.into_iter().chain(common) {
        let key = key(setting);
        let is_set = key == parameter.name || settings.iter().any(|set| self::key(set) == key);
        match setting.strip_prefix('@') {
            Some(name) if stage.is_empty() => stage = name,
            Some(_) => {}
            None if !is_set => settings.push(setting.to_owned()),
            None => {}
        }
    }
    settings.retain(|setting| !setting.ends_with("= none"));
    let listed = line.map(|line| line.values).filter(|values| !values.is_empty());
    let values = listed
        .map_or_else(|| of_range(parameter.kind), |values| values.into_iter().map(str::to_owned).collect());
    Shown { values, settings, stage: stage.to_owned() }
}

fn key(setting: &str) -> &str {
    setting.split('=').next().unwrap_or_default().trim()
}

fn read(line: &str) -> Option<Line<'_>> {
    let (name, rest) = line.split_once(':')?;
    let (kind, parameter) = name.split_once('.')?;
    let mut parts = rest.split(';').map(str::trim);
    let values = parts.next()?.split('|').map(str::trim).filter(|value| !value.is_empty()).collect();
    Some(Line { kind, parameter, values, settings: parts.collect() })
}

/// The lowest, a middle and the highest value of a range, or every word.
fn of_range(kind: ParameterKind) -> Vec<String> {
    let numbers = |min: f64, max: f64| [min, 0.5 * (min + max), max].map(|x| format!("{x}")).to_vec();
    match kind {
        ParameterKind::Bool => ["false", "true"].map(str::to_owned).to_vec(),
        ParameterKind::Integer { min, max } => {
            [min, max.min(min + 3), max.min(min + 9)].map(|i| i.to_string()).to_vec()
        }
        ParameterKind::Number { min, max }
        | ParameterKind::NumberTexture { min, max }
        | ParameterKind::Colour { min, max }
        | ParameterKind::ColourTexture { min, max } => numbers(min, max.min(1e3)),
        ParameterKind::Choice(words) => words.iter().map(|word| format!("\"{word}\"")).collect(),
        _ => vec!["none".to_owned()],
    }
}
