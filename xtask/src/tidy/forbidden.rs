//! Words that never belong in the repository: marks of unfinished work, paths of one machine, host names of package
//! registries, and names that were replaced.

use super::repository::Repository;
use super::violation::Violation;

const UNFINISHED: &str = "finish it, or leave it out";
const ONE_MACHINE: &str = "the path of one machine";
const OLD_NAME: &str = "a name that was replaced by the field's own (CHANGELOG.md, \"Renamed\")";
const HOST: &str = "the host name of a package registry: name the package instead";

/// The word, and why it is forbidden.
const WORDS: &[(&str, &str)] = &[
    ("todo!", UNFINISHED),
    ("unimplemented!", UNFINISHED),
    ("TODO", UNFINISHED),
    ("FIXME", UNFINISHED),
    ("/work/", ONE_MACHINE),
    ("/root/", ONE_MACHINE),
    ("/home/", ONE_MACHINE),
    ("/Users/", ONE_MACHINE),
    ("crates.io", HOST),
    ("docs.rs", HOST),
    ("pypi.org", HOST),
    ("npmjs.", HOST),
    ("eeing without rays", OLD_NAME),
    ("exture by formula", OLD_NAME),
    ("extures by formula", OLD_NAME),
    ("MOST_", OLD_NAME),
    ("Onlooker", OLD_NAME),
    ("tell_faults", OLD_NAME),
    ("foreseen", OLD_NAME),
    ("foresaw", OLD_NAME),
    ("TameRay", OLD_NAME),
    ("Ingredients", OLD_NAME),
    ("Spoilt", OLD_NAME),
    ("spoilt", OLD_NAME),
    ("Unprinted", OLD_NAME),
    ("matt\"", OLD_NAME),
    ("is_told", OLD_NAME),
    ("are_told", OLD_NAME),
    ("told_of", OLD_NAME),
    ("_as_met", OLD_NAME),
    ("worked_out", OLD_NAME),
    ("lamps_alone", OLD_NAME),
    ("trouble_at", OLD_NAME),
    ("untaught", OLD_NAME),
];

/// Files in which such words are unavoidable: this list, and files with text copied from elsewhere.
const EXEMPT: &[&str] = &["xtask/src/tidy/forbidden.rs", "Cargo.lock", "fuzz/Cargo.lock", "LICENSES.txt"];

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    let mut violations = Vec::new();
    for file in repository.files.iter().filter(|file| !EXEMPT.contains(&file.path.as_str())) {
        let is_history = |why: &str| why == OLD_NAME && file.path == "CHANGELOG.md";
        for (word, why) in WORDS.iter().filter(|(word, why)| file.text.contains(word) && !is_history(why)) {
            for (number, _) in file.text.lines().enumerate().filter(|(_, line)| line.contains(word)) {
                violations.push(Violation::new(&file.path, number + 1, format!("'{word}': {why}")));
            }
        }
    }
    violations
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_planted_word_is_found() {
        for (word, why) in WORDS {
            let text = format!("fine\nnot {word}fine\n");
            let found = check(&Repository::planted(&[("docs/a.md", &text), ("Cargo.lock", &text)]));
            assert_eq!(found, [Violation::new("docs/a.md", 2, format!("'{word}': {why}"))]);
        }
    }
}
