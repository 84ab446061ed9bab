//! The build that the steps of `cargo xtask test` share.
//!
//! Where nobody has developed yet, as in a fresh clone, clippy compiles the workspace: its driver is a rustc that lints too, so
//! nothing is read and checked a second time. What it leaves is not what `cargo test` would reuse, so whoever develops here has
//! the two apart.

use crate::process::{self, IS_FRESH};
use anyhow::{Context, Result, bail};
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::LazyLock;

/// All libraries, tests and what these run, by one command: cargo chooses the features of shared dependencies for all that a
/// command builds, so another choice of packages would build nearly everything a second time.
const ALL: &[&str] = &["build", "--locked", "--workspace", "--lib", "--tests"];

/// Targets that are linted besides.
const REST: &[&str] = &["--bins", "--examples"];

/// Results of a build by cargo.
#[derive(Default)]
pub(crate) struct Built {
    /// Cargo's messages about each file.
    pub(crate) artifacts: Vec<Value>,
    /// The package of each build script, and the variables that it has set.
    variables: Vec<(String, Vec<(String, String)>)>,
    /// Number of warnings.
    warnings: usize,
}

/// Whether the build lints too.
pub(crate) fn lints() -> bool {
    DRIVER.is_some()
}

/// Clippy's driver, if it compiles the workspace.
static DRIVER: LazyLock<Option<PathBuf>> = LazyLock::new(|| {
    let sysroot =
        Command::new("rustc").args(["--print", "sysroot"]).current_dir(process::root()).output().ok()?;
    let sysroot = PathBuf::from(String::from_utf8(sysroot.stdout).ok()?.trim());
    let driver = sysroot.join("bin").join(format!("clippy-driver{}", std::env::consts::EXE_SUFFIX));
    driver.is_file().then_some(driver).filter(|_| *IS_FRESH)
});

/// A command for cargo that finds what [`all`] has built.
pub(crate) fn cargo(arguments: &[&str]) -> Command {
    let mut command = process::cargo(arguments);
    if let Some(driver) = &*DRIVER {
        command.env("RUSTC_WORKSPACE_WRAPPER", driver).env("CLIPPY_ARGS", "");
    }
    command
}

/// Builds everything. Warnings are printed, and are no error.
pub(crate) fn all() -> Result<Built> {
    watched(|_| Ok(()))
}

/// Builds everything, and shows each of cargo's messages about a file as soon as the file is built.
pub(crate) fn watched(mut watch: impl FnMut(&Value) -> Result<()>) -> Result<Built> {
    let rest = if lints() { REST } else { &[] };
    let mut command = cargo(&[ALL, rest, &["--message-format=json"]].concat());
    let mut child = command.stdout(Stdio::piped()).spawn().context("cannot start cargo")?;
    let stdout = child.stdout.take().context("cargo has no standard output")?;
    let (mut built, mut watched) = (Built::default(), Ok(()));
    for line in BufReader::new(stdout).lines() {
        let before = built.artifacts.len();
        built.read(&line?);
        watched = watched.and_then(|()| built.artifacts[before..].iter().try_for_each(&mut watch));
    }
    watched?;
    if !child.wait()?.success() {
        bail!("cargo cannot build the workspace: see above");
    }
    Ok(built)
}

impl Built {
    fn read(&mut self, line: &str) {
        let Ok(mut message) = serde_json::from_str::<Value>(line) else { return };
        match message["reason"].as_str() {
            Some("compiler-artifact") => self.artifacts.push(message),
            Some("build-script-executed") => self.variables.extend(variables(&message)),
            Some("compiler-message") => {
                let message = message["message"].take();
                self.warnings += usize::from(message["level"] == "warning" && !message["spans"][0].is_null());
                eprint!("{}", message["rendered"].as_str().unwrap_or_default());
            }
            _ => {}
        }
    }

    /// Variables that the build script of a package has set for its compilation.
    pub(crate) fn variables(&self, package: &str) -> impl Iterator<Item = (&str, &str)> {
        let of = self.variables.iter().filter(move |(id, _)| id == package);
        of.flat_map(|(_, list)| list.iter().map(|(name, value)| (name.as_str(), value.as_str())))
    }

    /// An error if there were warnings.
    pub(crate) fn without_warnings(&self) -> Result<()> {
        match self.warnings {
            0 => Ok(()),
            count => bail!("{count} warnings: see above"),
        }
    }
}

fn variables(message: &Value) -> Option<(String, Vec<(String, String)>)> {
    let pair = |pair: &Value| Some((pair[0].as_str()?.to_owned(), pair[1].as_str()?.to_owned()));
    let list = message["env"].as_array()?.iter().filter_map(pair).collect();
    Some((message["package_id"].as_str()?.to_owned(), list))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_are_counted() {
        let mut built = Built::default();
        built.read("no JSON");
        built.read(r#"{"reason": "compiler-artifact", "target": {}}"#);
        // The last line of a crate, which counts its warnings.
        built.read(
            r#"{"reason": "compiler-message", "message": {"level": "warning", "spans": [], "rendered": ""}}"#,
        );
        assert!(built.without_warnings().is_ok());
        built.read(r#"{"reason": "compiler-message", "message": {"level": "warning", "spans": [{}], "rendered": ""}}"#);
        built.read(r#"{"reason": "build-script-executed", "package_id": "a", "env": [["COMMIT", "1"]]}"#);
        assert_eq!(built.variables("a").collect::<Vec<_>>(), [("COMMIT", "1")]);
        assert_eq!((built.artifacts.len(), built.warnings), (1, 1));
        assert_eq!(built.without_warnings().unwrap_err().to_string(), "1 warnings: see above");
    }
}
