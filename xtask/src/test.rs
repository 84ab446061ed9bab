//! `cargo xtask test`: everything that must hold before a change lands, quick steps first. `--long` adds the long forms of
//! some tests, which take an hour or more.

use crate::process::{cargo, cpu_time, run_watched};
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
    Step { name: "deny", run: deny },
    Step { name: "clippy", run: clippy },
    Step { name: "build", run: |_| crate::process::build_all() },
    Step { name: "test", run: tests },
    Step { name: "examples", run: examples },
    Step { name: "python", run: |_| crate::python::test() },
    Step { name: "instructions", run: |_| crate::instructions::run(&[]) },
    Step { name: "reference", run: |_| crate::docs::check_reference() },
    Step { name: "manual", run: |_| crate::manual::run(&["--check".to_owned()]) },
    Step { name: "doc", run: |_| crate::docs::library() },
];

/// The long forms, which `--long` adds: `docs/trust.md` says what each does beyond its short form.
const LONG: &[Step] = &[
    Step { name: "long-wheel", run: |_| crate::python::test_wheel() },
    Step { name: "long-suites", run: long_suites },
    Step { name: "long-leaks", run: |_| release_example("bilux-accel", "leak_hunt", &[]) },
    Step {
        name: "long-agreement",
        run: |_| release_example("bilux-validation", "agreement", &["--seconds", "3"]),
    },
];

/// Runs every step, or those that are named, and reports all of them even if one fails.
pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let start = (Instant::now(), cpu_time());
    let steps = chosen(arguments)?;
    let mut totals = Totals::default();
    let mut reports = Vec::new();
    for step in steps {
        println!("==> {}", step.name);
        let (start, cpu) = (Instant::now(), cpu_time());
        let result = (step.run)(&mut totals);
        if let Err(error) = &result {
            println!("{error:#}");
        }
        reports.push(Report { name: step.name, time: start.elapsed(), cpu: since(cpu), ok: result.is_ok() });
    }
    let failed: Vec<_> = reports.iter().filter(|report| !report.ok).map(|report| report.name).collect();
    reports.push(Report { name: "all", time: start.0.elapsed(), cpu: since(start.1), ok: failed.is_empty() });
    println!();
    reports.iter().for_each(|report| println!("{report}"));
    println!("{} passed, {} failed", totals.passed, totals.failed);
    if failed.is_empty() { Ok(()) } else { bail!("failed: {}", failed.join(", ")) }
}

/// The steps that the arguments ask for, in the order of the tables.
fn chosen(arguments: &[String]) -> Result<Vec<&'static Step>> {
    let all = || STEPS.iter().chain(LONG);
    let names: Vec<&String> = arguments.iter().filter(|word| *word != "--long").collect();
    if let Some(name) = names.iter().find(|name| all().all(|step| step.name != **name)) {
        let known: Vec<_> = all().map(|step| step.name).collect();
        bail!("there is no step '{name}' (there are: {}; `--long` adds the long ones)", known.join(", "));
    }
    let long = names.len() < arguments.len();
    let is_default = |step: &Step| names.is_empty() && STEPS.iter().any(|short| short.name == step.name);
    let is_long = |step: &Step| long && LONG.iter().any(|long| long.name == step.name);
    let is_named = |step: &Step| names.iter().any(|name| *name == step.name);
    Ok(all().filter(|step| is_default(step) || is_long(step) || is_named(step)).collect())
}

/// How long a step took.
struct Report {
    name: &'static str,
    time: Duration,
    /// Of all cores, where the system tells.
    cpu: Option<Duration>,
    ok: bool,
}

impl std::fmt::Display for Report {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let minutes = |time: Duration| time.as_secs_f64() / 60.0;
        let cpu = self.cpu.map_or("unknown".to_owned(), |cpu| format!("{:.2}", minutes(cpu)));
        let verdict = if self.ok { "ok" } else { "FAILED" };
        write!(out, "{:<16} {:>6.2} min, {cpu:>6} min of CPU  {verdict}", self.name, minutes(self.time))
    }
}

