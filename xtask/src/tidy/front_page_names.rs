//! The README names everything that a user can choose by name, and all tutorials are two links away from it: lists that
//! somebody has to remember grow old. The names come from the reference, which is generated from the tables.

use super::repository::Repository;
use super::violation::Violation;

const README: &str = "README.md";
const REFERENCE: &str = "docs/reference/README.md";
const TUTORIALS: &str = "docs/tutorials/";

/// The pages of the reference whose names the README lists in the line that links there.
const LISTED: &[&str] = &[
    "integrators",
    "accels",
    "materials",
    "phases",
    "densities",
    "lights",
    "cameras",
    "generators",
    "tonemaps",
];

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    let text = |path| repository.file(path).map_or("", |file| file.text.as_str());
    let (readme, reference) = (text(README), text(REFERENCE));
    let mut violations = Vec::new();
    for page in LISTED {
        let Some(names) = reference.lines().find(|line| line.contains(&format!("]({page}.md): "))) else {
            violations.push(Violation::new(REFERENCE, 0, format!("has no line of names for '{page}'")));
            continue;
        };
        let link = format!("(docs/reference/{page}.md)");
        let Some((number, line)) = readme.lines().enumerate().find(|(_, line)| line.contains(&link)) else {
            violations.push(Violation::new(README, 0, format!("does not link to docs/reference/{page}.md")));
            continue;
        };
        for name in names.split('`').skip(1).step_by(2).filter(|name| !line.contains(&format!("`{name}`"))) {
            violations.push(Violation::new(README, number + 1, format!("does not name '{name}' of {page}")));
        }
    }
    let index = text("docs/tutorials/README.md");
    let pages = repository.files.iter().filter_map(|file| file.path.strip_prefix(TUTORIALS));
    for page in pages.filter(|page| page.ends_with(".md") && *page != "README.md") {
        if !index.contains(&format!("]({page})")) {
            let message = format!("is not listed in {TUTORIALS}README.md");
            violations.push(Violation::new(&format!("{TUTORIALS}{page}"), 0, message));
        }
    }
    if !readme.contains("(docs/tutorials/README.md)") {
        violations.push(Violation::new(README, 0, format!("does not link to {TUTORIALS}README.md")));
    }
    violations
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(readme: &str, tutorials: &str) -> Vec<String> {
        let reference: String = LISTED.iter().map(|page| format!("- [P]({page}.md): `a`, `b`\n")).collect();
        let files = [
            (README, readme),
            (REFERENCE, &reference),
            ("docs/tutorials/README.md", tutorials),
            ("docs/tutorials/fog.md", ""),
            ("docs/tutorials/wax.md", ""),
        ];
        check(&Repository::planted(&files)).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn names_and_tutorials_that_are_missing_are_found() {
        let link = |page: &&str| format!("`a` `b` (docs/reference/{page}.md)\n");
        let readme = LISTED.iter().map(link).collect::<String>() + "(docs/tutorials/README.md)";
        let tutorials = "[f](fog.md) [w](wax.md)";
        assert_eq!(found(&readme, tutorials), [""; 0]);
        let one = readme.replacen("`a` `b` (docs/reference/cameras", "`a` `bb` (docs/reference/cameras", 1);
        assert!(matches!(&found(&one, tutorials)[..], [one] if one.contains("'b' of cameras")));
        let unlinked = readme.replace("reference/lights.md", "reference/light.md");
        assert!(matches!(&found(&unlinked, tutorials)[..], [one] if one.contains("reference/lights.md")));
        assert!(matches!(&found(&readme, "[f](fog.md)")[..], [one] if one.contains("wax.md")));
        assert_eq!(found(&readme.replace("(docs/tutorials", "(docs"), tutorials).len(), 1);
    }
}
