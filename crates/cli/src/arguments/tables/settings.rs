//! The options of settings: what follows from their rows, unless the table of spellings says otherwise.

use super::spelling::spelling;
use super::{OptionTable, TableOption, sentence};
use crate::arguments::help;
use bilux::math::registry::{Parameter, ParameterKind};
use bilux::scene::Value;
use bilux::settings::{Effect, ROWS, SettingRow};
use bilux::tables::values;
use bilux::transport::integrators::{INTEGRATORS, IntegratorEntry};

/// The settings that say what of a scene is shown, and from where: commands that open one have their options.
#[derive(Clone)]
pub struct OfScene;

/// The other settings, and some parameters of integrators, of which `bilux render` has the options.
#[derive(Clone)]
pub struct OfPicture;

/// The parameters of integrators that have an option of their own.
const OF_INTEGRATORS: [&str; 2] = ["specular", "shadow_rule"];

impl OptionTable for OfScene {
    fn options() -> Vec<TableOption> {
        sorted(of_rows().filter(|(row, _)| is_of_scene(row)).map(|(_, option)| option).collect())
    }
}

impl OptionTable for OfPicture {
    const NEXT: usize = 2 * OfScene::NEXT;

    fn options() -> Vec<TableOption> {
        let own = of_rows().filter(|(row, _)| !is_of_scene(row)).map(|(_, option)| option);
        sorted(own.chain(of_integrators()).collect())
    }
}

fn is_of_scene(row: &SettingRow) -> bool {
    row.effect == Effect::Scene || row.parameter.name == "time"
}

/// Headings appear in the help as they first do among the options.
fn sorted(mut options: Vec<TableOption>) -> Vec<TableOption> {
    options.sort_by_key(|option| help::HEADINGS.iter().position(|heading| *heading == option.heading));
    options
}

/// The rows that have an option.
fn of_rows() -> impl Iterator<Item = (&'static SettingRow, TableOption)> {
    ROWS.iter().enumerate().filter_map(|(index, row)| {
        let name = row.option?.trim_start_matches("--").to_owned();
        let plain = Plain { name, heading: heading(row.effect), help: sentence(row.parameter.summary) };
        // Behind the picture that is written.
        Some((row, option(&row.parameter, plain, index + 1)))
    })
}

/// The options of parameters of integrators, each of which says whose they are.
fn of_integrators() -> impl Iterator<Item = TableOption> {
    OF_INTEGRATORS.iter().enumerate().filter_map(|(index, name)| {
        let has = |row: &&IntegratorEntry| row.entry.parameters.iter().any(|own| own.name == *name);
        let owners: Vec<_> = INTEGRATORS.iter().filter(has).map(|row| &row.entry).collect();
        let parameter = owners.first()?.parameters.iter().find(|own| own.name == *name)?;
        let owners: Vec<String> = owners.iter().map(|entry| format!("`{}`", entry.name)).collect();
        let help = format!("{}; for {}", sentence(parameter.summary), owners.join(", "));
        let plain = Plain { name: name.replace('_', "-"), heading: help::LIGHT, help };
        Some(option(parameter, plain, ROWS.len() + index))
    })
}

/// What an option has unless its spelling has something else.
struct Plain {
    name: String,
    heading: &'static str,
    help: String,
}

fn option(parameter: &'static Parameter, plain: Plain, place: usize) -> TableOption {
    let spelling = spelling(parameter.name);
    let help = || format!("{} [default: {}]", plain.help, parameter.default);
    TableOption {
        parameter,
        name: plain.name,
        short: spelling.short,
        value: spelling.value.map_or_else(|| value_name(parameter), str::to_owned),
        missing: spelling.missing,
        heading: spelling.heading.unwrap_or(plain.heading),
        place,
        help: spelling.help.map_or_else(help, str::to_owned),
        read: spelling.read.unwrap_or(read),
    }
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

/// The name of a value.
fn value_name(parameter: &Parameter) -> String {
    let name = match (parameter.kind, parameter.unit) {
        (ParameterKind::Choice(_) | ParameterKind::Bool, _) => {
            return values(parameter.kind).replace(" or ", "|");
        }
        (ParameterKind::Text, _) => "NAME",
        (ParameterKind::Integer { .. }, _) => "N",
        (_, "s") => "SECONDS",
        (_, "m") => "METRES",
        (_, "mm") => "MM",
        _ => "X",
    };
    name.to_owned()
}

/// Reads a value of the row's kind. Whether a word or a text names something is checked with all other settings.
fn read(parameter: &'static Parameter, text: &str) -> Result<(&'static str, Value), String> {
    let (value, what) = match parameter.kind {
        ParameterKind::Bool => (text.parse().ok().map(Value::Bool), ""),
        ParameterKind::Integer { min, max } => {
            let number = text.parse().ok().filter(|number| (min..=max).contains(number));
            (number.map(Value::Integer), "a whole number from ")
        }
        ParameterKind::Number { min, max } => {
            let number = text.parse().ok().filter(|number: &f32| (min..=max).contains(&f64::from(*number)));
            (number.map(Value::from), "a number from ")
        }
        _ => (Some(Value::from(text)), ""),
    };
    let unit = if parameter.unit.is_empty() { String::new() } else { format!(", in {}", parameter.unit) };
    let advice = || format!("write {what}{}{unit}", values(parameter.kind));
    Ok((parameter.name, value.ok_or_else(advice)?))
}
