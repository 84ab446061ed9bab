//! `cargo xtask tidy --measures`: the size and shape of the workspace, so that two states of it can be compared.

use super::modules::Modules;
use super::repository::{Repository, TextFile};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// The crate of the path tracer, and its module.
const PATH_TRACER: (&str, &str) = ("crates/transport", "path_tracing");

/// Elements of the largest tuple that a function should take.
const LONGEST_TUPLE: usize = 2;

/// Measures of one crate.
#[derive(Debug, Default, PartialEq)]
struct Measures {
    /// Lines before the tests.
    lines: usize,
    /// Files beside `lib.rs` or `main.rs`.
    loose: usize,
    /// Type names that stand more than once.
    shared: usize,
    /// Functions with tuples of more than two elements among their arguments.
    tuples: usize,
}

/// The table as text.
pub(super) fn table(repository: &Repository) -> String {
    let mut text = String::from("| crate | lines | loose files | shared type names | long tuples |\n");
    text += "| --- | ---: | ---: | ---: | ---: |\n";
    let mut sum = Measures::default();
    for (folder, of_crate) in crates(repository) {
        let Measures { lines, loose, shared, tuples } = Measures::of(folder, &of_crate);
        let _ = writeln!(text, "| {folder} | {lines} | {loose} | {shared} | {tuples} |");
        (sum.lines, sum.loose) = (sum.lines + lines, sum.loose + loose);
        (sum.shared, sum.tuples) = (sum.shared + shared, sum.tuples + tuples);
    }
    let Measures { lines, loose, shared, tuples } = sum;
    let _ = writeln!(text, "| all | {lines} | {loose} | {shared} | {tuples} |");
    let (folder, module) = PATH_TRACER;
    let reached = reached(&Modules::read(repository, folder), module);
    let _ = writeln!(text, "\nFiles that {folder}/src/{module} reaches: {reached}");
    let records = repository.files.iter().filter(|file| file.path.starts_with("docs/adr/0"));
    let words: usize = records.map(|file| file.text.split_whitespace().count()).sum();
    let _ = writeln!(text, "Words of the records of decisions: {words}");
    text
}

/// The files in each crate's `src`, by its folder.
fn crates(repository: &Repository) -> BTreeMap<&str, Vec<&TextFile>> {
    let mut crates: BTreeMap<&str, Vec<&TextFile>> = BTreeMap::new();
    for (file, _) in repository.rust() {
        if let Some((folder, _)) = file.path.split_once("/src/")
            && !file.is_test()
        {
            crates.entry(folder).or_default().push(file);
        }
    }
    crates
}

impl Measures {
    fn of(folder: &str, files: &[&TextFile]) -> Measures {
        let is_loose = |file: &&&TextFile| {
            let name = file.path.strip_prefix(folder).and_then(|rest| rest.strip_prefix("/src/"));
            name.is_some_and(|name| !name.contains('/') && !["lib.rs", "main.rs"].contains(&name))
        };
        let mut types: BTreeMap<&str, usize> = BTreeMap::new();
        let code = |file: &&TextFile| {
            let code = file.rust.as_ref().map_or("", |rust| &rust.code);
            let end: usize = code.split_inclusive('\n').take(file.lines_before_tests()).map(str::len).sum();
            code[..end].to_owned()
        };
        let code: Vec<String> = files.iter().map(code).collect();
        for name in code.iter().flat_map(|code| type_names(code)) {
            *types.entry(name).or_default() += 1;
        }
        Measures {
            lines: files.iter().map(|file| file.lines_before_tests()).sum(),
            loose: files.iter().filter(is_loose).count(),
            shared: types.values().filter(|count| **count > 1).count(),
            tuples: code.iter().map(|code| long_tuples(code)).sum(),
        }
    }
}

/// Names of the structures and enums that code defines.
fn type_names(code: &str) -> impl Iterator<Item = &str> {
    let words = code.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty());
    let pairs = words.clone().zip(words.skip(1));
    pairs.filter(|(word, _)| ["struct", "enum"].contains(word)).map(|(_, name)| name)
}

/// Functions whose arguments have a tuple of more than two elements.
fn long_tuples(code: &str) -> usize {
    let functions = code.split("fn ").skip(1);
    functions.filter(|rest| rest.find('(').is_some_and(|at| has_long_tuple(&rest[at..]))).count()
}

/// Whether a list of arguments, which begins with its parenthesis, has such a type.
fn has_long_tuple(list: &str) -> bool {
    // The commas in each open parenthesis, and whether it is a type.
    let mut open: Vec<(usize, bool)> = Vec::new();
    let (mut before, mut angles) = (' ', 0);
    for c in list.chars() {
        match c {
            '(' => open.push((0, [':', '&', '<', ','].contains(&before) && !open.is_empty())),
            ')' => match open.pop() {
                Some((commas, true)) if commas >= LONGEST_TUPLE => return true,
                _ if open.is_empty() => return false,
                _ => {}
            },
            '<' => angles += 1,
            '>' if before != '-' => angles -= 1,
            ',' if angles == 0 || open.len() > 1 => {
                if let Some((commas, _)) = open.last_mut() {
                    *commas += 1;
                }
            }
            _ => {}
        }
        if !c.is_whitespace() {
            before = c;
        }
    }
    false
}

/// Number of files that a module and those within it use, directly or by others.
fn reached(modules: &Modules, module: &str) -> usize {
    let starts = modules.iter().filter(|one| one.place.first().is_some_and(|name| name == module));
    let mut open: Vec<_> = starts.collect();
    let mut found: BTreeSet<&str> = open.iter().map(|module| module.file.as_str()).collect();
    while let Some(user) = open.pop() {
        for (used, _) in modules.used_by(user) {
            if found.insert(&used.file) {
                open.push(used);
            }
        }
    }
    found.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measures_of_a_planted_crate_are_right() {
        let one = "mod b;\nstruct A;\nenum B { C }\nfn f(x: (u8, u8, u8), y: u8) {}\nfn g((a, b): (u8, u8), c: HashMap<u8, u8>) {}\n";
        let two = "struct A { x: u8 }\nfn h(x: &[(u8, u8)], y: u8, z: u8) {}\n#[cfg(test)]\nmod tests {}\n";
        let files =
            [("crates/a/src/lib.rs", one), ("crates/a/src/b.rs", two), ("crates/a/tests/suite/x.rs", one)];
        let repository = Repository::planted(&files);
        let crates = crates(&repository);
        let measures = Measures::of("crates/a", &crates["crates/a"]);
        assert_eq!(measures, Measures { lines: 7, loose: 1, shared: 1, tuples: 1 });
        assert!(table(&repository).contains("| crates/a | 7 | 1 | 1 | 1 |"));
    }

    #[test]
    fn files_behind_others_are_reached() {
        let files = [
            ("crates/a/src/lib.rs", "mod p;\nmod q;\nmod r;\nmod s;\n"),
            ("crates/a/src/p.rs", "use crate::q::Q;\nfn p(_: Q) {}\n"),
            ("crates/a/src/q.rs", "use crate::r::R;\npub struct Q(R);\n"),
            ("crates/a/src/r.rs", "pub struct R;\n"),
            ("crates/a/src/s.rs", "pub struct S;\n"),
        ];
        assert_eq!(reached(&Modules::read(&Repository::planted(&files), "crates/a"), "p"), 3);
    }
}
