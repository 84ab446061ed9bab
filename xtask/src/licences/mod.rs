//! `cargo xtask licences`: checks that every package that we build on is permissively licensed, and that
//! `LICENSES.txt`, which the binary prints and every release includes, reproduces their notices. `--write` rewrites
//! that file.

mod expression;
mod notices;

use crate::process::root;
use crate::workspace::{Package, packages};
use anyhow::{Context, Result, bail};
use std::fs;

/// The licences that we build on, by their SPDX names. None of them demands anything of a program that links to the
/// package, except that its notice be passed on.
const PERMISSIVE: &[&str] = &[
    "0BSD",
    "Apache-2.0",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "CC0-1.0",
    "IJG",
    "ISC",
    "MIT",
    "MIT-0",
    "NCSA",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
];

/// The page with all notices, relative to the root of the repository.
pub(crate) const PAGE: &str = "LICENSES.txt";

/// Checks every package of `Cargo.lock`, names those that are not permissive, and checks or writes the page.
pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let packages = packages()?;
    let refused: Vec<_> = packages.iter().filter_map(objection).collect();
    for objection in &refused {
        println!("{objection}");
    }
    if !refused.is_empty() {
        bail!("{} of {} packages are not permissively licensed", refused.len(), packages.len());
    }
    println!("{} packages, all permissively licensed", packages.len());

    let page = notices::page(&packages)?;
    let path = root().join(PAGE);
    match arguments {
        [] if fs::read_to_string(&path).is_ok_and(|old| old == page) => Ok(()),
        [] => bail!("{PAGE} is out of date: run `cargo xtask licences --write`"),
        [word] if word == "--write" => fs::write(&path, page).with_context(|| format!("cannot write {PAGE}")),
        _ => bail!("only `--write` can be asked for"),
    }
}

/// Why we may not build on a package, if there is a reason.
fn objection(package: &Package) -> Option<String> {
    let Package { name, version, licence, .. } = package;
    let Some(licence) = licence else {
        return Some(format!("{name} {version} names no licence: take another package, or ask its author"));
    };
    match expression::allows(licence, PERMISSIVE) {
        Ok(true) => None,
        Ok(false) => Some(format!("{name} {version} is under '{licence}': not permissive, take another")),
        Err(error) => Some(format!("{name} {version} is under '{licence}', which cannot be read: {error}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn objection_to(licence: Option<&str>) -> Option<String> {
        let licence = licence.map(str::to_owned);
        objection(&Package { name: "planted".into(), version: "1.0.0".into(), licence, ..Package::default() })
    }

    #[test]
    fn permissive_packages_pass() {
        assert_eq!(objection_to(Some("MIT OR Apache-2.0")), None);
        assert_eq!(objection_to(Some("MIT OR LGPL-2.1-or-later")), None);
    }

    #[test]
    fn planted_packages_are_refused_by_name() {
        for licence in [Some("GPL-3.0-only"), Some("MPL-2.0"), Some("MIT AND LGPL-2.1"), Some("MIT OR"), None]
        {
            let objection = objection_to(licence);
            assert!(
                objection.as_ref().is_some_and(|text| text.starts_with("planted 1.0.0")),
                "{objection:?}"
            );
        }
    }
}
