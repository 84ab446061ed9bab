//! `unsafe` appears only in the modules listed below, and each use has its `// SAFETY:` comment (or, on the declaration
//! of an unsafe function, its `# Safety` section) in the lines just above. ARCHITECTURE.md names all of these modules.

use super::repository::Repository;
use super::violation::Violation;

/// A path or its beginning, and the reason.
const ALLOWED: &[(&str, &str)] = &[
    ("crates/accel/src/brute_simd/kernel.rs", "the wide loop over triangles"),
    (
        "crates/cli/src/process/allocator.rs",
        "the allocator: what it is set to, and what happens when it has nothing left",
    ),
    ("crates/bench/src/rays/embree", "a rival's library, loaded at run time"),
    ("crates/pictures/src/denoise/oidn/library.rs", "a denoiser's library, loaded at run time"),
    ("crates/accel/src/bvh8/mapped.rs", "trees mapped from files"),
    ("crates/accel/tests/suite/places.rs", "a test that maps a tree"),
    ("crates/math/src/cpu_level.rs", "loops over numbers, compiled for each level of instructions"),
    ("crates/accel/src/bvh8/kernel/", "the wide tree's walk, a file for each level of instructions"),
];

/// Page that names these modules for readers.
const ARCHITECTURE: &str = "ARCHITECTURE.md";

/// Number of lines above the word within which its justification may begin: attributes and longer reasons need room.
const REACH: usize = 12;

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    let mut violations = Vec::new();
    for (file, rust) in repository.rust() {
        let allowed = ALLOWED.iter().any(|(path, _)| file.path.starts_with(path));
        let comments: Vec<_> = rust.comments.lines().collect();
        for (number, line) in rust.code.lines().enumerate().filter(|(_, line)| contains_unsafe(line)) {
            let above = &comments[number.saturating_sub(REACH)..=number];
            if !allowed {
                let message = "`unsafe` outside the modules that may have it: find a safe way";
                violations.push(Violation::new(&file.path, number + 1, message));
            } else if !above.iter().any(|line| line.contains("SAFETY:") || line.contains("# Safety")) {
                let message = format!("`{}` without its `// SAFETY:`", line.trim());
                violations.push(Violation::new(&file.path, number + 1, message));
            }
        }
    }
    violations.extend(unnamed(repository));
    violations
}

/// The modules that ARCHITECTURE.md leaves out.
fn unnamed(repository: &Repository) -> Vec<Violation> {
    let Some(page) = repository.file(ARCHITECTURE) else { return Vec::new() };
    let left_out = ALLOWED.iter().filter(|(path, _)| !page.text.contains(path));
    left_out
        .map(|(path, _)| Violation::new(ARCHITECTURE, 0, format!("does not name {path}, which has `unsafe`")))
        .collect()
}

/// Whether a line of code contains the word; `unsafe_code`, the lint, is another word.
fn contains_unsafe(line: &str) -> bool {
    line.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == "unsafe")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_that_the_page_leaves_out_are_found() {
        let all: String = ALLOWED.iter().map(|(path, _)| format!("- `{path}`\n")).collect();
        assert!(check(&Repository::planted(&[(ARCHITECTURE, &all)])).is_empty());
        let without = all.replace(ALLOWED[1].0, "an allocator");
        assert_eq!(check(&Repository::planted(&[(ARCHITECTURE, &without)])).len(), 1);
    }

    #[test]
    fn planted_blocks_are_found() {
        let bare = "fn f() {\n    unsafe { g() }\n}\n";
        let argued = "fn f() {\n    // SAFETY: g asks for nothing.\n    unsafe { g() }\n}\n";
        let elsewhere = "#![deny(unsafe_code)] // unsafe\nconst S: &str = \"unsafe\";\n";
        let repository = Repository::planted(&[
            ("crates/accel/src/brute_simd/kernel.rs", bare),
            ("crates/accel/src/bvh/mod.rs", bare),
            ("crates/scene/src/c.rs", argued),
            ("crates/scene/src/d.rs", elsewhere),
        ]);
        let found: Vec<_> = check(&repository).iter().map(ToString::to_string).collect();
        let outside = "`unsafe` outside the modules that may have it: find a safe way";
        assert_eq!(
            found,
            [
                "crates/accel/src/brute_simd/kernel.rs:2: `unsafe { g() }` without its `// SAFETY:`"
                    .to_owned(),
                format!("crates/accel/src/bvh/mod.rs:2: {outside}"),
                format!("crates/scene/src/c.rs:3: {outside}"),
            ]
        );
        let argued = Repository::planted(&[("crates/accel/src/brute_simd/kernel.rs", argued)]);
        assert!(check(&argued).is_empty());
    }
}
