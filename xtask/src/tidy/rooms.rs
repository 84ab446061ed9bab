//! In some crates each part is a folder: no file stands beside `lib.rs` or `main.rs`, so that the folders are the parts. Put a new file into the
//! folder of what it is part of.

use super::repository::Repository;
use super::violation::Violation;

/// The crates that are divided so.
const CRATES: &[&str] = &[
    "crates/transport",
    "crates/import",
    "crates/cli",
    "crates/gltf",
    "crates/usd",
    "crates/bilux",
    "crates/scene",
];

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    let is_loose = |path: &str| {
        let file = CRATES.iter().find_map(|folder| path.strip_prefix(folder)?.strip_prefix("/src/"));
        file.is_some_and(|file| !file.contains('/') && !["lib.rs", "main.rs", "build.rs"].contains(&file))
    };
    let loose = repository.rust().filter(|(file, _)| is_loose(&file.path));
    loose.map(|(file, _)| Violation::new(&file.path, 0, "stands beside the folders of its crate")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_planted_loose_file_is_found() {
        let files = [
            "crates/transport/src/lib.rs",
            "crates/transport/src/film/mod.rs",
            "crates/transport/src/film.rs",
        ];
        let others = ["crates/math/src/film.rs", "crates/transport/tests/film.rs"];
        let planted: Vec<_> = files.into_iter().chain(others).map(|path| (path, "")).collect();
        let found = check(&Repository::planted(&planted));
        let found: Vec<_> = found.iter().map(ToString::to_string).collect();
        assert_eq!(found, ["crates/transport/src/film.rs: stands beside the folders of its crate"]);
    }
}
