//! No circles: where one module uses another, the other one does not lead back to it, neither itself nor by way of
//! further modules. So a crate can be read from its lowest modules up, and a part of it can be understood alone.
//!
//! The rule looks at one folder at a time: at its files and folders, a folder being one module with all that is in it, and at
//! its `mod.rs`. Names that are passed on (`pub use`) count where they are defined. A table that registers variants
//! (`&[LightEntry]`) may name the files of its rows, which use what the table's module defines. Tests may use everything.
//! Move what both sides need into a module below them.

use super::modules::{Module, Modules};
use super::repository::{Repository, TextFile};
use super::violation::Violation;
use std::collections::{BTreeMap, BTreeSet};

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    let folder = |file: &TextFile| Some(file.path.split_once("/src/")?.0.to_owned());
    let crates: BTreeSet<String> = repository.rust().filter_map(|(file, _)| folder(file)).collect();
    crates.iter().flat_map(|folder| check_crate(&Modules::read(repository, folder))).collect()
}

/// Which parts of a folder use which, each with the file and the line of the first use.
pub(super) type Arrows = BTreeMap<(String, String), (String, usize)>;

fn check_crate(modules: &Modules) -> Vec<Violation> {
    arrows(modules).values().flat_map(circles).collect()
}

/// The arrows of each folder, by its place; that of the crate is empty.
pub(super) fn arrows(modules: &Modules) -> BTreeMap<Vec<String>, Arrows> {
    let mut folders: BTreeMap<Vec<String>, Arrows> = BTreeMap::new();
    for user in modules.iter() {
        for (used, line) in modules.used_by(user).filter(|(used, _)| used.place != user.place) {
            let (folder, parts) = parting(user, used);
            let arrows = folders.entry(folder).or_default();
            arrows.entry(parts).or_insert_with(|| (user.file.clone(), line));
        }
    }
    folders
}

/// The folder that has both modules in it, and the parts of that folder to which they belong.
fn parting(user: &Module, used: &Module) -> (Vec<String>, (String, String)) {
    let shared = user.place.iter().zip(&used.place).take_while(|(a, b)| a == b).count();
    let part = |module: &Module| module.place.get(shared).map_or("mod.rs", String::as_str).to_owned();
    (user.place[..shared].to_vec(), (part(user), part(used)))
}

/// One violation for each arrow between parts that reach each other.
fn circles(arrows: &Arrows) -> Vec<Violation> {
    let mut reached: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (from, _) in arrows.keys() {
        let (mut found, mut open) = (BTreeSet::new(), vec![from.as_str()]);
        while let Some(at) = open.pop() {
            let next = arrows.keys().filter(|(user, _)| user == at).map(|(_, used)| used.as_str());
            open.extend(next.filter(|used| found.insert(*used)));
        }
        reached.insert(from, found);
    }
    let reaches = |a: &str, b: &str| reached.get(a).is_some_and(|found| found.contains(b));
    let mut violations = Vec::new();
    for ((from, to), (file, line)) in arrows.iter().filter(|((from, to), _)| reaches(to, from)) {
        let circle: Vec<_> =
            reached[from.as_str()].iter().copied().filter(|part| reaches(part, from)).collect();
        let message = format!("{from} uses {to}, in a circle: {}", circle.join(", "));
        violations.push(Violation::new(file, *line, message));
    }
    violations
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The violations of a crate with these files, below `src/`.
    fn check_files(files: &[(&str, &str)]) -> Vec<String> {
        let path = |file: &str| format!("crates/a/src/{file}");
        let files: Vec<_> = files.iter().map(|(file, text)| (path(file), *text)).collect();
        let files: Vec<_> = files.iter().map(|(file, text)| (file.as_str(), *text)).collect();
        let found = check_crate(&Modules::read(&Repository::planted(&files), "crates/a"));
        let short = |violation: &Violation| {
            let file = violation.path.trim_start_matches("crates/a/src/");
            format!("{file}:{} {}", violation.line, violation.message)
        };
        found.iter().map(short).collect()
    }

    #[test]
    fn a_planted_circle_is_found_with_each_arrow() {
        let lib = "mod film;\nmod plan;\nmod splats;\npub use film::Film;\n";
        let found = check_files(&[
            ("lib.rs", lib),
            ("film.rs", "//! A film.\nuse crate::{plan::Plan, splats::add};\npub struct Film(Plan);\n"),
            ("splats.rs", "pub fn add() { let film: crate::Film; }\n"),
            ("plan.rs", "// use crate::film::Film;\npub struct Plan;\n"),
        ]);
        assert_eq!(
            found,
            [
                "film.rs:2 film uses splats, in a circle: film, splats",
                "splats.rs:1 splats uses film, in a circle: film, splats"
            ]
        );
    }

    #[test]
    fn a_way_round_through_a_folder_is_found() {
        let found = check_files(&[
            ("lib.rs", "mod a;\nmod b;\nmod c;\n"),
            ("a/mod.rs", "mod deep;\n"),
            ("a/deep.rs", "use crate::b;\nfn f() { b::g() }\n"),
            ("b.rs", "use crate::c::all;\npub fn g() { for x in all() {} }\n"),
            ("c.rs", "pub fn all() -> R { R { ..super::a::deep::X } }\n"),
        ]);
        assert_eq!(
            found,
            [
                "a/deep.rs:1 a uses b, in a circle: a, b, c",
                "b.rs:1 b uses c, in a circle: a, b, c",
                "c.rs:1 c uses a, in a circle: a, b, c"
            ]
        );
    }

    #[test]
    fn a_folder_and_its_files_make_no_circle_except_by_a_table() {
        let row = "use super::LightEntry;\npub const ENTRY: LightEntry = LightEntry;\n";
        let table = "mod sun;\npub struct LightEntry;\npub static LIGHTS: &[LightEntry] = &[sun::ENTRY];\n";
        let lib = ("lib.rs", "pub mod lights;\n");
        assert!(check_files(&[lib, ("lights/mod.rs", table), ("lights/sun.rs", row)]).is_empty());
        let built = format!("{table}fn build() {{ sun::build() }}\n");
        let found = check_files(&[lib, ("lights/mod.rs", &built), ("lights/sun.rs", row)]);
        assert_eq!(
            found,
            [
                "lights/mod.rs:4 mod.rs uses sun, in a circle: mod.rs, sun",
                "lights/sun.rs:1 sun uses mod.rs, in a circle: mod.rs, sun"
            ]
        );
    }

    #[test]
    fn names_count_where_they_are_defined() {
        let found = check_files(&[
            ("lib.rs", "mod a;\nmod b;\n"),
            ("a/mod.rs", "mod low;\nmod high;\npub use low::{Low, make as made};\nuse crate::b::B;\n"),
            ("a/low.rs", "pub struct Low;\n"),
            ("a/high.rs", "use super::{B, Low, made};\nuse bilux_math::Rgb as b;\nfn f(b: B) {}\n"),
            ("b.rs", "pub struct B;\n"),
        ]);
        assert!(found.is_empty(), "{found:?}");
    }

    #[test]
    fn tests_may_use_everything() {
        let found = check_files(&[
            ("lib.rs", "mod a;\nmod b;\n#[cfg(test)]\nmod oracle;\n"),
            ("a.rs", "#[cfg(test)]\nuse crate::b::{B, C};\n#[cfg(test)]\nmod tests { use crate::b; }\n"),
            ("b.rs", "use crate::a::A;\npub(in crate::a) struct B;\n"),
            ("oracle.rs", "use crate::{a, b};\n"),
        ]);
        assert!(found.is_empty(), "{found:?}");
    }
}
