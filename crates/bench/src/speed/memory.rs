//! The memory of a large picture, measured in a process of its own.

use super::row::{Goal, Row};
use super::{Context, Measurement, rows_of};
use crate::render::Clock;
use bilux::budget::with_default_budget;
use bilux::scene::{Parameters, Spec, Value};
use bilux::{Error, Job, Quiet};
use std::process::{Command, Stdio};

/// The name by which a process is asked for this row alone.
const NAME: &str = "memory";

pub(super) const MEASUREMENT: Measurement =
    Measurement { name: NAME, summary: "1920x1080 by auto, denoised: peak memory", run };

const WHAT: &str = "1920x1080 by auto, denoised (caustics): peak MB";
const GOAL: Goal = Goal::AtMost(350.0);
const SIZE: (u32, u32) = (1920, 1080);

fn run(context: &Context) -> Result<Vec<Row>, Error> {
    if context.is_alone {
        return Ok(vec![measured(context)?]);
    }
    context.say("memory: a process of its own");
    let options = context.options;
    let mut command = Command::new(&options.program);
    command.args(["bench", "speed", "--json", "--quiet", "--rows", NAME]);
    let output = command.stderr(Stdio::null()).output();
    let rows = match output {
        Ok(output) => serde_json::from_slice(&output.stdout).map_or_else(|_| Vec::new(), |v| rows_of(&v)),
        Err(_) => Vec::new(),
    };
    if rows.is_empty() {
        let why = format!("not measured: '{}' could not be run", options.program.display());
        return Ok(vec![Row::skipped(WHAT, GOAL, why)]);
    }
    Ok(rows)
}

fn measured(context: &Context) -> Result<Row, Error> {
    context.say("memory: 1920x1080 by auto");
    let clock = Clock::start(0);
    let scene = bilux::generate(&Spec::new("", "caustics"))?;
    let mut user = Parameters::default();
    user.set("integrator", "auto");
    let part = |side: u32| context.options.part_of(side);
    user.set("size", Value::Text(format!("{}x{}", part(SIZE.0), part(SIZE.1))));
    // Another denoiser needs other memory, and is not everywhere.
    user.set("denoise", "builtin");
    with_default_budget(&scene.settings, &mut user);
    let mut job = Job::new(&scene, &user)?;
    let denoiser = job.denoiser(true)?;
    let outcome = job.render(&Quiet)?;
    let picture = match &denoiser {
        Some(denoiser) => outcome.denoised(denoiser)?,
        None => outcome.picture()?,
    };
    drop(picture);
    let samples = outcome.reached.map_or(0, |reached| reached.spp);
    Ok(match clock.stop().1 {
        Some(peak) => {
            Row::new(WHAT, peak, GOAL).with_note(format!("{samples} samples a pixel, builtin denoiser"))
        }
        None => Row::skipped(WHAT, GOAL, "not measured: the system does not say"),
    })
}
