//! `cargo xtask verdicts`: runs the statistical suites whole, and compares their verdicts with those that are recorded; with
//! `--write`, records them. Names of crates restrict it to their suites.

use crate::process::{cargo, cpu_time, output, root, target_folder};
use anyhow::{Context, Result, anyhow, bail};
use bilux_testing::verdicts::records::{Key, Records};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

/// The file of verdicts.
pub(crate) const FILE: &str = "crates/testing/verdicts.txt";
/// The file of budgets.
pub(crate) const BUDGETS: &str = "crates/testing/budgets.txt";

/// Limits to the growth of a crate's tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Budget<'a> {
    /// The crate.
    pub(crate) name: &'a str,
    /// The number of tests in its sources.
    pub(crate) tests: u32,
    /// CPU seconds of its suite where all comparisons run whole; `None` if it has no comparisons.
    pub(crate) seconds: Option<u32>,
}

/// Reads the file of budgets.
pub(crate) fn budgets(text: &str) -> Result<Vec<Budget<'_>>, String> {
    let lines = text.lines().enumerate().filter(|(_, line)| !line.starts_with('#'));
    let wrong = |number, line| format!("line {number}: '{line}' is not a crate, its tests and its seconds");
    lines.map(|(i, line)| read_budget(line).ok_or_else(|| wrong(i + 1, line))).collect()
}

fn read_budget(line: &str) -> Option<Budget<'_>> {
    let mut words = line.split_whitespace();
    let (name, tests) = (words.next()?, words.next()?.parse().ok()?);
    let seconds = words.next().map(str::parse).transpose().ok()?;
    words.next().is_none().then_some(Budget { name, tests, seconds })
}

/// Runs the suites, and compares or writes.
pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let text = fs::read_to_string(root().join(BUDGETS)).with_context(|| format!("cannot read {BUDGETS}"))?;
    let budgets = budgets(&text).map_err(|wrong| anyhow!("{BUDGETS}: {wrong}"))?;
    let (is_write, suites) = chosen(arguments, &budgets)?;
    let mut found = Records::default();
    for suite in built(&suites, suites.len() < budgets.iter().filter(|b| b.seconds.is_some()).count())? {
        record(&suite, &mut found)?;
    }
    let known = fs::read_to_string(root().join(FILE)).map_err(|error| error.to_string());
    let known = known.and_then(|text| Records::parse(&text)).unwrap_or_else(|wrong| {
        println!("{FILE} is of no use: {wrong}");
        Records::default()
    });
    let differences = differences(&known, &found, &suites);
    differences.iter().for_each(|line| println!("{line}"));
    println!("{} verdicts, {} not as recorded", found.verdicts.len(), differences.len());
    if is_write {
        let text = merged(known, found, &suites).to_text();
        return fs::write(root().join(FILE), text).with_context(|| format!("cannot write {FILE}"));
    }
    if !differences.is_empty() {
        bail!("if that is wanted, `cargo xtask verdicts --write`");
    }
    Ok(())
}

/// Whether to write, and the suites: those that are named, or all that have comparisons.
fn chosen<'a>(arguments: &[String], budgets: &[Budget<'a>]) -> Result<(bool, Vec<&'a str>)> {
    let all: Vec<&str> =
        budgets.iter().filter(|budget| budget.seconds.is_some()).map(|budget| budget.name).collect();
    let named: Vec<&String> = arguments.iter().filter(|word| *word != "--write").collect();
    if let Some(name) = named.iter().find(|name| !all.contains(&name.as_str())) {
        bail!("'{name}' has no comparisons (there are those of {})", all.join(", "));
    }
    let is_chosen = |name: &&str| named.is_empty() || named.iter().any(|word| word == name);
    Ok((named.len() < arguments.len(), all.into_iter().filter(is_chosen).collect()))
}

/// The binary of a suite.
struct Suite {
    name: String,
    binary: PathBuf,
    folder: PathBuf,
}

/// Builds the suites: with all other tests, as the step `build` does, or if only `some` are asked for, alone.
fn built(suites: &[&str], some: bool) -> Result<Vec<Suite>> {
    let mut command = cargo(&["test", "--locked", "--no-run", "--message-format", "json"]);
    if some {
        for suite in suites {
            command.args(["--package", suite]);
        }
        command.args(["--test", "suite"]);
    } else {
        command.args(["--workspace", "--tests"]);
    }
    let text = output(&mut command)?;
    let artifacts = text.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let found: Vec<Suite> = artifacts.filter_map(|artifact| suite_of(&artifact, suites)).collect();
    match suites.iter().find(|name| found.iter().all(|suite| suite.name != **name)) {
        Some(name) => bail!("cargo built no suite of {name}"),
        None => Ok(found),
    }
}

fn suite_of(artifact: &Value, suites: &[&str]) -> Option<Suite> {
    let is_suite = artifact["target"]["name"] == "suite" && artifact["target"]["kind"][0] == "test";
    let binary = PathBuf::from(artifact["executable"].as_str().filter(|_| is_suite)?);
    let folder = PathBuf::from(artifact["manifest_path"].as_str()?).parent()?.to_owned();
    let text = fs::read_to_string(folder.join("Cargo.toml")).ok()?;
    let name = text.lines().find_map(|line| line.strip_prefix("name = \"")?.strip_suffix('"'))?;
    suites.contains(&name).then(|| Suite { name: name.to_owned(), binary, folder })
}

