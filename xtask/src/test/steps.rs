//! The steps of `cargo xtask test`, as two tables.

use crate::build;
use crate::process::{cargo, run_watched};
use crate::suites::{self, Options, Running, Totals};
use anyhow::{Context as _, Result, bail};
use std::time::Duration;

/// One step.
pub(super) struct Step {
    pub(super) name: &'static str,
    pub(super) place: Place,
    pub(super) run: fn(&mut Context) -> Result<()>,
}

/// When a step runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// In its turn, one after the other.
    Front,
    /// Beside those of the front, from the beginning; those of one lane one after the other.
    Beside(Lane),
    /// Beside those of the front, once all is built.
    BesideBuilt(Lane),
}

/// Steps of one lane run one after the other: they wait for each other anyway.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lane {
    Python,
    Valgrind,
    Documents,
}

/// State that steps share.
#[derive(Default)]
pub(super) struct Context {
    /// A step may add to it.
    pub(super) totals: Totals,
    /// The packages whose tests run; all, if there are none here.
    pub(super) packages: Vec<String>,
    /// Whether the step `build` runs too.
    pub(super) builds: bool,
    /// Whether it has run.
    pub(super) is_built: bool,
    /// Whether the step `test` runs too.
    pub(super) tests: bool,
    /// The tests that run since the build began.
    pub(super) running: Option<Running>,
    /// CPU time that they took before their own step began.
    pub(super) early: Duration,
}

/// The step that builds what others run.
pub(super) const BUILD: &str = "build";

/// The step that runs the suites, each as soon as it is built.
pub(super) const TEST: &str = "test";

pub(super) static STEPS: &[Step] = &[
    Step { name: "fmt", place: Place::Front, run: fmt },
    Step { name: "tidy", place: Place::Beside(Lane::Documents), run: |_| crate::tidy::run(&[]) },
    Step { name: "licences", place: Place::Front, run: |_| crate::licences::run(&[]) },
    Step { name: "deny", place: Place::Front, run: deny },
    Step { name: "clippy", place: Place::Front, run: clippy },
    Step { name: BUILD, place: Place::Front, run: build },
    Step { name: TEST, place: Place::Front, run: tests },
    Step { name: "python-tools", place: Place::Beside(Lane::Python), run: |_| crate::python::prepare() },
    Step {
        name: "python",
        place: Place::BesideBuilt(Lane::Python),
        run: |context| crate::python::test(context.is_built),
    },
    Step {
        name: "instructions",
        place: Place::Beside(Lane::Valgrind),
        run: |_| crate::instructions::run(&[]),
    },
    Step { name: "examples", place: Place::BesideBuilt(Lane::Documents), run: examples },
    Step {
        name: "reference",
        place: Place::BesideBuilt(Lane::Documents),
        run: |_| crate::docs::check_reference(),
    },
    Step {
        name: "manual",
        place: Place::BesideBuilt(Lane::Documents),
        run: |_| crate::manual::run(&["--check".to_owned()]),
    },
    Step { name: "doc", place: Place::BesideBuilt(Lane::Documents), run: |_| crate::library_docs::build() },
];

/// The long forms, which `--long` adds: `docs/trust.md` says what each does beyond its short form.
pub(super) static LONG: &[Step] = &[
    Step { name: "long-wheel", place: Place::Front, run: |_| crate::python::test_wheel() },
    Step { name: "long-suites", place: Place::Front, run: long_suites },
    Step {
        name: "long-leaks",
        place: Place::Front,
        run: |_| release_example("bilux-accel", "leak_hunt", &[]),
    },
    Step {
        name: "long-agreement",
        place: Place::Front,
        run: |_| release_example("bilux-validation", "agreement", &["--seconds", "3"]),
    },
];

fn fmt(_: &mut Context) -> Result<()> {
    component("fmt", "rustfmt")?;
    run_step(&["fmt", "--all", "--", "--check"]).context("run `cargo fmt --all`")
}

/// Known faults of the packages that we build on, their licences and where they come from: by `cargo-deny` and `deny.toml`,
/// where it is installed.
fn deny(_: &mut Context) -> Result<()> {
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

fn clippy(context: &mut Context) -> Result<()> {
    component("clippy", "clippy")?;
    if context.builds && build::lints() {
        println!("the step {BUILD} lints what it compiles");
        return Ok(());
    }
    run_step(&["clippy", "--locked", "--workspace", "--all-targets", "--", "--deny", "warnings"])
}

fn build(context: &mut Context) -> Result<()> {
    if !context.tests {
        return build::all()?.without_warnings();
    }
    let running = Running::start(suites_of(context, false));
    let built = build::watched(|message| running.add(message))?;
    context.early = running.cpu_time();
    context.running = Some(running);
    built.without_warnings()
}

/// Examples are left out: it is clear that they compile, and these do not run.
fn tests(context: &mut Context) -> Result<()> {
    context.early = Duration::ZERO;
    match context.running.take() {
        Some(running) => running.finish(&mut context.totals),
        None => suites::run(suites_of(context, false), &mut context.totals),
    }
}

/// The tests with more samples, rays, seeds and cases.
fn long_suites(context: &mut Context) -> Result<()> {
    suites::run(suites_of(context, true), &mut context.totals)
}

fn suites_of(context: &Context, is_long: bool) -> Options {
    Options { packages: context.packages.clone(), is_long }
}

/// The examples in the documentation of the libraries.
fn examples(context: &mut Context) -> Result<()> {
    let mut sum = Totals::default();
    let mut command = build::cargo(&["test", "--locked", "--workspace", "--doc", "--no-fail-fast"]);
    let ok = run_watched(&mut command, |line| sum += Totals::read_closing(line).unwrap_or_default())?;
    context.totals += sum;
    match (ok, sum.passed + sum.failed) {
        (true, 1..) => Ok(()),
        (_, 0) => bail!("no example ran"),
        _ => bail!("an example failed: see above"),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_about_trust_lists_the_long_steps() {
        let page = std::fs::read_to_string(crate::process::root().join("docs/trust.md")).unwrap();
        for step in LONG {
            assert!(page.contains(&format!("`{}`", step.name)), "{}", step.name);
        }
    }
}
