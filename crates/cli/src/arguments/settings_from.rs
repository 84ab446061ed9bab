//! Turns options and `--set KEY=VALUE` into the same parameters that scene files use.

use crate::arguments::assignments::{assignment_of, from_flag};
use crate::arguments::serving::Serve;
use crate::arguments::studio::StudioArguments;
use crate::arguments::{Explain, Render};
use crate::process::memory;
use bilux::scene::Parameters;

/// The render settings on the command line.
pub fn render(arguments: &Render) -> anyhow::Result<Parameters> {
    let mut parameters = all(&arguments.studio, arguments.settings.0.clone(), &arguments.set)?;
    bilux::budget::let_limits_decide(&mut parameters);
    Ok(parameters)
}

/// The settings on the command line of a viewer.
pub fn serve(arguments: &Serve) -> anyhow::Result<Parameters> {
    all(&arguments.studio, Parameters::default(), &arguments.set)
}

/// The settings on the command line that explains a scene.
pub fn explain(arguments: &Explain) -> anyhow::Result<Parameters> {
    let mut parameters = all(&arguments.studio, Parameters::default(), &arguments.set)?;
    if parameters.find("integrator").is_none() {
        // Whatever the scene file says: it is explained by what this one finds.
        parameters.set("integrator", "auto");
    }
    Ok(parameters)
}

/// The settings that options give, and those of `--set`.
fn all(studio: &StudioArguments, mut parameters: Parameters, set: &[String]) -> anyhow::Result<Parameters> {
    // A picture is no setting.
    let is_setting = |key: &str| key != "background" || studio.picture_behind().is_none();
    let of_scene = studio.settings.0.0.iter().filter(|(key, ..)| is_setting(key));
    parameters.0.extend(of_scene.cloned());
    for assignment in set {
        let (key, value) = assignment_of(assignment)?;
        parameters.set_at(&key, value, from_flag(&format!("--set {key}")));
    }
    memory::set_threads(&mut parameters);
    Ok(parameters)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::{Arguments, Command};
    use bilux::Settings;
    use bilux::math::registry::{Parameter, ParameterKind};
    use bilux::scene::Value;
    use bilux::settings::{Effect, ROWS};
    use clap::{CommandFactory, Parser};

    /// The settings that a command gets from an option.
    fn given(command: &str, option: &str) -> Parameters {
        let output: &[&str] = if command == "render" { &["-o", "a.png"] } else { &[] };
        let line = [&["bilux", command, "a.toml", option], output].concat();
        match Arguments::try_parse_from(line).unwrap_or_else(|error| panic!("{error}")).command {
            Command::Render(arguments) => render(&arguments).unwrap(),
            Command::Serve(arguments) => serve(&arguments).unwrap(),
            Command::Explain(arguments) => explain(&arguments).unwrap(),
            _ => panic!("{command}"),
        }
    }

    /// A value that is no default, as it is written and as it arrives.
    fn example(parameter: &Parameter) -> (String, Value) {
        match parameter.kind {
            ParameterKind::Bool => ("true".to_owned(), Value::Bool(true)),
            ParameterKind::Integer { .. } => ("7".to_owned(), Value::Integer(7)),
            ParameterKind::Number { min, max } => {
                let number = 0.75f32.clamp(min as f32, max as f32);
                (number.to_string(), number.into())
            }
            ParameterKind::Choice(words) => {
                let word = words.iter().rfind(|word| **word != parameter.default).unwrap();
                ((*word).to_owned(), Value::from(*word))
            }
            _ => ("0,1,0.5".to_owned(), "0,1,0.5".into()),
        }
    }

    /// Each option alone gives its own setting and no other, also where options come in pairs.
    #[test]
    fn every_option_of_a_row_gives_its_setting_and_no_other() {
        for (row, option) in ROWS.iter().filter_map(|row| Some((row, row.option?))) {
            let (key, (text, value)) = (row.parameter.name, example(&row.parameter));
            let option = format!("{option}={text}");
            let of_render = given("render", &option);
            let keys: Vec<_> = of_render.0.iter().map(|(key, ..)| &**key).collect();
            // A limit decides, whatever number of samples the scene sets.
            let wanted = if ["noise", "time_limit"].contains(&key) { vec![key, "spp"] } else { vec![key] };
            assert_eq!(keys, wanted, "{option}");
            if row.parameter.kind != ParameterKind::Text {
                Settings::resolve(&of_render).unwrap_or_else(|error| panic!("{option}: {error}"));
            }
            let is_shared = row.effect == Effect::Scene || key == "time";
            for command in ["render", "serve", "explain"].iter().take(if is_shared { 3 } else { 1 }) {
                let given = given(command, &option);
                let (found, at) = given.find(key).unwrap();
                assert_eq!(found, &value, "{option} of {command}");
                assert_eq!(&*at.file, row.option.unwrap(), "{option} of {command}");
            }
        }
    }

    /// Options that give something else than a row's value, and those of integrators' parameters.
    #[test]
    fn words_in_place_of_values_give_what_they_stand_for() {
        for (option, key, value) in [
            ("--exposure=auto", "auto_exposure", Value::Bool(true)),
            ("--denoise", "denoise", "auto".into()),
            ("--noise=4%", "noise", 0.04f32.into()),
            ("--time-limit=3s", "time_limit", 3.0f32.into()),
            ("--specular=reflect", "specular", "reflect".into()),
            ("--shadow-rule=paper", "shadow_rule", "paper".into()),
            ("-ipath", "integrator", "path".into()),
            ("--set=fps=30", "fps", Value::Integer(30)),
        ] {
            let given = given("render", option);
            let (first, found, at) = &given.0[0];
            assert_eq!((&**first, found), (key, &value), "{option}");
            assert!(option.starts_with("-i") || option.contains(at.file.split(' ').next().unwrap()), "{at}");
        }
        assert_eq!(given("render", "--background=a.jpg"), Parameters::default(), "a picture is no setting");
    }

    #[test]
    fn wrong_numbers_are_refused_with_the_option_and_what_to_write() {
        for row in ROWS.iter().filter(|row| row.option.is_some()) {
            let is_number =
                matches!(row.parameter.kind, ParameterKind::Number { .. } | ParameterKind::Integer { .. });
            for text in ["wide", "nan", "1e99", "-1e99"].iter().filter(|_| is_number) {
                let option = format!("{}={text}", row.option.unwrap());
                let line = ["bilux", "render", "a.toml", "-o", "a.png", &option];
                let error = Arguments::try_parse_from(line).err().expect(&option).to_string();
                assert!(error.contains(row.option.unwrap()) && error.contains("write "), "{option}: {error}");
            }
        }
    }

    #[test]
    fn the_options_of_rows_are_all_that_the_command_line_has_for_settings() {
        let command = Arguments::command();
        let render = command.find_subcommand("render").unwrap();
        let has = |option: &str| render.get_arguments().any(|a| a.get_long() == option.strip_prefix("--"));
        for row in ROWS.iter().filter(|row| row.option.is_none()) {
            let by_name = format!("--{}", row.parameter.name.replace('_', "-"));
            assert!(!has(&by_name), "{by_name} is not in the row");
        }
    }
}
