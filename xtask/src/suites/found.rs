//! The binaries of tests that cargo builds, and the tests in each.

use crate::process;
use anyhow::{Context, Result};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// One binary of tests.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Suite {
    /// The package and the target, as in `bilux-accel suite`; of a library, the package alone.
    pub(super) name: String,
    pub(super) package: String,
    pub(super) program: PathBuf,
    /// The folder of the package, where cargo too runs its tests.
    pub(super) folder: PathBuf,
    pub(super) tests: Vec<String>,
    /// Whether its tests lie beside the package's sources.
    pub(super) is_integration: bool,
}

impl Suite {
    /// Whether its tests may start a program of its package, which it does not contain: those of a library or a program cannot.
    pub(super) fn starts_programs(&self) -> bool {
        self.is_integration && ["src/main.rs", "src/bin"].iter().any(|place| self.folder.join(place).exists())
    }

    /// The binary as a command, in the surroundings that `cargo test` gives it. What it finds by `env!` is built in.
    pub(super) fn command(&self) -> Command {
        let mut command = Command::new(&self.program);
        command.current_dir(&self.folder).env("CARGO_MANIFEST_DIR", &self.folder);
        command
            .env("CARGO_MANIFEST_PATH", self.folder.join("Cargo.toml"))
            .env("CARGO_PKG_NAME", &self.package);
        command
    }
}

/// The binary that one of cargo's messages is about and the tests in it, if it has tests and is of one of the packages; of any, if
/// none is named.
pub(super) fn listed(message: &Value, packages: &[String]) -> Result<Option<Suite>> {
    let Some(mut suite) = suite(message) else { return Ok(None) };
    if !packages.is_empty() && !packages.contains(&suite.package) {
        return Ok(None);
    }
    let listed = process::output(suite.command().args(["--list", "--format", "terse"]));
    suite.tests = tests(&listed.with_context(|| format!("the tests of {} cannot be listed", suite.name))?);
    Ok(Some(suite).filter(|suite| !suite.tests.is_empty()))
}

/// The binary of tests that one of cargo's messages is about.
fn suite(message: &Value) -> Option<Suite> {
    if message["profile"]["test"] != true {
        return None;
    }
    let folder = Path::new(message["manifest_path"].as_str()?).parent()?;
    let package = package(message["package_id"].as_str()?, folder)?;
    let target = &message["target"];
    let is_library = target["kind"][0].as_str()?.contains("lib");
    let name = if is_library { package.clone() } else { format!("{package} {}", target["name"].as_str()?) };
    let program = PathBuf::from(message["executable"].as_str()?);
    let is_integration = target["kind"][0] == "test";
    Some(Suite { name, package, program, folder: folder.to_owned(), tests: Vec::new(), is_integration })
}

/// The name in `path+file:///a/b#name@1.0`, or in `path+file:///a/name#1.0`, where it is that of the folder.
fn package(id: &str, folder: &Path) -> Option<String> {
    let (_, named) = id.rsplit_once('#')?;
    let name = named.split_once('@').map(|(name, _)| name.to_owned());
    name.or_else(|| Some(folder.file_name()?.to_string_lossy().into_owned()))
}

/// The names in lines such as `a::b: test`.
fn tests(listed: &str) -> Vec<String> {
    listed.lines().filter_map(|line| line.strip_suffix(": test")).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn binaries_of_tests_are_found_among_artifacts() {
        let artifact = |id: &str, kind: &str, is_test: bool, program: Value| {
            json!({ "package_id": id, "manifest_path": "/r/crates/cli/Cargo.toml",
                "target": { "kind": [kind], "name": "suite" }, "profile": { "test": is_test }, "executable": program })
        };
        let cli = "path+file:///r/crates/cli#bilux-cli@0.1.0";
        let messages = [
            artifact(cli, "test", true, json!("/t/suite-1")),
            artifact(cli, "lib", true, json!("/t/cli-1")),
            artifact(cli, "lib", false, Value::Null),
            artifact(cli, "bin", false, json!("/t/bilux")),
            artifact("path+file:///r/crates/cli#0.1.0", "test", true, json!("/t/suite-2")),
        ];
        let found: Vec<Suite> = messages.iter().filter_map(suite).collect();
        let names: Vec<_> =
            found.iter().map(|suite| (&*suite.name, suite.program.to_str().unwrap())).collect();
        assert_eq!(
            names,
            [("bilux-cli suite", "/t/suite-1"), ("bilux-cli", "/t/cli-1"), ("cli suite", "/t/suite-2")]
        );
        assert!(found.iter().all(|suite| suite.folder == Path::new("/r/crates/cli")));
        // Only those beside the sources of a package with a program wait for it.
        let starts = |folder: &str, is_integration| {
            Suite { folder: crate::process::root().join(folder), is_integration, ..Suite::default() }
                .starts_programs()
        };
        assert_eq!(found.iter().map(|suite| suite.is_integration).collect::<Vec<_>>(), [true, false, true]);
        assert_eq!([starts("crates/cli", true), starts("crates/cli", false)], [true, false]);
        assert_eq!([starts("crates/math", true), starts("xtask", true)], [false, true]);
    }

    #[test]
    fn tests_are_listed() {
        assert_eq!(tests("a::b: test\nc: test\nd: benchmark\n\n2 tests, 1 benchmark\n"), ["a::b", "c"]);
    }
}
