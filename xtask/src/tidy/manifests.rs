//! Every crate inherits its version, edition, licence and lints from the workspace.

use super::repository::Repository;
use super::violation::Violation;

const INHERITED: &[&str] = &[
    "version.workspace = true",
    "edition.workspace = true",
    "license.workspace = true",
    "[lints]\nworkspace = true",
];

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    let is_ours = |path: &str| path.starts_with("crates/") || path.starts_with("xtask/");
    let manifests = repository.files.iter();
    let manifests = manifests.filter(|file| is_ours(&file.path) && file.path.ends_with("/Cargo.toml"));
    let mut violations = Vec::new();
    for manifest in manifests {
        for line in INHERITED.iter().filter(|line| !manifest.text.contains(**line)) {
            let message = format!("does not say `{}`", line.replace('\n', " "));
            violations.push(Violation::new(&manifest.path, 0, message));
        }
    }
    violations
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_planted_crate_without_lints_is_found() {
        let whole = INHERITED.join("\n");
        let without = whole.replace("[lints]\n", "");
        let files = [("crates/a/Cargo.toml", whole.as_str()), ("crates/b/Cargo.toml", &without)];
        let found = check(&Repository::planted(&files));
        let expected = "does not say `[lints] workspace = true`";
        assert_eq!(found, [Violation::new("crates/b/Cargo.toml", 0, expected)]);
    }
}
