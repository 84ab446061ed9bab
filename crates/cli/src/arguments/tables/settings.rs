//! The options of settings: what follows from their rows, unless the table of spellings says otherwise.

use super::spelling::spelled;
use super::{Assigned, OptionTable, sentence};
use crate::arguments::help;
use bilux::math::registry::{Parameter, ParameterKind};
use bilux::scene::Value;
use bilux::settings::{Effect, ROWS, SettingRow};
use bilux::tables::values;
use bilux::transport::integrators::{INTEGRATORS, IntegratorEntry};
use clap::Arg;

/// The settings that say what of a scene is shown, and from where: commands that open one have their options.
#[derive(Clone)]
pub struct OfScene;

/// The other settings, and some parameters of integrators, of which `bilux render` has the options.
pub struct OfPicture;

/// The parameters of integrators that have an option of their own.
const OF_INTEGRATORS: [&str; 2] = ["specular", "shadow_rule"];

impl OptionTable for OfScene {
    fn options() -> Vec<Arg> {
        of_rows(is_of_scene).collect()
    }
}

impl OptionTable for OfPicture {
    const NEXT: usize = 2 * OfScene::NEXT;

    fn options() -> Vec<Arg> {
        of_rows(|row| !is_of_scene(row)).chain(of_integrators()).collect()
    }
}

fn is_of_scene(row: &SettingRow) -> bool {
    row.effect == Effect::Scene || row.parameter.name == "time"
}

/// The options of some of the rows.
fn of_rows(has: fn(&SettingRow) -> bool) -> impl Iterator<Item = Arg> {
    // Behind the picture that is written.
    let rows = (1..).zip(ROWS).filter(move |(_, row)| has(row));
    rows.filter_map(|(place, row)| {
        let about = sentence(row.parameter.summary);
        let option = option(&row.parameter, row.option?.trim_start_matches("--"), about);
        Some(spelled(option.help_heading(heading(row.effect)).display_order(place)))
    })
}

/// The options of parameters of integrators, each of which says whose they are.
fn of_integrators() -> impl Iterator<Item = Arg> {
    (ROWS.len() + 1..).zip(OF_INTEGRATORS).filter_map(|(place, name)| {
        let has = |row: &&IntegratorEntry| row.entry.parameters.iter().any(|own| own.name == name);
        let owners: Vec<_> = INTEGRATORS.iter().filter(has).map(|row| &row.entry).collect();
        let parameter = owners.first()?.parameters.iter().find(|own| own.name == name)?;
        let owners: Vec<String> = owners.iter().map(|entry| format!("`{}`", entry.name)).collect();
        let about = format!("{}; for {}", sentence(parameter.summary), owners.join(", "));
        let option = option(parameter, &name.replace('_', "-"), about);
        Some(option.help_heading(help::LIGHT).display_order(place))
    })
}

fn option(parameter: &'static Parameter, name: &str, about: String) -> Arg {
    let (value, takes_hyphens) = match (parameter.kind, unit(parameter)) {
        (ParameterKind::Bool, _) => ("true|false".to_owned(), false),
        (ParameterKind::Choice(words), _) => {
            (words.join("|"), words.iter().any(|word| word.starts_with('-')))
        }
        // The name of something: what begins with a hyphen is the next option.
        (ParameterKind::Text, _) => ("NAME".to_owned(), false),
        (ParameterKind::Integer { .. }, _) => ("N".to_owned(), true),
        (_, "") => ("X".to_owned(), true),
        (_, unit) => (unit.to_uppercase(), true),
    };
    Arg::new(parameter.name)
        .long(name.to_owned())
        .value_name(value)
        .allow_hyphen_values(takes_hyphens)
        .value_parser(move |text: &str| read(parameter, text))
        .help(format!("{about} [default: {}]", parameter.default))
}

/// The heading of a setting's option.
fn heading(effect: Effect) -> &'static str {
    match effect {
        Effect::Count => help::COMMON_OPTIONS,
        Effect::Frames => help::WHAT,
        Effect::Scene => help::STUDIO,
        Effect::Samples | Effect::Display => help::PICTURE,
        Effect::Work | Effect::Building => help::SPEED,
    }
}

/// Reads a value of the row's kind. Whether a word or a text names something is checked with all other settings.
fn read(parameter: &'static Parameter, text: &str) -> Result<Assigned, String> {
    let (value, number) = match parameter.kind {
        ParameterKind::Bool => (text.parse().ok().map(Value::Bool), ""),
        ParameterKind::Integer { min, max } => {
            let number = text.parse().ok().filter(|number| (min..=max).contains(number));
            (number.map(Value::Integer), "a whole number")
        }
        ParameterKind::Number { min, max } => {
            let number = text.parse().ok().filter(|number: &f32| (min..=max).contains(&f64::from(*number)));
            (number.map(Value::from), "a number")
        }
        _ => (Some(Value::from(text)), ""),
    };
    let values = values(parameter.kind);
    let advice = || match (number, unit(parameter)) {
        ("", _) => format!("write {values}"),
        (_, "") => format!("write {number} from {values}"),
        (_, unit) => format!("write {number} of {unit} from {values}"),
    };
    Ok((parameter.name, value.ok_or_else(advice)?))
}

/// The unit of a number as a word.
fn unit(parameter: &Parameter) -> &'static str {
    match parameter.unit {
        "s" => "seconds",
        "m" => "metres",
        unit => unit,
    }
}
