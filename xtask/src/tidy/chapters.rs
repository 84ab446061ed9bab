//! Every page of `docs` is a chapter of the manual: a page that no list leads to is not read. To satisfy it, add the page
//! to `docs/SUMMARY.md`.

use super::repository::Repository;
use super::violation::Violation;
use crate::manual::{SUMMARY, unlisted};

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    let summary = repository.file(SUMMARY).map_or("", |file| &file.text);
    match unlisted(summary, repository.files.iter().map(|file| file.path.as_str())) {
        Ok(pages) => {
            pages.iter().map(|page| Violation::new(page, 0, format!("is not listed in {SUMMARY}"))).collect()
        }
        Err(error) => vec![Violation::new(SUMMARY, 0, error.to_string())],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_that_is_not_listed_is_found() {
        let summary = "# Summary\n\n- [A](a.md)\n";
        let files = [(SUMMARY, summary), ("docs/a.md", ""), ("docs/x/b.md", ""), ("crates/c.md", "")];
        let found = check(&Repository::planted(&files));
        assert_eq!(found.iter().map(|found| found.path.as_str()).collect::<Vec<_>>(), ["docs/x/b.md"]);
        assert_eq!(check(&Repository::planted(&[(SUMMARY, "# Summary\nwords\n")])).len(), 1);
    }
}