/// Runs a suite whole, and adds its verdicts and its CPU time.
fn record(suite: &Suite, records: &mut Records) -> Result<()> {
    let folder = target_folder().join("verdicts").join(&suite.name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    println!("==> {}", suite.name);
    let start = cpu_time();
    let mut command = Command::new(&suite.binary);
    command.current_dir(&suite.folder).env_remove("BILUX_LONG").env("BILUX_VERDICTS_OUT", &folder);
    crate::process::run(&mut command).context("a test failed, so nothing is recorded")?;
    let seconds = cpu_time().unwrap_or_default().saturating_sub(start.unwrap_or_default());
    records.seconds.insert(suite.name.clone(), seconds.as_secs());
    for file in fs::read_dir(&folder)? {
        for line in fs::read_to_string(file?.path())?.lines() {
            records.add(line).map_err(|wrong| anyhow!("{}: {wrong}", suite.name))?;
        }
    }
    Ok(())
}

/// Records of these suites that are new, gone, or otherwise than before.
fn differences(known: &Records, found: &Records, suites: &[&str]) -> Vec<String> {
    let keys = |records: &Records| -> BTreeSet<Key> {
        records.verdicts.keys().filter(|key| suites.contains(&key.suite.as_str())).cloned().collect()
    };
    let all = keys(known).union(&keys(found)).cloned().collect::<Vec<_>>();
    let numbers = |numbers: &[f64]| numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let line = |key: &Key| {
        let what = match (known.verdicts.get(key), found.verdicts.get(key)) {
            (Some(_), None) => "gone".to_owned(),
            (None, Some(new)) => format!("new: {}", numbers(&new.numbers)),
            (Some(old), Some(new)) if old != new => {
                format!("{}, before {}", numbers(&new.numbers), numbers(&old.numbers))
            }
            _ => return None,
        };
        Some(format!("{} {} '{}': {what}", key.suite, key.test, key.case))
    };
    all.iter().filter_map(line).collect()
}

/// The new records of these suites beside the old ones of others. CPU seconds stay if they are about the same, so that a file in which
/// nothing changed stays as it is.
fn merged(known: Records, found: Records, suites: &[&str]) -> Records {
    let mut all = found;
    for (suite, before) in &known.seconds {
        let now = all.seconds.entry(suite.clone()).or_insert(*before);
        if now.abs_diff(*before) * 10 <= *before {
            *now = *before;
        }
    }
    let others = known.verdicts.into_iter().filter(|(key, _)| !suites.contains(&key.suite.as_str()));
    all.verdicts.extend(others);
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_testing::verdicts::Hash;
    use bilux_testing::verdicts::records::Record;

    fn records(verdicts: &[(&str, &str, f64)], seconds: &[(&str, u64)]) -> Records {
        let verdict = |(suite, test, number): &(&str, &str, f64)| {
            let key = Key { suite: (*suite).into(), test: (*test).into(), case: "fog".into() };
            let firsts = vec![Hash::of(b"picture")];
            (key, Record { asked: "12".into(), firsts, numbers: vec![*number] })
        };
        Records {
            seconds: seconds.iter().map(|(suite, seconds)| ((*suite).into(), *seconds)).collect(),
            verdicts: verdicts.iter().map(verdict).collect(),
        }
    }

    #[test]
    fn budgets_are_read() {
        let read = budgets("# a\nb 12 40\nc 3\n").unwrap();
        let wanted = [("b", 12, Some(40)), ("c", 3, None)];
        assert_eq!(read, wanted.map(|(name, tests, seconds)| Budget { name, tests, seconds }));
        for wrong in ["b", "b x", "b 1 x", "b 1 2 3", ""] {
            assert!(budgets(&format!("{wrong}\n")).unwrap_err().starts_with("line 1: "), "{wrong}");
        }
    }

    #[test]
    fn suites_are_chosen_by_name() {
        let budgets = budgets("a 1 2\nb 1\nc 1 2\n").unwrap();
        let of = |line: &str| {
            let words: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
            chosen(&words, &budgets).map_err(|error| error.to_string())
        };
        assert_eq!(of(""), Ok((false, vec!["a", "c"])));
        assert_eq!(of("c --write"), Ok((true, vec!["c"])));
        assert_eq!(of("b"), Err("'b' has no comparisons (there are those of a, c)".to_owned()));
    }

    #[test]
    fn differences_are_listed_and_others_kept() {
        let known = records(&[("a", "x", 0.5), ("a", "y", 0.5), ("b", "x", 0.5)], &[("a", 100), ("b", 7)]);
        let found = records(&[("a", "x", 0.25), ("a", "z", 0.5)], &[("a", 105)]);
        let lines = differences(&known, &found, &["a"]);
        assert_eq!(lines, ["a x 'fog': 0.25, before 0.5", "a y 'fog': gone", "a z 'fog': new: 0.5"]);
        let wanted = records(&[("a", "x", 0.25), ("a", "z", 0.5), ("b", "x", 0.5)], &[("a", 100), ("b", 7)]);
        assert_eq!(merged(known, found, &["a"]), wanted);
    }
}
