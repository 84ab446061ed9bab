//! The steps and the packages that changed files reach.

use super::steps::STEPS;
use crate::process::root;
use crate::workspace::Package;
use std::collections::BTreeSet;
use std::fmt;

/// Changes there reach everything.
const EVERYTHING: &[&str] = &["Cargo.toml", "Cargo.lock", "clippy.toml", "rustfmt.toml", ".cargo/", "xtask/"];

/// Changes in these folders, or of files that are named so, reach these steps, and the tests of these packages, which read
/// them. The first row counts that fits.
const ROWS: &[Row] = &[
    Row("crates/python/python/", &["python"], &[]),
    Row("crates/python/tests/", &["python"], &[]),
    Row("crates/python/examples/", &["python"], &[]),
    Row("crates/python/pyproject.toml", &["python"], &[]),
    Row("crates/python/README.md", &["python", "manual"], &[]),
    Row("docs/adr/", &["manual"], &["xtask"]),
    Row("docs/lab/", &["manual"], &["xtask"]),
    Row("docs/reference/", &["manual", "reference"], &["xtask", "bilux-cli"]),
    Row("docs/", &["manual", "reference", "python"], &["xtask", "bilux-cli", "bilux-formats"]),
    Row("README.md", &["manual", "python"], &["xtask", "bilux-cli"]),
    Row("fuzz/corpus/", &[], &["bilux-accel", "bilux-pictures", "bilux-formats", "bilux-cli"]),
    Row("fuzz/", &[], &[]),
    Row("scenes/", &["manual", "python"], &["bilux-formats", "bilux-cli", "bilux-validation"]),
    Row("deny.toml", &["deny"], &[]),
    Row("LICENSES.txt", &["licences", "python"], &["bilux-cli"]),
    Row("LICENSE-", &["licences"], &[]),
    Row(".ci/", &[], &[]),
    Row(".git", &[], &[]),
    Row(".editorconfig", &[], &[]),
];

struct Row(&'static str, &'static [&'static str], &'static [&'static str]);

/// Why a step is left out.
const REASONS: &[(&str, &str)] = &[
    ("licences", "the dependencies are as before"),
    ("deny", "the dependencies are as before"),
    ("clippy", "no Rust code has changed"),
    ("build", "no test that runs has changed, nor what it reads"),
    ("test", "no test has changed, nor what it reads"),
    ("python-tools", "the step python is left out"),
    ("python", "neither the package, its pages nor what it is built from has changed"),
    ("instructions", "neither bilux-accel nor bilux-math has changed"),
    ("examples", "no Rust code has changed"),
    ("reference", "neither its pages nor what bilux-cli is built from has changed"),
    ("manual", "no page has changed"),
    ("doc", "no Rust code has changed"),
];

/// Steps and packages that changes reach.
#[derive(Debug, Default)]
pub(super) struct Reached {
    /// Number of files that differ, and the commit that they differ from.
    heading: String,
    steps: BTreeSet<&'static str>,
    /// Packages whose tests are reached.
    pub(super) packages: Vec<String>,
    /// Packages whose tests are not.
    spared: Vec<String>,
    /// The file that reaches everything, if there is one.
    whole: Option<String>,
}

impl Reached {
    /// The reach of these files, which differ from a commit.
    pub(super) fn by(base: &str, files: &[String], packages: &[Package]) -> Reached {
        let heading = format!("{} files differ from {base}", files.len());
        let members: Vec<&Package> = packages.iter().filter(|package| package.member).collect();
        let mut reach = Reach {
            members: &members,
            steps: BTreeSet::new(),
            tests: BTreeSet::new(),
            code: BTreeSet::new(),
        };
        let whole = files.iter().find(|file| !reach.add(file)).cloned();
        if whole.is_some() {
            let steps = STEPS.iter().map(|step| step.name).collect();
            return Reached { heading, steps, whole, ..Reached::default() };
        }
        reach.close();
        if !files.is_empty() {
            reach.steps.extend(["fmt", "tidy"]);
        }
        let (tests, spared): (Vec<_>, Vec<_>) = members
            .iter()
            .map(|package| package.name.clone())
            .partition(|name| reach.tests.contains(&**name));
        Reached { heading, steps: reach.steps, packages: tests, spared, whole }
    }

    /// Whether a step is reached; the long ones always are, whoever asks for them.
    pub(super) fn has(&self, step: &str) -> bool {
        self.steps.contains(step) || STEPS.iter().all(|known| known.name != step)
    }
}

impl fmt::Display for Reached {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}", self.heading)?;
        if let Some(file) = &self.whole {
            return write!(out, "; {file} reaches everything");
        }
        if self.steps.contains("test") {
            write!(out, "; tests of: {}", self.packages.join(", "))?;
            if !self.spared.is_empty() {
                write!(
                    out,
                    "\nleft out: tests of {}, which do not depend on these files",
                    self.spared.join(", ")
                )?;
            }
        }
        for step in STEPS.iter().filter(|step| !self.steps.contains(step.name)) {
            let reason = REASONS.iter().find(|(name, _)| *name == step.name);
            write!(
                out,
                "\nleft out: {}: {}",
                step.name,
                reason.map_or("nothing has changed", |(_, why)| why)
            )?;
        }
        Ok(())
    }
}

/// The reach of files, while they are added.
struct Reach<'a> {
    members: &'a [&'a Package],
    steps: BTreeSet<&'static str>,
    /// Packages whose tests are reached, by name.
    tests: BTreeSet<&'a str>,
    /// Packages whose code has changed.
    code: BTreeSet<&'a str>,
}

