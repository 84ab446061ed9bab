//! Every relative link of a page leads to a file of the repository, and every decision record is linked from the
//! records' own front page.

use super::repository::{Repository, TextFile};
use super::violation::Violation;
use crate::process::root;

const RECORDS: &str = "docs/adr/";
const FRONT: &str = "docs/adr/README.md";

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    let pages = repository.files.iter().filter(|file| file.path.ends_with(".md"));
    let mut violations: Vec<_> = pages.flat_map(|page| broken_links(repository, page)).collect();
    violations.extend(unlinked_records(repository));
    violations
}

fn broken_links(repository: &Repository, page: &TextFile) -> Vec<Violation> {
    let mut violations = Vec::new();
    for (number, line) in page.text.lines().enumerate() {
        for target in links(line).filter(|target| !target.contains("://") && !target.starts_with('#')) {
            let target = target.split('#').next().unwrap_or_default();
            let path = resolve(&page.path, target);
            if repository.file(&path).is_none() && !root().join(&path).exists() {
                let message = format!("the link '{target}' leads nowhere");
                violations.push(Violation::new(&page.path, number + 1, message));
            }
        }
    }
    violations
}

/// The targets of the links in a line, `[text](target)`.
fn links(line: &str) -> impl Iterator<Item = &str> {
    line.split("](").skip(1).filter_map(|rest| rest.split_once(')').map(|(target, _)| target))
}

/// Resolves a target relative to a page, as a path from the root.
fn resolve(page: &str, target: &str) -> String {
    let mut parts: Vec<&str> = page.split('/').collect();
    parts.pop();
    for part in target.split('/') {
        match part {
            "" | "." => {}
            ".." => drop(parts.pop()),
            name => parts.push(name),
        }
    }
    parts.join("/")
}

fn unlinked_records(repository: &Repository) -> Vec<Violation> {
    let front = repository.file(FRONT).map_or("", |file| &file.text);
    let linked: Vec<_> = front.lines().flat_map(links).map(|target| resolve(FRONT, target)).collect();
    let records = repository.files.iter().map(|file| &file.path);
    let records = records.filter(|path| path.starts_with(RECORDS) && *path != FRONT);
    let unlinked = records.filter(|path| !linked.contains(path));
    unlinked.map(|path| Violation::new(path, 0, format!("is not linked from {FRONT}"))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planted_links_are_found() {
        let front = "[a](0001-a.md) [web](https://example.org/x) [up](../../README.md#top)\n";
        let repository = Repository::planted(&[
            ("README.md", "fine\n[gone](docs/gone.md)\n"),
            (FRONT, front),
            ("docs/adr/0001-a.md", ""),
            ("docs/adr/0002-b.md", ""),
        ]);
        let found: Vec<_> = check(&repository).into_iter().map(|found| (found.path, found.line)).collect();
        let expected = [("README.md", 2), ("docs/adr/0002-b.md", 0)];
        assert_eq!(found, expected.map(|(path, line)| (path.to_owned(), line)));
    }

    #[test]
    fn targets_are_seen_from_their_page() {
        assert_eq!(resolve("docs/adr/README.md", "../../README.md"), "README.md");
        assert_eq!(resolve("README.md", "./docs/a.md"), "docs/a.md");
    }
}
