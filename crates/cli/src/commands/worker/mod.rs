//! `bilux worker`: a stream of jobs, each a line of JSON, rendered one after the other by a process that stays warm.
//!
//! Two processes share the work. One reads the jobs, limits each, and writes the results. The other renders, and is
//! replaced if it dies, if it does not stop in time, or if its sandbox does not fit the next job: so no job can harm
//! those after it.

mod confines;
mod job;
mod lines;
mod process;
mod signals;
mod warm;

use crate::arguments::{Common, Worker};
use crate::commands::DONE;
use crate::process::output;
use job::{Job, Limits};
use lines::Lines;
use process::{Ending, Process};
use serde_json::{Value, json};
use signals::Signals;
use std::time::Instant;

/// Reads jobs and writes results, until the jobs or the process end.
pub fn run(arguments: &Worker, common: &Common) -> anyhow::Result<u8> {
    if arguments.warm {
        return warm::run();
    }
    let signals = Signals::listen()?;
    let limits = Limits::of(arguments, common);
    let (lines, mut process) = (Lines::of_stdin(), None);
    while let Some((number, line)) = lines.next(&signals) {
        let begun = Instant::now();
        let (id, output, in_vain, ended) = match Job::read(line, &limits) {
            Ok(job) => {
                let ended = rendered(&job, &mut process, &signals);
                (job.id, json!(job.output), job.in_vain, ended)
            }
            Err((id, error)) => (id, Value::Null, Vec::new(), Ending::failed(2, error)),
        };
        let of_pictures =
            ended.pictures.iter().filter_map(|picture| picture["warnings"].as_array()).flatten();
        let warnings: Vec<Value> = in_vain.into_iter().map(Value::from).chain(of_pictures.cloned()).collect();
        output::print(json!({
            "id": id, "line": number, "status": ended.status, "output": output,
            "seconds": begun.elapsed().as_secs_f64(), "error": ended.error, "warnings": warnings,
            "pictures": ended.pictures,
        }))?;
        if signals.status().is_some() {
            break;
        }
    }
    drop(process);
    Ok(signals.status().unwrap_or(DONE))
}

/// Renders a job, and says how that went. The process is the one of the jobs before it, if there is one.
fn rendered(job: &Job, process: &mut Option<Process>, signals: &Signals) -> Ending {
    if process.as_ref().is_some_and(|process| !process.may_take(job)) {
        *process = None;
    }
    match process.take().map_or_else(Process::start, Ok) {
        Ok(mut started) => {
            let ended = started.render(job, signals);
            if ended.is_alive {
                *process = Some(started);
            }
            ended
        }
        Err(error) => Ending::failed(1, format!("cannot start a process: {error}")),
    }
}
