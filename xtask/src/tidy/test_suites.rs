//! Each crate has one binary of tests, `tests/suite`, which compiles generic code and links once for all of them, and every
//! file of it is a module: one that no module names would never run.

use super::repository::{Repository, TextFile};
use super::violation::Violation;

/// Binaries of their own, and the reason.
const SEPARATE: &[(&str, &str)] =
    &[("crates/cli/tests/many.rs", "reads the CPU time of all children of its process")];

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    let mut violations = Vec::new();
    for (file, _) in repository.rust() {
        let Some((tests, inside)) = place(&file.path) else { continue };
        let message = match inside.strip_prefix("suite/") {
            None if SEPARATE.iter().any(|(path, _)| *path == file.path) => continue,
            None => format!(
                "a binary of its own, which takes long to build: move it to {tests}/suite and name it in main.rs"
            ),
            Some("main.rs") => continue,
            Some(module) if is_named(repository, &format!("{tests}/suite"), module) => continue,
            Some(_) => "no module names this file, so its tests never run".to_owned(),
        };
        violations.push(Violation::new(&file.path, 0, message));
    }
    violations
}

/// `crates/a/tests/suite/b.rs` is in `crates/a/tests`, at `suite/b.rs`.
fn place(path: &str) -> Option<(&str, &str)> {
    let (package, inside) = path.split_once("/tests/")?;
    (package.matches('/').count() == 1 && package.starts_with("crates/"))
        .then(|| (&path[..package.len() + "/tests".len()], inside))
}

/// Whether the file of the module around `module` (`a/b.rs` or `a/b/mod.rs`) has a `mod` line for it.
fn is_named(repository: &Repository, suite: &str, module: &str) -> bool {
    let module = module.trim_end_matches(".rs").trim_end_matches("/mod");
    let (around, name) = module.rsplit_once('/').unwrap_or(("", module));
    let files = match around {
        "" => vec![format!("{suite}/main.rs")],
        _ => vec![format!("{suite}/{around}.rs"), format!("{suite}/{around}/mod.rs")],
    };
    files.iter().filter_map(|path| repository.file(path)).any(|file| declares(file, name))
}

fn declares(file: &TextFile, name: &str) -> bool {
    let declaration = format!("mod {name};");
    let lines = file.rust.iter().flat_map(|rust| rust.code.lines());
    lines.map(str::trim).any(|line| {
        line.strip_suffix(&declaration).is_some_and(|before| before.is_empty() || before.starts_with("pub"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planted_files_that_nobody_names_are_found() {
        let repository = Repository::planted(&[
            (
                "crates/a/tests/suite/main.rs",
                "mod b;\n#[cfg(unix)]\nmod c;\nmod common;\n// mod forgotten;\n",
            ),
            ("crates/a/tests/suite/b.rs", ""),
            ("crates/a/tests/suite/c/mod.rs", "pub(crate) mod d;\nmod not_e;\n"),
            ("crates/a/tests/suite/c/d.rs", ""),
            ("crates/a/tests/suite/c/e.rs", ""),
            ("crates/a/tests/suite/common.rs", "mod f;"),
            ("crates/a/tests/suite/common/f.rs", ""),
            ("crates/a/tests/suite/forgotten.rs", ""),
            ("crates/a/tests/alone.rs", ""),
            ("crates/cli/tests/many.rs", ""),
            ("crates/a/src/tests/g.rs", ""),
        ]);
        let found: Vec<_> = check(&repository).into_iter().map(|found| found.path).collect();
        assert_eq!(
            found,
            ["c/e.rs", "forgotten.rs"]
                .map(|path| format!("crates/a/tests/suite/{path}"))
                .into_iter()
                .chain(["crates/a/tests/alone.rs".to_owned()])
                .collect::<Vec<_>>()
        );
    }
}
