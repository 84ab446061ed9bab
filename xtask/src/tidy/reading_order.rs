//! `ARCHITECTURE.md` lists the modules of some crates from the bottom up: every module stands in its crate's list, after all
//! that it uses.

use super::circles::arrows;
use super::modules::Modules;
use super::repository::Repository;
use super::violation::Violation;

const PAGE: &str = "ARCHITECTURE.md";

/// The crates that it lists.
const CRATES: &[&str] = &["crates/scene", "crates/transport", "crates/import"];

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    let page = repository.file(PAGE).map_or("", |file| &file.text);
    CRATES.iter().flat_map(|folder| check_crate(page, folder, &Modules::read(repository, folder))).collect()
}

fn check_crate(page: &str, folder: &str, modules: &Modules) -> Vec<Violation> {
    let Some(list) = list(page, folder) else {
        return vec![Violation::new(PAGE, 0, format!("the modules of {folder} are not listed"))];
    };
    let place = |module: &str| list.find(&format!("`{module}`"));
    let mut violations = Vec::new();
    for ((user, used), (file, line)) in arrows(modules).remove(&[][..]).unwrap_or_default() {
        let message = match (place(&user), place(&used)) {
            _ if user == "mod.rs" => continue,
            (Some(user), Some(used)) if used < user => continue,
            (Some(_), Some(_)) => format!("{user} uses {used}, which comes later in {PAGE}"),
            _ => format!("{user} uses {used}, and one of them is not listed in {PAGE}"),
        };
        violations.push(Violation::new(&file, line, message));
    }
    violations
}

/// The list that follows the link to a crate's folder, up to the end of its paragraph.
fn list<'a>(page: &'a str, folder: &str) -> Option<&'a str> {
    let (_, list) = page.split_once(&format!("({folder}/src), from the bottom up:"))?;
    list.split("\n\n").next()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check_list(list: &str) -> Vec<String> {
        let page = format!("[`scene`](crates/scene/src), from the bottom up:\n{list}\n\n`late`\n");
        let repository = Repository::planted(&[
            ("crates/scene/src/lib.rs", "mod mesh;\nmod scene;\n"),
            ("crates/scene/src/mesh/mod.rs", "pub struct Mesh;\n"),
            ("crates/scene/src/scene.rs", "use crate::mesh::Mesh;\nstruct Scene(Mesh);\n"),
        ]);
        let found = check_crate(&page, "crates/scene", &Modules::read(&repository, "crates/scene"));
        found.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn a_planted_wrong_order_is_found() {
        let at = "crates/scene/src/scene.rs:1: scene uses mesh, ";
        assert!(check_list("1. `mesh`;\n2. `scene`").is_empty());
        assert_eq!(check_list("1. `scene`, `mesh`"), [format!("{at}which comes later in {PAGE}")]);
        assert_eq!(check_list("1. `scene`"), [format!("{at}and one of them is not listed in {PAGE}")]);
        assert_eq!(check_crate("", "crates/scene", &Modules::read(&Repository::default(), "")).len(), 1);
    }
}