impl<'a> Reach<'a> {
    /// Adds a file. Returns false if it may reach everything.
    fn add(&mut self, file: &str) -> bool {
        if EVERYTHING.iter().any(|path| file.starts_with(path)) {
            return false;
        }
        if let Some(Row(_, steps, tests)) = ROWS.iter().find(|row| file.starts_with(row.0)) {
            self.steps.extend(*steps);
            self.tests.extend(*tests);
            return true;
        }
        let inside = |package: &&&Package| {
            let folder = package.folder.strip_prefix(root()).unwrap_or(&package.folder);
            std::path::Path::new(file).starts_with(folder)
        };
        let Some(package) = self.members.iter().find(inside) else {
            // Pages in the root, which others than the tests read.
            self.steps.insert("manual");
            self.tests.insert("xtask");
            return file.ends_with(".md");
        };
        let folder = package.folder.strip_prefix(root()).unwrap_or(&package.folder);
        let is_own = ["tests", "examples", "benches"].iter().any(|part| {
            std::path::Path::new(file).starts_with(folder.join(part))
                && !SHARED.iter().any(|path| file.starts_with(path))
        });
        self.tests.insert(&package.name);
        if is_own {
            self.steps.insert("clippy");
        } else {
            self.code.insert(&package.name);
        }
        true
    }

