//! Turns flags and `--set KEY=VALUE` into the same parameters that scene files use.

use crate::arguments::assignments::{assignment_of, from_flag};
use crate::arguments::serving::Serve;
use crate::arguments::studio::StudioArguments;
use crate::arguments::values::Exposure;
use crate::arguments::{Explain, Render};
use crate::process::memory;
use bilux::scene::{Parameters, Value};
use bilux::settings::SettingRow;

/// The render settings on the command line.
pub fn render(arguments: &Render) -> anyhow::Result<Parameters> {
    let a = arguments;
    let text = |t: &Option<String>| t.clone().map(Value::Text);
    let whole = |n: Option<u64>| n.map(|n| Value::Integer(i64::try_from(n).unwrap_or(i64::MAX)));
    let number = |n: Option<f32>| n.map(Value::from);
    let stops = match a.exposure {
        Some(Exposure::Stops(stops)) => Some(stops),
        Some(Exposure::Auto) | None => None,
    };
    let given = [
        ("integrator", text(&a.integrator)),
        ("accel", text(&a.accel)),
        ("build", text(&a.build)),
        ("size", text(&a.size)),
        ("spp", whole(a.spp.map(u64::from))),
        ("noise", number(a.noise)),
        ("time_limit", number(a.time_limit)),
        ("seed", whole(a.seed)),
        ("threads", whole(a.threads.map(u64::from))),
        ("max_depth", whole(a.max_depth.map(u64::from))),
        ("camera", text(&a.camera)),
        ("time", number(a.at)),
        ("exposure", number(stops)),
        ("auto_exposure", (a.exposure == Some(Exposure::Auto)).then_some(Value::Bool(true))),
        ("tonemap", text(&a.tonemap)),
        ("denoise", text(&a.denoise)),
        ("specular", text(&a.specular)),
        ("shadow_rule", text(&a.shadow_rule)),
        ("bsp_split", text(&a.bsp_split)),
        ("bsp_group", text(&a.bsp_group)),
    ];
    let mut parameters = all(given.into_iter().chain(studio(&a.studio)), &a.set)?;
    bilux::budget::let_limits_decide(&mut parameters);
    Ok(parameters)
}

/// The settings on the command line of a viewer.
pub fn serve(arguments: &Serve) -> anyhow::Result<Parameters> {
    let time = [("time", arguments.at.map(Value::from))];
    all(time.into_iter().chain(studio(&arguments.studio)), &arguments.set)
}

/// The settings on the command line that explains a scene.
pub fn explain(arguments: &Explain) -> anyhow::Result<Parameters> {
    let at = arguments.posed.at;
    let time = [("time", (at != 0.0).then(|| Value::from(at)))];
    let mut parameters = all(time.into_iter().chain(studio(&arguments.studio)), &arguments.set)?;
    if parameters.find("integrator").is_none() {
        // Whatever the scene file says: it is explained by what this one finds.
        parameters.set("integrator", "auto");
    }
    Ok(parameters)
}

