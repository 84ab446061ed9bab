//! Every dependency of the workspace is justified in `docs/adr/dependencies.md`, by a line of its table that begins
//! `` | `name` | ``; some crate uses it; and no line there is about a dependency that is gone. If a crate declares a
//! dependency, its code names it.

use super::repository::Repository;
use super::violation::Violation;
use crate::process::root;
use crate::workspace::Package;
use std::path::Path;

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
    violations.extend(
        repository
            .packages
            .iter()
            .filter(|package| package.member)
            .flat_map(|member| unnamed(repository, member)),
    );
    violations
}

/// The dependencies that a crate declares although its code never names them.
fn unnamed(repository: &Repository, member: &Package) -> Vec<Violation> {
    let folder = member.folder.strip_prefix(root()).unwrap_or(&member.folder);
    let code: Vec<_> =
        repository.rust().filter(|(file, _)| Path::new(&file.path).starts_with(folder)).collect();
    let names = |name: &str| {
        let word = name.replace('-', "_");
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        code.iter().any(|(_, rust)| rust.code.split(|c| !is_word(c)).any(|other| other == word))
    };
    let unnamed = member.dependencies.iter().filter(|name| !names(name));
    unnamed.map(|name| Violation::new(&member.name, 0, format!("never names '{name}': delete it"))).collect()
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

    #[test]
    fn planted_differences_are_found() {
        let manifest = "[workspace.dependencies]\nours = { path = \"x\" }\n# why\nglam = \"1\"\nlibm = \"1\"\n\n[x]\ny = 1\n";
        let page = "| `glam` | vectors |\n| `gone` | no more |\n";
        let code = "use libm::sin; // stl_io\n";
        let files =
            [(MANIFEST, manifest), (PAGE, page), ("crates/a/src/lib.rs", code), ("b.rs", "stl_io::f()")];
        let mut repository = Repository::planted(&files);
        let dependencies = vec!["libm".to_owned(), "stl-io".to_owned()];
        let (name, folder) = ("a".to_owned(), root().join("crates/a"));
        repository.packages.push(Package { name, folder, member: true, dependencies, ..Package::default() });
        let found: Vec<_> = check(&repository).iter().map(ToString::to_string).collect();
        assert_eq!(
            found,
            [
                "Cargo.toml:4: no crate uses 'glam': delete it",
                "Cargo.toml:5: nothing argues for 'libm' in docs/adr/dependencies.md",
                "docs/adr/dependencies.md: argues for 'gone', which is no dependency",
                "a: never names 'stl-io': delete it",
            ]
        );
    }
}
