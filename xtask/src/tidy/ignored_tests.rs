//! No test is ignored: a long test has its own command, and a wrong one is fixed or deleted.

use super::repository::Repository;
use super::violation::Violation;

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    let mut violations = Vec::new();
    for (file, rust) in repository.rust() {
        for (number, line) in rust.code.lines().enumerate() {
            if line.contains("#[ignore") || line.contains(", ignore)]") {
                violations.push(Violation::new(&file.path, number + 1, "an ignored test"));
            }
        }
    }
    violations
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_planted_one_is_found_and_a_comment_is_not() {
        let text = "#[test]\n#[ignore = \"slow\"]\nfn f() {}\n// #[ignore]\n#[cfg_attr(miri, ignore)]\n";
        let found = check(&Repository::planted(&[("a.rs", text)]));
        assert_eq!(found.iter().map(|found| found.line).collect::<Vec<_>>(), [2, 5]);
    }
}