    /// Adds what depends on code that has changed, and the steps that all this needs.
    fn close(&mut self) {
        let uses = |package: &Package, code: &BTreeSet<&str>| {
            package.shipped.iter().any(|name| code.contains(&**name))
        };
        while let Some(package) = self
            .members
            .iter()
            .find(|package| !self.code.contains(&*package.name) && uses(package, &self.code))
        {
            self.code.insert(&package.name);
        }
        let is_tested = |package: &&&Package| {
            self.code.contains(&*package.name)
                || package.dependencies.iter().any(|name| self.code.contains(&**name))
        };
        let tested: Vec<&str> = self.members.iter().filter(is_tested).map(|package| &*package.name).collect();
        self.tests.extend(tested);
        let has = |name: &str| self.code.contains(name);
        let steps: [(bool, &[&'static str]); 5] = [
            (!self.code.is_empty(), &["clippy", "examples", "doc"]),
            (has("bilux-python") || has("bilux-cli"), &["python"]),
            (has("bilux-cli"), &["reference"]),
            (has("bilux-accel") || has("bilux-math"), &["instructions"]),
            (!self.tests.is_empty(), &["build", "test"]),
        ];
        steps.iter().filter(|(is_reached, _)| *is_reached).for_each(|(_, names)| self.steps.extend(*names));
        for (step, needed) in [("python", "build"), ("reference", "build"), ("python", "python-tools")] {
            if self.steps.contains(step) {
                self.steps.insert(needed);
            }
        }
    }
}

/// Files beside the tests of one package that those of others include.
const SHARED: &[&str] = &["crates/accel/tests/suite/support/"];

#[cfg(test)]
mod tests {
    use super::*;

    /// `bilux-math`, `bilux-accel` on it, `bilux-cli` on both, `bilux-python` beside it; `bilux-testing` is for tests of `bilux-accel`.
    fn packages() -> Vec<Package> {
        let package = |folder: &str, dependencies: &[&str], shipped: usize| Package {
            name: if folder == "xtask" {
                folder.to_owned()
            } else {
                format!("bilux-{}", folder.trim_start_matches("crates/"))
            },
            folder: root().join(folder),
            member: true,
            dependencies: dependencies.iter().map(|name| (*name).to_owned()).collect(),
            shipped: dependencies[..shipped].iter().map(|name| (*name).to_owned()).collect(),
            ..Package::default()
        };
        vec![
            package("crates/math", &[], 0),
            package("crates/testing", &["bilux-math"], 1),
            package("crates/accel", &["bilux-math", "bilux-testing"], 1),
            package("crates/cli", &["bilux-accel", "bilux-math"], 2),
            package("crates/python", &["bilux-accel"], 1),
            package("xtask", &[], 0),
        ]
    }

    fn reached(files: &[&str]) -> Reached {
        let files: Vec<String> = files.iter().map(|file| (*file).to_owned()).collect();
        Reached::by("abc", &files, &packages())
    }

    /// Files; the steps that they reach beside fmt and tidy; the packages whose tests they reach.
    const CASES: &[(&[&str], &str, &str)] = &[
        (&[".gitignore", "fuzz/fuzz_targets/ply.rs"], "", ""),
        (&["docs/adr/0001-workspace.md"], "build manual test", "xtask"),
        (&["docs/models.md"], "build manual python python-tools reference test", "bilux-cli xtask"),
        (&["GLOSSARY.md"], "build manual test", "xtask"),
        (&["deny.toml"], "deny", ""),
        (&["crates/python/python/bilux/a.py"], "build python python-tools", ""),
        (&["crates/accel/tests/suite/pick.rs"], "build clippy test", "bilux-accel"),
        (
            &["crates/cli/src/main.rs"],
            "build clippy doc examples python python-tools reference test",
            "bilux-cli",
        ),
        (&["crates/testing/src/lib.rs"], "build clippy doc examples test", "bilux-testing bilux-accel"),
        (
            &["crates/accel/src/lib.rs"],
            "build clippy doc examples instructions python python-tools reference test",
            "bilux-accel bilux-cli bilux-python",
        ),
        (&["crates/python/src/lib.rs"], "build clippy doc examples python python-tools test", "bilux-python"),
    ];

    #[test]
    fn changes_reach_what_reads_them() {
        for (files, steps, tests) in CASES {
            let reached = reached(files);
            let others = reached.steps.iter().copied().filter(|step| !["fmt", "tidy"].contains(step));
            assert_eq!(others.collect::<Vec<_>>().join(" "), *steps, "{files:?}");
            assert_eq!(reached.packages.join(" "), *tests, "{files:?}");
            assert!(reached.has("fmt") && reached.has("tidy") && reached.has("long-leaks"), "{files:?}");
        }
        let nothing = reached(&[]);
        assert!(nothing.steps.is_empty() && nothing.packages.is_empty());
    }

    #[test]
    fn some_files_reach_everything() {
        for file in ["Cargo.lock", "xtask/src/main.rs", ".cargo/config.toml", "a-new-folder/file"] {
            let reached = reached(&["docs/models.md", file]);
            assert!(STEPS.iter().all(|step| reached.has(step.name)) && reached.packages.is_empty(), "{file}");
            assert_eq!(reached.to_string(), format!("2 files differ from abc; {file} reaches everything"));
        }
    }

    #[test]
    fn what_is_left_out_has_a_reason() {
        assert!(REASONS.iter().all(|(name, _)| STEPS.iter().any(|step| step.name == *name)));
        let text = reached(&["crates/cli/tests/suite/a.rs"]).to_string();
        assert!(
            text.starts_with("1 files differ from abc; tests of: bilux-cli\nleft out: tests of bilux-math, "),
            "{text}"
        );
        assert!(text.contains("\nleft out: manual: no page has changed\n"), "{text}");
    }
}