/// A setting, and its value if its option is given.
type Given = (&'static str, Option<Value>);

/// The option that gives a setting, or a parameter of an integrator.
fn option_of(key: &str) -> String {
    match SettingRow::named(key).and_then(|row| row.option) {
        Some(option) => option.to_owned(),
        // A word in the place of its number.
        None if key == "auto_exposure" => "--exposure".to_owned(),
        None => format!("--{}", key.replace('_', "-")),
    }
}

/// The settings of the camera and the studio.
fn studio(studio: &StudioArguments) -> [Given; 10] {
    let text = |t: &Option<String>| t.clone().map(Value::Text);
    let number = |n: Option<f32>| n.map(Value::from);
    [
        ("eye", text(&studio.eye)),
        ("look_at", text(&studio.look_at)),
        ("zoom", number(studio.zoom)),
        ("orbit", text(&studio.orbit)),
        ("up", text(&studio.up)),
        ("front", text(&studio.front)),
        ("focal", number(studio.focal)),
        ("ground", text(&studio.ground)),
        ("fog", number(studio.fog)),
        ("background", text(&studio.background())),
    ]
}

/// The settings that options give, and those of `--set`.
fn all(given: impl Iterator<Item = Given>, set: &[String]) -> anyhow::Result<Parameters> {
    let mut parameters = Parameters::default();
    for (key, value) in given {
        if let Some(value) = value {
            parameters.set_at(key, value, from_flag(&option_of(key)));
        }
    }
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
    use bilux::settings::{Effect, ROWS};
    use clap::{CommandFactory, Parser};

    /// Each option alone gives its own setting and no other, also where options come in pairs.
    #[test]
    fn every_option_works_without_the_others() {
        let options = [
            ("--up=z", "up", Value::from("z")),
            ("--front=-y", "front", Value::from("-y")),
            ("--eye=1,2,3", "eye", Value::from("1,2,3")),
            ("--look-at=1,2,3", "look_at", Value::from("1,2,3")),
            ("--orbit=10,20", "orbit", Value::from("10,20")),
            ("--zoom=2", "zoom", Value::from(2.0f32)),
            ("--focal=50", "focal", Value::from(50.0f32)),
            ("--ground=shadow", "ground", Value::from("shadow")),
            ("--fog=20", "fog", Value::from(20.0f32)),
            ("--background=white", "background", Value::from("white")),
            ("--size=4x3", "size", Value::from("4x3")),
            ("--seed=7", "seed", Value::Integer(7)),
            ("--threads=2", "threads", Value::Integer(2)),
            ("--max-depth=3", "max_depth", Value::Integer(3)),
            ("--camera=1", "camera", Value::from("1")),
            ("--at=0.5", "time", Value::from(0.5f32)),
            ("--exposure=1", "exposure", Value::from(1.0f32)),
            ("--exposure=auto", "auto_exposure", Value::Bool(true)),
            ("--tonemap=agx", "tonemap", Value::from("agx")),
            ("--denoise", "denoise", Value::from("auto")),
            ("--integrator=path", "integrator", Value::from("path")),
            ("--accel=bvh", "accel", Value::from("bvh")),
            ("--build=fast", "build", Value::from("fast")),
            ("--specular=reflect", "specular", Value::from("reflect")),
            ("--shadow-rule=paper", "shadow_rule", Value::from("paper")),
            ("--bsp-split=mean", "bsp_split", Value::from("mean")),
            ("--bsp-group=objects", "bsp_group", Value::from("objects")),
            ("--set=fps=30", "fps", Value::Integer(30)),
        ];
        for row in ROWS.iter().filter(|row| row.option.is_some() && row.effect != Effect::Count) {
            assert!(options.iter().any(|(_, key, _)| *key == row.parameter.name), "{}", row.parameter.name);
        }
        for (option, key, value) in options {
            let line = ["bilux", "render", "a.toml", "-o", "a.png", option];
            let Command::Render(arguments) = Arguments::try_parse_from(line).unwrap().command else {
                panic!("{option}")
            };
            let given = render(&arguments).unwrap().0;
            let values: Vec<_> = given.iter().map(|(key, value, _)| (&**key, value)).collect();
            assert_eq!(values, [(key, &value)], "{option}");
            let name = option.split('=').next().unwrap();
            assert!(given[0].2.to_string().contains(name), "{option} is said at {}", given[0].2);
        }
    }

    #[test]
    fn the_options_of_rows_are_all_that_the_command_line_has_for_settings() {
        let command = Arguments::command();
        let render = command.find_subcommand("render").unwrap();
        let has = |option: &str| render.get_arguments().any(|a| a.get_long() == option.strip_prefix("--"));
        for row in ROWS {
            let by_name = format!("--{}", row.parameter.name.replace('_', "-"));
            let option = row.option.or(Some(&*by_name).filter(|option| has(option)));
            assert_eq!(row.option, option, "an option of its own");
            assert!(option.is_none_or(has), "{option:?}");
        }
    }
}
