//! Turns flags and `--set KEY=VALUE` into the same parameters that scene files use.

use crate::arguments::assignments::{assignment_of, from_flag};
use crate::arguments::serving::Serve;
use crate::arguments::studio::StudioArguments;
use crate::arguments::values::Exposure;
use crate::arguments::{Explain, Render};
use crate::process::memory;
use bilux::scene::{Parameters, Value};

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
    let flags = [
        ("integrator", "--integrator", text(&a.integrator)),
        ("accel", "--accel", text(&a.accel)),
        ("build", "--build", text(&a.build)),
        ("size", "--size", text(&a.size)),
        ("spp", "--spp", whole(a.spp.map(u64::from))),
        ("noise", "--noise", number(a.noise)),
        ("time_limit", "--time-limit", number(a.time_limit)),
        ("seed", "--seed", whole(a.seed)),
        ("threads", "--threads", whole(a.threads.map(u64::from))),
        ("max_depth", "--max-depth", whole(a.max_depth.map(u64::from))),
        ("camera", "--camera", text(&a.camera)),
        ("time", "--at", number(a.at)),
        ("exposure", "--exposure", number(stops)),
        ("auto_exposure", "--exposure", (a.exposure == Some(Exposure::Auto)).then_some(Value::Bool(true))),
        ("tonemap", "--tonemap", text(&a.tonemap)),
        ("denoise", "--denoise", text(&a.denoise)),
        ("specular", "--specular", text(&a.specular)),
        ("shadow_rule", "--shadow-rule", text(&a.shadow_rule)),
        ("bsp_split", "--bsp-split", text(&a.bsp_split)),
        ("bsp_group", "--bsp-group", text(&a.bsp_group)),
    ];
    let mut parameters = all(flags.into_iter().chain(studio(&a.studio)), &a.set)?;
    bilux::budget::let_limits_decide(&mut parameters);
    Ok(parameters)
}

/// The settings on the command line of a viewer.
pub fn serve(arguments: &Serve) -> anyhow::Result<Parameters> {
    let time = [("time", "--at", arguments.at.map(Value::from))];
    all(time.into_iter().chain(studio(&arguments.studio)), &arguments.set)
}

/// The settings on the command line that explains a scene.
pub fn explain(arguments: &Explain) -> anyhow::Result<Parameters> {
    let at = arguments.posed.at;
    let time = [("time", "--at", (at != 0.0).then(|| Value::from(at)))];
    let mut parameters = all(time.into_iter().chain(studio(&arguments.studio)), &arguments.set)?;
    if parameters.find("integrator").is_none() {
        // Whatever the scene file says: it is explained by what this one finds.
        parameters.set("integrator", "auto");
    }
    Ok(parameters)
}

/// A setting, its flag, and its value if it is given.
type Flag = (&'static str, &'static str, Option<Value>);

/// The settings of the camera and the studio.
fn studio(studio: &StudioArguments) -> [Flag; 10] {
    let text = |t: &Option<String>| t.clone().map(Value::Text);
    let number = |n: Option<f32>| n.map(Value::from);
    [
        ("eye", "--eye", text(&studio.eye)),
        ("look_at", "--look-at", text(&studio.look_at)),
        ("zoom", "--zoom", number(studio.zoom)),
        ("orbit", "--orbit", text(&studio.orbit)),
        ("up", "--up", text(&studio.up)),
        ("front", "--front", text(&studio.front)),
        ("focal", "--focal", number(studio.focal)),
        ("ground", "--ground", text(&studio.ground)),
        ("fog", "--fog", number(studio.fog)),
        ("background", "--background", text(&studio.background())),
    ]
}

/// The settings that flags give, and those of `--set`.
fn all(flags: impl Iterator<Item = Flag>, set: &[String]) -> anyhow::Result<Parameters> {
    let mut parameters = Parameters::default();
    for (key, flag, value) in flags {
        if let Some(value) = value {
            parameters.set_at(key, value, from_flag(flag));
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
    use clap::Parser;

    /// Each option alone gives its own setting and no other, also where options come in pairs.
    #[test]
    fn every_option_works_without_the_others() {
        for (option, key, value) in [
            ("--up=z", "up", Value::from("z")),
            ("--front=-y", "front", Value::from("-y")),
            ("--eye=1,2,3", "eye", Value::from("1,2,3")),
            ("--look-at=1,2,3", "look_at", Value::from("1,2,3")),
            ("--orbit=10,20", "orbit", Value::from("10,20")),
            ("--zoom=2", "zoom", Value::from(2.0f32)),
            ("--focal=50", "focal", Value::from(50.0f32)),
            ("--ground=shadow", "ground", Value::from("shadow")),
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
        ] {
            let line = ["bilux", "render", "a.toml", "-o", "a.png", option];
            let Command::Render(arguments) = Arguments::try_parse_from(line).unwrap().command else {
                panic!("{option}")
            };
            let given: Vec<(String, Value)> =
                render(&arguments).unwrap().0.into_iter().map(|(key, value, _)| (key, value)).collect();
            assert_eq!(given, [(key.to_owned(), value)], "{option}");
        }
    }
}
