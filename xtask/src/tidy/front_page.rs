//! The README has exactly two commands for a fresh machine, each alone in its block, and continuous integration runs
//! the second of them and nothing else.

use super::repository::Repository;
use super::violation::Violation;

const README: &str = "README.md";
const CI: &str = ".ci/run";
const SECTION: &str = "## Two commands";

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    let readme = repository.file(README).map_or("", |file| &file.text);
    let commands = commands(readme);
    let [_, second] = commands.as_slice() else {
        let message = format!("'{SECTION}' has {} commands in blocks of `sh`, not two", commands.len());
        return vec![Violation::new(README, 0, message)];
    };
    let script = repository.file(CI).map_or("", |file| &file.text);
    if script.lines().last() == Some(second) {
        return Vec::new();
    }
    vec![Violation::new(CI, 0, format!("does not end with the README's second command, `{second}`"))]
}

/// The lines of the section's `sh` blocks.
fn commands(readme: &str) -> Vec<&str> {
    let section = readme.lines().skip_while(|line| *line != SECTION).skip(1);
    let mut inside = false;
    let mut commands = Vec::new();
    for line in section.take_while(|line| !line.starts_with("## ")) {
        match line {
            "```sh" => inside = true,
            "```" => inside = false,
            command if inside => commands.push(command),
            _ => {}
        }
    }
    commands
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str =
        "# X\n## Two commands\n```sh\nmake a\n```\nand\n```sh\nmake b\n```\n## More\n```sh\nc\n```\n";

    #[test]
    fn the_script_runs_the_second_command() {
        let check_script = |script| check(&Repository::planted(&[(README, PAGE), (CI, script)])).len();
        assert_eq!(check_script("#!/bin/sh\nmake b\n"), 0);
        assert_eq!(check_script("#!/bin/sh\nmake b\nmake c\n"), 1);
        let three = PAGE.replace("make b", "make b\nmake c");
        assert_eq!(check(&Repository::planted(&[(README, &three), (CI, "make b\n")])).len(), 1);
    }
}
