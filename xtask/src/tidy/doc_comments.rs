//! A doc comment begins with what it describes, a noun or a verb: "Distance along the ray", "Adds a light". One that begins with a
//! pronoun or a question word makes the reader look for its subject. Texts that users see (help, Python's docstrings, generated
//! files) may begin otherwise.

use super::repository::{Repository, TextFile};
use super::violation::Violation;

/// The first words that are refused.
const REFUSED: &[&str] =
    &["What", "How", "Where", "Those", "That", "Who", "Whoever", "It", "Its", "The same"];

/// Files whose doc comments users see: they are Python's docstrings, help of the command line, or generated from tables.
const SHOWN: &[&str] = &[
    "crates/python/src/",
    "crates/cli/src/arguments/",
    "crates/bilux/src/request/settings.rs",
    "crates/scene/src/typed/cameras.rs",
    "crates/scene/src/typed/lights.rs",
    "crates/scene/src/typed/materials.rs",
];

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    let hidden = |path: &str| !SHOWN.iter().any(|shown| path.starts_with(shown));
    repository.rust().filter(|(file, _)| hidden(&file.path)).flat_map(|(file, _)| found(file)).collect()
}

fn found(file: &TextFile) -> Vec<Violation> {
    let mut before = "";
    let mut violations = Vec::new();
    for (number, line) in file.text.lines().map(str::trim_start).enumerate() {
        let first = ["/// ", "//! "].into_iter().find_map(|mark| {
            let text = line.strip_prefix(mark)?;
            (!before.starts_with(mark.trim_end())).then_some(text)
        });
        let refused = first.and_then(|text| {
            REFUSED.iter().find(|word| {
                text.strip_prefix(**word).is_some_and(|rest| !rest.starts_with(char::is_alphanumeric))
            })
        });
        if let Some(word) = refused {
            let message = format!("a doc comment begins with '{word}', not with what it describes");
            violations.push(Violation::new(&file.path, number + 1, message));
        }
        before = line;
    }
    violations
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn doc_comments_that_begin_with_a_pronoun_are_found() {
        let text = "//! What a lamp is.\n//! How it shines.\n\nstruct A {\n    /// Its colour.\n    /// What else.\n    a: u8,\n    /// Whatever.\n    b: u8,\n    // How\n    /// The same for a\n    /// The samely.\n    c: u8,\n}\n";
        let files = [("crates/a/src/lib.rs", text), ("crates/python/src/scene.rs", text)];
        let found: Vec<_> = check(&Repository::planted(&files)).iter().map(|one| one.line).collect();
        assert_eq!(found, [1, 5, 11]);
    }
}
