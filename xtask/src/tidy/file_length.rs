//! A file can be read in one sitting: at most 400 lines before its tests. Split a longer one along its concepts; a
//! table of data may go on the list of exceptions, with the reason.

use super::repository::Repository;
use super::violation::Violation;

const LONGEST: usize = 400;

/// Path, maximum number of lines, reason.
const EXCEPTIONS: &[(&str, usize, &str)] = &[];

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    check_with(repository, EXCEPTIONS)
}

fn check_with(repository: &Repository, exceptions: &[(&str, usize, &str)]) -> Vec<Violation> {
    let mut violations = Vec::new();
    for (file, _) in repository.rust().filter(|(file, _)| !file.is_test()) {
        let lines = file.lines_before_tests();
        let exception = exceptions.iter().find(|exception| exception.0 == file.path);
        let longest = exception.map_or(LONGEST, |exception| exception.1);
        if lines > longest {
            let message = format!("{lines} lines before the tests, {longest} at most: split it");
            violations.push(Violation::new(&file.path, 0, message));
        } else if exception.is_some() && lines <= LONGEST {
            violations.push(Violation::new(&file.path, 0, "needs no exception any more: delete it"));
        }
    }
    violations
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_lines_before_the_tests_count() {
        let long = "\n".repeat(401);
        let tested = format!("{}#[cfg(test)]\n{long}", "\n".repeat(400));
        let files = [("a.rs", long.as_str()), ("b.rs", &tested), ("c/tests/d.rs", &long), ("e.md", &long)];
        let repository = Repository::planted(&files);
        let found: Vec<_> = check_with(&repository, &[]).into_iter().map(|found| found.path).collect();
        assert_eq!(found, ["a.rs"]);
        assert!(check_with(&repository, &[("a.rs", 401, "data")]).is_empty());
        assert_eq!(check_with(&repository, &[("a.rs", 401, ""), ("b.rs", 500, "")]).len(), 1, "not needed");
    }
}
