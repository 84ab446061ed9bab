//! Every dependency of the workspace is argued for in `docs/adr/dependencies.md`, by a line of its table
//! that begins `` | `name` | ``; some crate uses it; and no line there speaks of one that is gone.

use super::Violation;
use super::repository::Repository;

const PAGE: &str = "docs/adr/dependencies.md";
const MANIFEST: &str = "Cargo.toml";

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    let page = repository.file(PAGE).map_or("", |file| &file.text);
    let manifest = repository.file(MANIFEST).map_or("", |file| &file.text);
    let argued: Vec<_> = page.lines().filter_map(first_cell).collect();
    let declared = declared(manifest);
    let mut violations = Vec::new();
    for (name, line) in &declared {
        if !argued.contains(name) {
            violations.push(Violation::new(
                MANIFEST,
                *line,
                format!("nothing argues for '{name}' in {PAGE}"),
            ));
        }
        if !is_used(repository, name) {
            violations.push(Violation::new(MANIFEST, *line, format!("no crate uses '{name}': delete it")));
        }
    }
    for name in argued.iter().filter(|name| declared.iter().all(|(other, _)| other != *name)) {
        violations.push(Violation::new(PAGE, 0, format!("argues for '{name}', which is no dependency")));
    }
    violations
}

/// The names in `[workspace.dependencies]` that are not our own crates, with their lines.
fn declared(manifest: &str) -> Vec<(&str, usize)> {
    let lines = manifest.lines().enumerate().map(|(number, line)| (number + 1, line));
    let section = lines.skip_while(|(_, line)| *line != "[workspace.dependencies]").skip(1);
    let section = section.take_while(|(_, line)| !line.starts_with('['));
    let keys = section.filter(|(_, line)| !line.starts_with('#') && !line.contains("path = "));
    keys.filter_map(|(number, line)| Some((line.split_once(" = ")?.0, number))).collect()
}

fn first_cell(line: &str) -> Option<&str> {
    line.strip_prefix("| `")?.split_once("` |").map(|(name, _)| name)
}

fn is_used(repository: &Repository, name: &str) -> bool {
    let mut members = repository.packages.iter().filter(|package| package.member);
    members.any(|member| member.dependencies.iter().any(|dependency| dependency == name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workspace::Package;

    #[test]
    fn planted_differences_are_found() {
        let manifest = "[workspace.dependencies]\nours = { path = \"x\" }\n# why\nglam = \"1\"\nlibm = \"1\"\n\n[x]\ny = 1\n";
        let page = "| `glam` | vectors |\n| `gone` | no more |\n";
        let mut repository = Repository::planted(&[(MANIFEST, manifest), (PAGE, page)]);
        let dependencies = vec!["libm".to_owned()];
        repository.packages.push(Package { member: true, dependencies, ..Package::default() });
        let found: Vec<_> = check(&repository).iter().map(ToString::to_string).collect();
        assert_eq!(
            found,
            [
                "Cargo.toml:4: no crate uses 'glam': delete it",
                "Cargo.toml:5: nothing argues for 'libm' in docs/adr/dependencies.md",
                "docs/adr/dependencies.md: argues for 'gone', which is no dependency",
            ]
        );
    }
}
