//! The suites of tests: each binary that cargo has built runs in several processes, as many at a time as there are cores,
//! and what each test takes is measured in CPU time.

mod chunks;
mod found;
mod printed;
mod process;
mod report;
mod totals;

use crate::process::target_folder;
use anyhow::{Result, bail};
use chunks::{Chunk, Times};
use found::Suite;
use process::Outcome;
use report::Report;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};
use std::thread;
pub(crate) use totals::Totals;

/// One run of the suites.
#[derive(Clone, Copy, Default)]
pub(crate) struct Options<'a> {
    /// The packages whose tests run; those of all, if there are none here.
    pub(crate) packages: &'a [String],
    /// Runs the long form of each test.
    pub(crate) is_long: bool,
}

/// Builds the suites and runs them. A test that fails is an error, and so is none that ran.
pub(crate) fn run(options: Options<'_>, totals: &mut Totals) -> Result<()> {
    let suites: Vec<Suite> = found::build_and_list(options.packages)?;
    let times = Times::read(&times_path());
    let waiting = Mutex::new(chunks::divide(&suites, &times));
    let report = Mutex::new(Report::default());
    let work = || {
        while let Some(chunk) = take(&waiting) {
            let _core = crate::cores::take();
            run_chunk(&suites[chunk.suite], chunk, options.is_long, &report);
        }
    };
    thread::scope(|scope| (0..crate::cores::count()).for_each(|_| drop(scope.spawn(work))));
    let report = report.into_inner().unwrap_or_else(PoisonError::into_inner);
    if !options.is_long {
        times.with(report.times()).write(&times_path());
    }
    print!("{report}");
    *totals += Totals { passed: report.passed, failed: report.failed.len() };
    match (report.passed, report.failed.as_slice()) {
        (0, []) => bail!("no test ran"),
        (_, []) => Ok(()),
        (_, failed) => bail!("failed: {}", failed.join(", ")),
    }
}

/// The longest chunk that is left.
fn take(waiting: &Mutex<Vec<Chunk>>) -> Option<Chunk> {
    waiting.lock().unwrap_or_else(PoisonError::into_inner).pop()
}

/// Runs the tests of a chunk, in a second process those that a crash of the first left over, and so on.
fn run_chunk(suite: &Suite, chunk: Chunk, is_long: bool, report: &Mutex<Report>) {
    let mut tests = chunk.tests;
    while !tests.is_empty() {
        let outcome =
            process::run(suite, &tests, is_long).unwrap_or_else(|error| Outcome::none(&tests, &error));
        let text = report.lock().unwrap_or_else(PoisonError::into_inner).add(suite, &outcome);
        print!("{text}");
        tests = outcome.left;
    }
}

/// What each test took when it ran last, for the order of the next run.
fn times_path() -> PathBuf {
    target_folder().join("test-times.tsv")
}