fn since(start: Option<Duration>) -> Option<Duration> {
    Some(cpu_time()?.saturating_sub(start?))
}

fn fmt(_: &mut Totals) -> Result<()> {
    component("fmt", "rustfmt")?;
    run_step(&["fmt", "--all", "--", "--check"]).context("run `cargo fmt --all`")
}

/// Known faults of the packages that we build on, their licences and where they come from: by `cargo-deny` and `deny.toml`,
/// where it is installed.
fn deny(_: &mut Totals) -> Result<()> {
    let there = cargo(&["deny", "--version"]).output().is_ok_and(|output| output.status.success());
    if !there {
        println!(
            "skipped: cargo-deny is not installed (install it with `cargo install --locked cargo-deny`)"
        );
        return Ok(());
    }
    run_step(&["deny", "--locked", "check", "advisories", "licenses", "sources"])
        .context("see deny.toml for what is allowed")
}

fn clippy(_: &mut Totals) -> Result<()> {
    component("clippy", "clippy")?;
    run_step(&["clippy", "--locked", "--workspace", "--all-targets", "--", "--deny", "warnings"])
}

fn tests(totals: &mut Totals) -> Result<()> {
    watched(&mut cargo(SUITES), totals)
}

/// The same with more samples, rays, seeds and cases.
fn long_suites(totals: &mut Totals) -> Result<()> {
    watched(cargo(SUITES).env("BILUX_LONG", "1"), totals)
}

/// Examples are left out: clippy has seen that they compile, and these do not run.
const SUITES: &[&str] = &["test", "--locked", "--workspace", "--tests", "--no-fail-fast"];

/// The examples in the documentation of the libraries.
fn examples(totals: &mut Totals) -> Result<()> {
    watched(&mut cargo(&["test", "--locked", "--workspace", "--doc", "--no-fail-fast"]), totals)
}

fn watched(command: &mut std::process::Command, totals: &mut Totals) -> Result<()> {
    let mut suites = 0;
    let ok = run_watched(command, |line| {
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

fn release_example(package: &str, example: &str, arguments: &[&str]) -> Result<()> {
    let run = ["run", "--locked", "--release", "-p", package, "--example", example, "--"];
    run_step(&[&run, arguments].concat())
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

    fn names(words: &[&str]) -> Vec<&'static str> {
        let words: Vec<String> = words.iter().map(|word| (*word).to_owned()).collect();
        chosen(&words).unwrap().iter().map(|step| step.name).collect()
    }

    #[test]
    fn long_steps_run_only_if_asked_for() {
        assert_eq!(names(&[]).len(), STEPS.len());
        assert_eq!(names(&["--long"]).len(), STEPS.len() + LONG.len());
        assert_eq!(names(&["long-leaks", "tidy"]), ["tidy", "long-leaks"]);
        let wrong = chosen(&["quick".to_owned()]).err().unwrap().to_string();
        assert!(wrong.starts_with("there is no step 'quick' (there are: fmt, tidy"), "{wrong}");
    }

    #[test]
    fn the_page_about_trust_lists_the_long_steps() {
        let page = std::fs::read_to_string(crate::process::root().join("docs/trust.md")).unwrap();
        for step in LONG {
            assert!(page.contains(&format!("`{}`", step.name)), "{}", step.name);
        }
    }

    #[test]
    fn a_failed_step_fails_the_whole() {
        let error = run(&["doc".to_owned(), "there-is-none".to_owned()]);
        assert!(error.is_err_and(|error| error.to_string().contains("there-is-none")));
        let report = Report { name: "doc", time: Duration::from_secs(90), cpu: None, ok: false };
        assert_eq!(report.to_string(), "doc                1.50 min, unknown min of CPU  FAILED");
    }
}
