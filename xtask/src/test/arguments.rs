//! The steps that the arguments of `cargo xtask test` ask for.

use super::steps::{LONG, STEPS, Step};
use anyhow::{Context, Result, bail};

/// The arguments, read.
pub(super) struct Chosen {
    /// In the order of the tables.
    pub(super) steps: Vec<&'static Step>,
    /// With `--changed`: the commit to compare with, if one is named.
    pub(super) changed: Option<Option<String>>,
    /// With `-p`: the packages whose tests run.
    pub(super) packages: Vec<String>,
}

/// Reads `[--changed [BASE]] [--long] [-p PACKAGE] [STEP ...]`. A word after `--changed` that is no step is the commit.
pub(super) fn read(arguments: &[String]) -> Result<Chosen> {
    let mut words = arguments.iter().peekable();
    let (mut names, mut is_long, mut changed, mut packages) = (Vec::new(), false, None, Vec::new());
    while let Some(word) = words.next() {
        match word.as_str() {
            "--long" => is_long = true,
            "--changed" => {
                let is_base = |word: &&String| !word.starts_with('-') && step(word).is_none();
                changed = Some(words.next_if(is_base).cloned());
            }
            "-p" | "--package" => {
                packages.push(words.next().context("`-p` needs the name of a package")?.clone())
            }
            name => names.push(name),
        }
    }
    if let Some(name) = names.iter().find(|name| step(name).is_none()) {
        let known: Vec<_> = all().map(|step| step.name).collect();
        bail!(
            "there is no step '{name}' (there are: {}; `--long` adds the long ones, `--changed [BASE]` leaves out \
             what a change does not reach)",
            known.join(", ")
        );
    }
    let is_in = |table: &[Step], step: &Step| table.iter().any(|other| other.name == step.name);
    let is_wanted = |step: &&'static Step| {
        (names.is_empty() && is_in(STEPS, step))
            || (is_long && is_in(LONG, step))
            || names.contains(&step.name)
    };
    Ok(Chosen { steps: all().filter(is_wanted).collect(), changed, packages })
}

/// The step of this name.
pub(super) fn step(name: &str) -> Option<&'static Step> {
    all().find(|step| step.name == name)
}

fn all() -> impl Iterator<Item = &'static Step> {
    STEPS.iter().chain(LONG)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chosen(line: &str) -> Chosen {
        read(&line.split_whitespace().map(str::to_owned).collect::<Vec<_>>()).unwrap()
    }

    fn names(line: &str) -> Vec<&'static str> {
        chosen(line).steps.iter().map(|step| step.name).collect()
    }

    #[test]
    fn long_steps_run_only_if_asked_for() {
        assert_eq!(names("").len(), STEPS.len());
        assert_eq!(names("--long").len(), STEPS.len() + LONG.len());
        assert_eq!(names("long-leaks tidy"), ["tidy", "long-leaks"]);
        let wrong = read(&["quick".to_owned()]).err().unwrap().to_string();
        assert!(wrong.starts_with("there is no step 'quick' (there are: fmt, tidy"), "{wrong}");
    }

    #[test]
    fn a_change_has_a_base_or_none() {
        assert_eq!(chosen("tidy").changed, None);
        assert_eq!(chosen("--changed").changed, Some(None));
        assert_eq!(chosen("--changed main --long").changed, Some(Some("main".to_owned())));
        assert_eq!(chosen("--changed tidy fmt").changed, Some(None));
        assert_eq!(names("--changed main tidy"), ["tidy"]);
        assert_eq!(chosen("-p a test --package b").packages, ["a", "b"]);
    }
}
