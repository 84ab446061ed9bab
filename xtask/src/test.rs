//! `cargo xtask test`: everything that must hold before a change lands, quick steps first.

use crate::process::{cargo, run_watched};
use anyhow::{Context, Result, bail};
use std::time::{Duration, Instant};

/// One step; it may add to the totals.
struct Step {
    name: &'static str,
    run: fn(&mut Totals) -> Result<()>,
}

const STEPS: &[Step] = &[
    Step { name: "fmt", run: fmt },
    Step { name: "tidy", run: |_| crate::tidy::run(&[]) },
    Step { name: "licences", run: |_| crate::licences::run(&[]) },
    Step { name: "clippy", run: clippy },
    Step { name: "test", run: tests },
    Step { name: "python", run: |_| crate::python::test() },
    Step { name: "instructions", run: |_| crate::instructions::run(&[]) },
    Step { name: "reference", run: |_| crate::docs::check_reference() },
    Step { name: "manual", run: |_| crate::manual::run(&["--check".to_owned()]) },
    Step { name: "doc", run: |_| crate::docs::library() },
];

/// Runs every step, or those that are named, and reports all of them even if one fails.
pub(crate) fn run(names: &[String]) -> Result<()> {
    if let Some(name) = names.iter().find(|name| STEPS.iter().all(|step| step.name != **name)) {
        let known: Vec<_> = STEPS.iter().map(|step| step.name).collect();
        bail!("there is no step '{name}' (there are: {})", known.join(", "));
    }
    let mut totals = Totals::default();
    let mut reports = Vec::new();
    for step in STEPS.iter().filter(|step| names.is_empty() || names.iter().any(|name| name == step.name)) {
        println!("==> {}", step.name);
        let start = Instant::now();
        let result = (step.run)(&mut totals);
        if let Err(error) = &result {
            println!("{error:#}");
        }
        reports.push((step.name, start.elapsed(), result.is_ok()));
    }
    summarise(&reports, totals)
}

fn summarise(reports: &[(&str, Duration, bool)], totals: Totals) -> Result<()> {
    println!();
    for (name, time, ok) in reports {
        println!("{name:<12} {:>7.1} s  {}", time.as_secs_f64(), if *ok { "ok" } else { "FAILED" });
    }
    let all: Duration = reports.iter().map(|(_, time, _)| *time).sum();
    println!("{:<12} {:>7.1} s", "all", all.as_secs_f64());
    println!("{} passed, {} failed", totals.passed, totals.failed);
    let failed: Vec<_> = reports.iter().filter(|report| !report.2).map(|report| report.0).collect();
    if failed.is_empty() { Ok(()) } else { bail!("failed: {}", failed.join(", ")) }
}

fn fmt(_: &mut Totals) -> Result<()> {
    component("fmt", "rustfmt")?;
    run_step(&["fmt", "--all", "--", "--check"]).context("run `cargo fmt --all`")
}

fn clippy(_: &mut Totals) -> Result<()> {
    component("clippy", "clippy")?;
    run_step(&["clippy", "--locked", "--workspace", "--all-targets", "--", "--deny", "warnings"])
}

fn tests(totals: &mut Totals) -> Result<()> {
    let mut suites = 0;
    let ok = run_watched(&mut cargo(&["test", "--locked", "--workspace", "--no-fail-fast"]), |line| {
        if let Some(suite) = Totals::read(line) {
            totals.add(suite);
            suites += 1;
        }
    })?;
    match (ok, suites) {
        (true, 1..) => Ok(()),
        (_, 0) => bail!("no test ran"),
        _ => bail!("a test failed: see above"),
    }
}

fn run_step(arguments: &[&str]) -> Result<()> {
    crate::process::run(&mut cargo(arguments))
}

/// Installs a component of the toolchain if a minimal toolchain lacks it.
fn component(subcommand: &str, component: &str) -> Result<()> {
    let there = cargo(&[subcommand, "--version"]).output().is_ok_and(|output| output.status.success());
    if there {
        return Ok(());
    }
    let mut rustup = std::process::Command::new("rustup");
    crate::process::run(rustup.args(["component", "add", component]))
        .with_context(|| format!("`cargo {subcommand}` is missing and could not be installed"))
}

/// The numbers of tests that passed and failed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Totals {
    passed: u64,
    failed: u64,
}

impl Totals {
    /// Reads the closing line of a test suite.
    fn read(line: &str) -> Option<Totals> {
        let mut counts = line.strip_prefix("test result: ")?.split(['.', ';']).map(str::trim);
        let mut count = |word: &str| {
            counts.find_map(|part| part.strip_suffix(word)).and_then(|number| number.trim().parse().ok())
        };
        Some(Totals { passed: count("passed")?, failed: count("failed")? })
    }

    fn add(&mut self, other: Totals) {
        self.passed += other.passed;
        self.failed += other.failed;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closing_lines_are_read() {
        let line = "test result: FAILED. 41 passed; 2 failed; 0 ignored; 0 measured; 3 filtered out; finished in 0.2s";
        assert_eq!(Totals::read(line), Some(Totals { passed: 41, failed: 2 }));
        let line = "test result: ok. 7 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out";
        assert_eq!(Totals::read(line), Some(Totals { passed: 7, failed: 0 }));
        assert_eq!(Totals::read("test a::b ... ok"), None);
        assert_eq!(Totals::read("test result: "), None);
    }

    #[test]
    fn a_failed_step_fails_the_whole() {
        let fine = ("fmt", Duration::ZERO, true);
        assert!(summarise(&[fine], Totals::default()).is_ok());
        let error = summarise(&[fine, ("doc", Duration::ZERO, false)], Totals::default());
        assert_eq!(error.map_err(|error| error.to_string()), Err("failed: doc".to_owned()));
    }
}
