//! Which crate may depend on which: the direction rules of `ARCHITECTURE.md`, for every kind of dependency.

use super::repository::Repository;
use super::violation::Violation;
use crate::workspace::Package;

/// Each crate, and what it may use of the workspace. Lower crates come first.
const MAY_USE: &[(&str, &[&str])] = &[
    ("bilux-math", &[]),
    ("bilux-testing", &["bilux-math"]),
    ("bilux-accel", &["bilux-math"]),
    ("bilux-visibility", &["bilux-math", "bilux-accel"]),
    ("bilux-pictures", &["bilux-math"]),
    ("bilux-scene", &["bilux-math", "bilux-accel", "bilux-pictures"]),
    ("bilux-gallery", &["bilux-math", "bilux-scene"]),
    // Its tests render built-in scenes.
    ("bilux-transport", &["bilux-math", "bilux-accel", "bilux-pictures", "bilux-scene", "bilux-gallery"]),
    ("bilux-import", UNDER_IMPORT),
    ("bilux-meshes", UNDER_FORMAT),
    ("bilux-gltf", UNDER_FORMAT),
    ("bilux-usd", UNDER_FORMAT),
    ("bilux-dcc", UNDER_FORMAT),
    ("bilux-renderers", UNDER_FORMAT),
    ("bilux-step", UNDER_FORMAT),
    (
        "bilux-formats",
        &[
            "bilux-math",
            "bilux-pictures",
            "bilux-scene",
            "bilux-gallery",
            "bilux-import",
            "bilux-meshes",
            "bilux-gltf",
            "bilux-usd",
            "bilux-dcc",
            "bilux-renderers",
            "bilux-step",
        ],
    ),
    ("bilux", LIBRARIES),
    ("bilux-bench", WITH_FACADE),
    ("bilux-viewer", &["bilux"]),
    ("bilux-cli", &["bilux", "bilux-bench", "bilux-viewer"]),
    ("bilux-python", &["bilux"]),
    ("bilux-validation", WITH_FACADE),
    ("xtask", &[]),
];

/// Code that the readers of scene files share stands on what scenes are made of.
const UNDER_IMPORT: &[&str] = &["bilux-math", "bilux-pictures", "bilux-scene"];

/// The readers of a format know those of no other.
const UNDER_FORMAT: &[&str] = &["bilux-math", "bilux-pictures", "bilux-scene", "bilux-import"];

/// Helps the tests of all crates but that below it.
const TESTING: &str = "bilux-testing";

/// All libraries but the facade, which is published last.
const LIBRARIES: &[&str] = match WITH_FACADE {
    [libraries @ .., _] => libraries,
    [] => &[],
};

const WITH_FACADE: &[&str] = crate::package::LIBRARIES;

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    let members: Vec<_> = repository.packages.iter().filter(|package| package.member).collect();
    let is_member = |name: &str| members.iter().any(|member| member.name == name);
    members.iter().flat_map(|member| check_member(member, is_member)).collect()
}

fn check_member(member: &Package, is_member: impl Fn(&str) -> bool) -> Vec<Violation> {
    let manifest = |message: String| Violation::new(&member.name, 0, message);
    let Some((_, allowed)) = MAY_USE.iter().find(|(name, _)| *name == member.name) else {
        return vec![manifest(
            "has no place in the house: say in the rule `directions` what it may use".into(),
        )];
    };
    let ours = member.dependencies.iter().filter(|name| is_member(name));
    let helps = |name: &str| name == TESTING && member.name != "bilux-math";
    let wrong = ours.filter(|name| !allowed.contains(&name.as_str()) && !helps(name));
    wrong.map(|name| manifest(format!("must not know of {name} (see ARCHITECTURE.md)"))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn member(name: &str, dependencies: &[&str]) -> Package {
        let dependencies = dependencies.iter().map(|&name| name.to_owned()).collect();
        Package { name: name.to_owned(), member: true, dependencies, ..Package::default() }
    }

    #[test]
    fn a_planted_wrong_way_is_found() {
        let packages = vec![
            member("bilux-accel", &["bilux-math", "bilux-scene", "bilux-testing", "rayon"]),
            member("bilux-scene", &["bilux-accel"]),
            member("bilux-math", &["bilux-testing"]),
            member("bilux-testing", &["bilux-math"]),
            member("bilux-teapot", &[]),
        ];
        let found = check(&Repository { packages, ..Repository::default() });
        let found: Vec<_> = found.iter().map(ToString::to_string).collect();
        assert_eq!(found.len(), 3, "{found:?}");
        assert_eq!(found[0], "bilux-accel: must not know of bilux-scene (see ARCHITECTURE.md)");
        assert_eq!(found[1], "bilux-math: must not know of bilux-testing (see ARCHITECTURE.md)");
        assert!(found[2].starts_with("bilux-teapot: has no place"));
    }

    #[test]
    fn no_crate_may_use_a_higher_one() {
        for (at, (name, allowed)) in MAY_USE.iter().enumerate() {
            let below: Vec<_> = MAY_USE[..at].iter().map(|(name, _)| name).collect();
            assert!(allowed.iter().all(|other| below.contains(&other)), "{name}");
        }
    }
}
