//! `cargo xtask test`: everything that must hold before a change lands, quick steps first. `--changed` leaves out what a
//! change cannot reach; `--long` adds the long forms of some tests, which take an hour or more.

mod arguments;
mod beside;
mod changed;
mod reach;
mod report;
mod schedule;
mod steps;

use crate::process::cpu_time;
use anyhow::{Result, bail};
use report::Report;
use std::time::Instant;
use steps::Context;

/// Runs every step, or those that are named or that a change reaches, and reports all of them even if one fails.
pub(crate) fn run(arguments: &[String]) -> Result<()> {
    if let Some(step) = beside::asked_for(arguments)? {
        return beside::run_here(step);
    }
    let start = (Instant::now(), cpu_time());
    let mut chosen = arguments::read(arguments)?;
    let mut context = Context { packages: std::mem::take(&mut chosen.packages), ..Context::default() };
    if let Some(base) = &chosen.changed {
        let reached = changed::reached(base.as_deref())?;
        println!("{reached}");
        chosen.steps.retain(|step| reached.has(step.name));
        if context.packages.is_empty() {
            context.packages = reached.packages;
        }
    }
    let (mut reports, totals) = schedule::run(&chosen.steps, context)?;
    let failed: Vec<_> = reports.iter().filter(|report| !report.ok).map(|report| report.name).collect();
    reports.push(Report::since("all", start, failed.is_empty()));
    println!();
    reports.iter().for_each(|report| println!("{report}"));
    println!("{totals}");
    if failed.is_empty() { Ok(()) } else { bail!("failed: {}", failed.join(", ")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_step_fails_before_anything_runs() {
        let error = run(&["doc".to_owned(), "there-is-none".to_owned()]);
        assert!(error.is_err_and(|error| error.to_string().contains("there-is-none")));
    }
}
