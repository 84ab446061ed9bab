//! `cargo xtask mutants [--since COMMIT] [-- MORE]`: plants small bugs with the tool cargo-mutants in the lines that
//! have changed since a commit, and reports which of them no test noticed.

use crate::process::{cargo, output, root, target_folder};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

/// The folder of each crate, and the packages whose tests cover it: the consequences of one crate's mathematics are
/// mostly tested in the crates above it.
const SUITES: &[(&str, &[&str])] = &[
    ("math", &["bilux-math", "bilux-accel", "bilux-scene", "bilux-transport"]),
    ("accel", &["bilux-accel"]),
    ("visibility", &["bilux-visibility"]),
    ("scene", &["bilux-scene", "bilux-transport", "bilux-validation"]),
    ("transport", &["bilux-transport", "bilux-validation"]),
    ("import", &["bilux-import", "bilux-formats"]),
    ("meshes", &["bilux-meshes", "bilux-formats"]),
    ("gltf", &["bilux-gltf", "bilux-formats"]),
    ("usd", &["bilux-usd", "bilux-formats"]),
    ("dcc", &["bilux-dcc", "bilux-formats"]),
    ("renderers", &["bilux-renderers", "bilux-formats"]),
    ("step", &["bilux-step", "bilux-formats"]),
    ("formats", &["bilux-formats", "bilux-validation"]),
    ("pictures", &["bilux-pictures", "bilux"]),
    ("bilux", &["bilux", "bilux-cli"]),
    ("bench", &["bilux-bench"]),
    ("cli", &["bilux-cli"]),
    ("validation", &["bilux-validation"]),
    ("testing", &["bilux-testing"]),
    ("viewer", &["bilux-viewer"]),
];

/// Seconds: a mutant that loops is stopped after this time, and no test takes as long by itself.
const MIN_TIMEOUT: &str = "120";

/// The arguments of the chore.
#[derive(Debug, PartialEq)]
struct Arguments<'a> {
    /// Plants bugs in what has changed since this commit.
    since: &'a str,
    /// Further arguments for cargo-mutants itself.
    more: &'a [String],
}

/// Runs the tool once for each crate with changes, since each crate has its own test suites.
pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let Arguments { since, more } = read(arguments)?;
    if !is_installed() {
        bail!("cargo-mutants is not installed: `cargo install --locked cargo-mutants` installs it");
    }
    let folder = target_folder().join("mutants");
    fs::create_dir_all(&folder).with_context(|| format!("cannot make the folder {}", folder.display()))?;
    let mut survivors = Vec::new();
    for (name, suites) in SUITES {
        let sources = format!("crates/{name}/src");
        let changes = output(Command::new("git").args(["diff", since, "--", &sources]).current_dir(root()))?;
        if changes.is_empty() {
            continue;
        }
        println!("==> {sources}: changes since {since}, held against the tests of {}", suites.join(", "));
        let (diff, out) = (folder.join(format!("{name}.diff")), folder.join(name));
        fs::write(&diff, changes).with_context(|| format!("cannot write {}", diff.display()))?;
        plant(name, suites, &diff, &out, more)?;
        survivors.extend(listed(&out.join("mutants.out/missed.txt"))?);
    }
    report(&survivors)
}

fn read(arguments: &[String]) -> Result<Arguments<'_>> {
    let (own, more) = match arguments.iter().position(|argument| argument == "--") {
        Some(end) => (&arguments[..end], &arguments[end + 1..]),
        None => (arguments, &[][..]),
    };
    let since = match own {
        [] => "HEAD^",
        [flag, commit] if flag == "--since" && !commit.starts_with('-') => commit,
        _ => bail!("usage: cargo xtask mutants [--since COMMIT] [-- ARGUMENTS OF CARGO-MUTANTS]"),
    };
    Ok(Arguments { since, more })
}

fn is_installed() -> bool {
    let mut version = cargo(&["mutants", "--version"]);
    version.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|status| status.success())
}

/// Plants bugs in one crate. Surviving bugs are not a failure of the tool.
fn plant(name: &str, suites: &[&str], diff: &Path, out: &Path, more: &[String]) -> Result<()> {
    let mut command = cargo(&["mutants", "--in-diff"]);
    command.arg(diff).arg("--output").arg(out);
    command.args(["--package", &package_in(name), "--test-package", &suites.join(",")]);
    command.args(["--minimum-test-timeout", MIN_TIMEOUT, "--timeout-multiplier", "3"]).args(more);
    let status = command.status().context("cannot start cargo-mutants")?;
    // Exit status 2: some bugs survived; 3: some ran out of time, which counts as noticed.
    match status.code() {
        Some(0 | 2 | 3) => Ok(()),
        _ => bail!("cargo-mutants failed ({status})"),
    }
}

/// The package whose folder is `crates/NAME`.
fn package_in(name: &str) -> String {
    if name == "bilux" { name.to_owned() } else { format!("bilux-{name}") }
}

/// The lines of a file; none if there is no such file, for example because nothing that has changed can be mutated.
fn listed(path: &Path) -> Result<Vec<String>> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let text = fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    Ok(text.lines().map(str::to_owned).collect())
}

fn report(survivors: &[String]) -> Result<()> {
    if survivors.is_empty() {
        println!("\nno planted bug survived");
        return Ok(());
    }
    println!("\nno test noticed:");
    survivors.iter().for_each(|survivor| println!("  {survivor}"));
    bail!("{} planted bugs survived: write a test for each, or say why none is needed", survivors.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<String> {
        text.split_whitespace().map(str::to_owned).collect()
    }

    #[test]
    fn arguments_after_two_dashes_are_passed_on() {
        assert_eq!(read(&[]).unwrap(), Arguments { since: "HEAD^", more: &[] });
        let given = words("--since main -- --in-place -j 2");
        assert_eq!(read(&given).unwrap(), Arguments { since: "main", more: &words("--in-place -j 2") });
        for wrong in ["--since", "main", "--since -- -j 2", "--sinc main"] {
            let message = read(&words(wrong)).unwrap_err().to_string();
            assert!(message.starts_with("usage: cargo xtask mutants"), "{wrong}: {message}");
        }
    }

    #[test]
    fn every_crate_has_its_suites() {
        let mut folders: Vec<String> = fs::read_dir(root().join("crates"))
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            // Its tests are in Python, and the tool runs those of cargo.
            .filter(|name| name != "python")
            .collect();
        let mut known: Vec<&str> = SUITES.iter().map(|(name, _)| *name).collect();
        folders.sort();
        known.sort_unstable();
        assert_eq!(folders, known);
        for (name, suites) in SUITES {
            assert!(suites.contains(&&*package_in(name)), "the tests of {name} itself");
        }
    }

    #[test]
    fn surviving_mutants_fail_the_chore() {
        assert!(report(&[]).is_ok());
        let error = report(&words("a.rs:1:replace b.rs:2:replace")).unwrap_err().to_string();
        assert!(error.starts_with("2 planted bugs survived"), "{error}");
        assert_eq!(listed(Path::new("there/is/none")).unwrap(), Vec::<String>::new());
    }
}
