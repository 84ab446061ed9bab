//! A step in a process of its own, whose output is printed when it has ended: `cargo xtask test --beside STEP [--built]`.

use super::arguments;
use super::report::Report;
use super::steps::{Context, Step};
use crate::process::{cpu_time_of, has_ended};
use crate::suites::Totals;
use anyhow::{Context as _, Result, bail};
use std::io::{Read, pipe};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const FLAG: &str = "--beside";
const BUILT: &str = "--built";

/// Result of a step.
pub(super) struct Ended {
    pub(super) report: Report,
    pub(super) totals: Totals,
    pub(super) said: String,
}

/// Runs a step in a process of this program. Its path must have been asked for before anything was built: a program that has been
/// linked again since does not know where it is.
pub(super) fn run(program: &Path, step: &'static Step, is_built: bool) -> Ended {
    let begun = Instant::now();
    let (said, cpu, ok) =
        start(program, step.name, is_built).unwrap_or_else(|error| (format!("{error:#}\n"), None, false));
    let totals = said.lines().rev().find_map(Totals::read).unwrap_or_default();
    Ended { report: Report { name: step.name, time: begun.elapsed(), cpu, ok }, totals, said }
}

fn start(program: &Path, name: &str, is_built: bool) -> Result<(String, Option<Duration>, bool)> {
    let (mut reader, writer) = pipe().context("there is no pipe left")?;
    let mut command = Command::new(program);
    command.args(["test", FLAG, name]).args(is_built.then_some(BUILT));
    command.stdin(Stdio::null()).stdout(writer.try_clone()?).stderr(writer);
    let mut child = command.spawn().with_context(|| format!("cannot start the step {name}"))?;
    // This side of the pipe must be closed, or reading never ends.
    drop(command);
    let mut said = Vec::new();
    reader.read_to_end(&mut said).with_context(|| format!("cannot read what the step {name} says"))?;
    while !has_ended(child.id()) {
        std::thread::sleep(Duration::from_millis(2));
    }
    let cpu = cpu_time_of(child.id());
    let ok = child.wait()?.success();
    Ok((String::from_utf8_lossy(&said).into_owned(), cpu, ok))
}

/// The step that this process shall run beside others, if that is what it was started for.
pub(super) fn asked_for(arguments: &[String]) -> Result<Option<(&'static Step, bool)>> {
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let (name, is_built) = match words.as_slice() {
        [FLAG, name] => (name, false),
        [FLAG, name, BUILT] => (name, true),
        _ => return Ok(None),
    };
    let Some(step) = arguments::step(name) else { bail!("there is no step '{name}'") };
    Ok(Some((step, is_built)))
}

/// Runs a step in this process; its last line is that of the totals, if it has any.
pub(super) fn run_here((step, is_built): (&'static Step, bool)) -> Result<()> {
    let mut context = Context { is_built, ..Context::default() };
    let result = (step.run)(&mut context);
    if context.totals != Totals::default() {
        println!("{}", context.totals);
    }
    result
}
