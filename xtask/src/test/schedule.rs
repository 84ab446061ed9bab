//! The order of the steps: those of the front one after the other, and beside them those that would leave a core idle.

use super::beside;
use super::report::Report;
use super::steps::{BUILD, Context, Lane, Place, Step, TEST};
use crate::process::cpu_time;
use crate::suites::Totals;
use anyhow::{Context as _, Result};
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Runs the steps, and returns a report about each, in the order of the table.
pub(super) fn run(steps: &[&'static Step], context: Context) -> Result<(Vec<Report>, Totals)> {
    let program = std::env::current_exe().context("cannot find this program")?;
    let (front, lanes) = divide(steps);
    let (done, gate) = (Mutex::new(Done::default()), Mutex::new(()));
    let has = |name| front.iter().any(|step| step.name == name);
    let (has_build, has_tests) = (has(BUILD), has(TEST));
    thread::scope(|scope| {
        // Whoever locks the gate waits until this is dropped.
        let mut closed = has_build.then(|| lock(&gate));
        for lane in lanes {
            let (gate, done, program) = (&gate, &done, &program);
            scope.spawn(move || {
                lane.into_iter().for_each(|step| run_beside(program, step, has_build, gate, done))
            });
        }
        let mut context = Context { builds: has_build, tests: has_tests, ..context };
        for step in front {
            run_in_front(step, &mut context, &done);
            if step.name == BUILD {
                (closed, context.is_built) = (None, true);
            }
        }
        drop(closed);
        lock(&done).totals += context.totals;
    });
    let Done { mut reports, totals, .. } = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    reports.sort_by_key(|report| steps.iter().position(|step| step.name == report.name));
    Ok((reports, totals))
}

/// Steps that have ended so far.
#[derive(Default)]
struct Done {
    reports: Vec<Report>,
    totals: Totals,
    /// The CPU time of the steps that ran beside.
    beside: Duration,
}

/// The steps of the front, and those of each lane. Without a front they are the front: there is nothing to run beside.
fn divide(steps: &[&'static Step]) -> (Vec<&'static Step>, Vec<Vec<&'static Step>>) {
    let of = |lane| steps.iter().copied().filter(move |step| lane_of(step) == lane).collect::<Vec<_>>();
    match of(None) {
        front if front.is_empty() => (steps.to_vec(), Vec::new()),
        front => (front, [Lane::Python, Lane::Valgrind, Lane::Documents].map(|lane| of(Some(lane))).into()),
    }
}

fn lane_of(step: &Step) -> Option<Lane> {
    match step.place {
        Place::Front => None,
        Place::Beside(lane) | Place::BesideBuilt(lane) => Some(lane),
    }
}

fn run_in_front(step: &'static Step, context: &mut Context, done: &Mutex<Done>) {
    println!("==> {}", step.name);
    let start = (Instant::now(), cpu_time());
    let before = lock(done).beside + context.early;
    let result = (step.run)(context);
    if let Err(error) = &result {
        println!("{error:#}");
    }
    let mut done = lock(done);
    let mut report = Report::since(step.name, start, result.is_ok());
    // What ran meanwhile and is not of this step.
    report.cpu = report.cpu.map(|cpu| (cpu + before).saturating_sub(done.beside + context.early));
    done.reports.push(report);
}

fn run_beside(program: &Path, step: &'static Step, has_build: bool, gate: &Mutex<()>, done: &Mutex<Done>) {
    if matches!(step.place, Place::BesideBuilt(_)) {
        drop(lock(gate));
    }
    let _core = crate::cores::take();
    let ended = beside::run(program, step, has_build);
    let mut done = lock(done);
    print!("==> {} ran beside these\n{}", step.name, ended.said);
    done.beside += ended.report.cpu.unwrap_or_default();
    done.totals += ended.totals;
    done.reports.push(ended.report);
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::bail;

    #[test]
    fn a_failed_step_fails_and_the_others_run_all_the_same() {
        static STEPS: [Step; 3] = [
            Step { name: "first", place: Place::Front, run: |context| count(context, 1) },
            Step { name: "broken", place: Place::Front, run: |_| bail!("it is broken") },
            Step { name: "last", place: Place::Front, run: |context| count(context, 2) },
        ];
        fn count(context: &mut Context, passed: usize) -> Result<()> {
            context.totals += Totals { passed, ..Totals::default() };
            Ok(())
        }
        let (reports, totals) = run(&STEPS.each_ref(), Context::default()).unwrap();
        let found: Vec<_> = reports.iter().map(|report| (report.name, report.ok)).collect();
        assert_eq!(found, [("first", true), ("broken", false), ("last", true)]);
        assert_eq!(totals, Totals { passed: 3, ..Totals::default() });
    }
}
