//! Every table of variants is named in `ARCHITECTURE.md`, so that readers find where to add one.

use super::repository::Repository;
use super::violation::Violation;

const PAGE: &str = "ARCHITECTURE.md";

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    let page = repository.file(PAGE).map_or("", |file| &file.text);
    let mut violations = Vec::new();
    for (file, rust) in repository.rust().filter(|(file, _)| file.path.starts_with("crates/")) {
        for (number, line) in rust.code.lines().enumerate() {
            if let Some(name) = table(line).filter(|name| !page.contains(&format!("`{name}`"))) {
                let message = format!("the table `{name}` is not named in {PAGE}");
                violations.push(Violation::new(&file.path, number + 1, message));
            }
        }
    }
    violations
}

/// The name of the table that a line declares: `pub const NAMES: &[NameEntry]`.
fn table(line: &str) -> Option<&str> {
    let (name, kind) = line.trim().strip_prefix("pub const ")?.split_once(": &[")?;
    kind.split(']').next()?.ends_with("Entry").then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_planted_table_is_found() {
        let text = "pub const LIGHTS: &[LightEntry] = &[];\npub const N: &[u8] = &[];\n";
        let silent = Repository::planted(&[("crates/a/src/lib.rs", text), (PAGE, "")]);
        let found = check(&silent);
        assert_eq!(found.len(), 1);
        assert!(found[0].message.contains("`LIGHTS`"), "{found:?}");
        let named = Repository::planted(&[("crates/a/src/lib.rs", text), (PAGE, "the table `LIGHTS`")]);
        assert!(check(&named).is_empty());
    }
}
