//! The memory of a large picture, measured in a process of its own.

use super::measurement::{Context, Measurement};
use super::mitsuba::Scratch;
use super::row::{Goal, Row, rows_of};
use super::shots::as_a_user;
use crate::render::Clock;
use bilux::Error;
use bilux::scene::{Parameters, Spec, Value};
use std::process::{Command, Stdio};
use std::time::Instant;

/// The name by which a process is asked for this row alone.
const NAME: &str = "memory";

pub(super) const MEASUREMENT: Measurement =
    Measurement { name: NAME, summary: "1920x1080 by auto, denoised: peak memory", run };

const WHAT: &str = "1920x1080 by auto, denoised (caustics): peak MB";
const GOAL: Goal = Goal::AtMost(350.0);
const SIZE: (u32, u32) = (1920, 1080);

fn run(context: &Context) -> Result<Vec<Row>, Error> {
    if context.is_alone && context.options.repeats <= 1 {
        return Ok(vec![measured(context)?]);
    }
    let mut rows = Vec::new();
    for round in context.rounds() {
        context.say(&format!("memory: a process of its own, round {}", round + 1));
        rows.extend(by_another_process(context));
    }
    rows.sort_by(|a, b| a.ours.unwrap_or(0.0).total_cmp(&b.ours.unwrap_or(0.0)));
    let middle = rows.len().saturating_sub(1) / 2;
    let why = format!("not measured: '{}' could not be run", context.options.program.display());
    Ok(vec![rows.into_iter().nth(middle).unwrap_or_else(|| Row::skipped(WHAT, GOAL, why))])
}

/// The row as a process that measures nothing else prints it.
fn by_another_process(context: &Context) -> Option<Row> {
    let mut command = Command::new(&context.options.program);
    command.args(["bench", "speed", "--json", "--quiet", "--repeats", "1", "--rows", NAME]);
    let output = command.stderr(Stdio::null()).output().ok()?;
    rows_of(&serde_json::from_slice(&output.stdout).ok()?).pop()
}

fn measured(context: &Context) -> Result<Row, Error> {
    context.say("memory: 1920x1080 by auto");
    let scratch = Scratch::new(NAME)?;
    let clock = Clock::start(0);
    let begun = Instant::now();
    let scene = bilux::generate(&Spec::new("", "caustics"))?;
    let mut user = Parameters::default();
    let part = |side: u32| context.options.part_of(side);
    user.set("size", Value::Text(format!("{}x{}", part(SIZE.0), part(SIZE.1))));
    // Another denoiser needs other memory, and is not everywhere.
    user.set("denoise", "builtin");
    let samples = as_a_user(&scene, user, begun, &scratch.path("picture.png"))?.samples;
    Ok(match clock.stop().1 {
        Some(peak) => {
            Row::new(WHAT, peak, GOAL).with_note(format!("{samples} samples a pixel, builtin denoiser"))
        }
        None => Row::skipped(WHAT, GOAL, "not measured: the system does not say"),
    })
}
