//! The change log has a section for what is not released yet.

use super::repository::Repository;
use super::violation::Violation;

const LOG: &str = "CHANGELOG.md";

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    let log = repository.file(LOG).map_or("", |file| &file.text);
    if log.lines().any(|line| line == "## Unreleased") {
        return Vec::new();
    }
    vec![Violation::new(LOG, 0, "has no section `## Unreleased`")]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_without_the_section_is_found() {
        assert!(check(&Repository::planted(&[(LOG, "# Changes\n\n## Unreleased\n")])).is_empty());
        assert_eq!(check(&Repository::planted(&[(LOG, "# Changes\n\n## 1.0.0\n")])).len(), 1);
        assert_eq!(check(&Repository::default()).len(), 1);
    }
}
