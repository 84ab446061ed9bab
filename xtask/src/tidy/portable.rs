//! Code that goes into a wheel or a program compiles on Linux, macOS and Windows: the modules of one system alone are listed
//! here, and their callers have another way for the others.

use super::repository::Repository;
use super::violation::Violation;

/// Paths that only some systems have.
const SYSTEMS: &[&str] = &["std::os::unix", "std::os::linux", "std::os::windows", "std::os::fd", "libc::"];

/// The files of one system alone; their modules are compiled only there.
const ALLOWED: &[&str] =
    &["crates/cli/src/sandbox/landlock.rs", "crates/cli/src/commands/worker/confines.rs"];

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    let mut violations = Vec::new();
    for (file, rust) in repository.rust() {
        let is_shipped = file.path.starts_with("crates/") && file.path.contains("/src/");
        if !is_shipped || ALLOWED.contains(&file.path.as_str()) {
            continue;
        }
        for (number, line) in rust.code.lines().enumerate() {
            if let Some(system) = SYSTEMS.iter().find(|system| line.contains(**system)) {
                let message =
                    format!("'{system}' is not on every system: find another way, or list the file");
                violations.push(Violation::new(&file.path, number + 1, message));
            }
        }
    }
    violations
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_planted_one_is_found_in_what_is_shipped_only() {
        let text = "use std::os::unix::fs::symlink;\n// std::os::unix\n";
        let paths = [
            "crates/a/src/b.rs",
            "crates/a/tests/b.rs",
            "crates/cli/src/sandbox/landlock.rs",
            "xtask/src/c.rs",
        ];
        let found = check(&Repository::planted(&paths.map(|path| (path, text))));
        let places: Vec<_> = found.iter().map(|found| (found.path.as_str(), found.line)).collect();
        assert_eq!(places, [("crates/a/src/b.rs", 1)]);
    }
}
