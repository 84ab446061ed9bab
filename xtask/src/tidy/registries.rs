//! Every table of variants is named in `ARCHITECTURE.md`, so that readers find where to add one, and is a `static`: a constant is
//! evaluated, and what its rows name compiled, again in each crate that reads it.

use super::repository::Repository;
use super::violation::Violation;

const PAGE: &str = "ARCHITECTURE.md";

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    let page = repository.file(PAGE).map_or("", |file| &file.text);
    let mut violations = Vec::new();
    for (file, rust) in repository.rust().filter(|(file, _)| file.path.starts_with("crates/")) {
        for (number, line) in rust.code.lines().enumerate() {
            let Some((name, is_static)) = table(line) else { continue };
            let mut add = |message: String| violations.push(Violation::new(&file.path, number + 1, message));
            if !page.contains(&format!("`{name}`")) {
                add(format!("the table `{name}` is not named in {PAGE}"));
            }
            if !is_static {
                add(format!(
                    "the table `{name}` is compiled again in each crate that reads it: make it a `static`"
                ));
            }
        }
    }
    violations
}

/// The name of the table that a line declares, `pub static NAMES: &[NameEntry]`, and whether it is a `static`.
fn table(line: &str) -> Option<(&str, bool)> {
    let line = line.trim();
    let (is_static, rest) = match line.strip_prefix("pub static ") {
        Some(rest) => (true, rest),
        None => (false, line.strip_prefix("pub const ")?),
    };
    let (name, kind) = rest.split_once(": &[")?;
    kind.split(']').next()?.ends_with("Entry").then_some((name, is_static))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_planted_table_is_found() {
        let text = "pub static LIGHTS: &[LightEntry] = &[];\npub const N: &[u8] = &[];\n";
        let silent = Repository::planted(&[("crates/a/src/lib.rs", text), (PAGE, "")]);
        let found = check(&silent);
        assert_eq!(found.len(), 1);
        assert!(found[0].message.contains("`LIGHTS`"), "{found:?}");
        let named = Repository::planted(&[("crates/a/src/lib.rs", text), (PAGE, "the table `LIGHTS`")]);
        assert!(check(&named).is_empty());
        let constant = text.replace("pub static", "pub const");
        let found = check(&Repository::planted(&[("crates/a/src/lib.rs", &constant), (PAGE, "`LIGHTS`")]));
        assert!(found.len() == 1 && found[0].message.contains("make it a `static`"), "{found:?}");
    }
}
