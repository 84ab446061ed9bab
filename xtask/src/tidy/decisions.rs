//! A decision record begins with its decision: a paragraph comes right after the title.

use super::repository::Repository;
use super::violation::Violation;

const FOLDER: &str = "docs/adr/";

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    let records = repository.files.iter().filter(|file| is_record(&file.path));
    let late = records.filter(|file| {
        let mut lines = file.text.lines().skip(1).skip_while(|line| line.is_empty());
        lines
            .next()
            .is_none_or(|line| ["#", "|", "- ", "```", "!["].iter().any(|start| line.starts_with(start)))
    });
    late.map(|file| Violation::new(&file.path, 3, "does not begin with its decision, in a few sentences"))
        .collect()
}

/// Whether a path is that of a numbered record.
fn is_record(path: &str) -> bool {
    path.strip_prefix(FOLDER).is_some_and(|name| name.bytes().take(4).all(|byte| byte.is_ascii_digit()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_without_a_decision_at_the_top_are_found() {
        let good = ("docs/adr/0001-a.md", "# 0001: A\n\nThis is what we do.\n\n## Context\nWhy.\n");
        let late = ("docs/adr/0002-b.md", "# 0002: B\n\n## Context\nWhy.\n\n## Decision\nThis.\n");
        let other = ("docs/adr/README.md", "# Records\n\n- one\n");
        let found = check(&Repository::planted(&[good, late, other]));
        assert_eq!(found.iter().map(|one| one.path.as_str()).collect::<Vec<_>>(), ["docs/adr/0002-b.md"]);
        assert_eq!(check(&Repository::planted(&[("docs/adr/0003-c.md", "# 0003: C\n")])).len(), 1);
    }
}
