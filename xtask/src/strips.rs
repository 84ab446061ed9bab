//! `cargo xtask strips [--only WORD]`: renders what each parameter of each material, light and procedural texture does,
//! as strips of small pictures for the reference pages. It takes minutes; `cargo xtask docs` puts the strips into the
//! pages, and refuses to when one is missing or left over.

use crate::process::{cargo, root, run as run_process};
use anyhow::{Context, Result, bail};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// The folder of the strips, relative to the root of the repository.
const FOLDER: &str = "docs/reference/strips";

/// The tables whose parameters have strips.
pub(crate) const TABLES: &[&str] = &["materials", "textures", "lights"];

/// Renders the strips with the example that does it; arguments are passed on to it.
pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let example =
        ["run", "--locked", "--release", "--package", "bilux-validation", "--example", "strips", "--"];
    run_process(cargo(&example).arg(root().join(FOLDER)).args(arguments))
}

/// The path of a strip from the folder of the reference pages.
pub(crate) fn path(table: &str, kind: &str, parameter: &str) -> String {
    format!("strips/{table}/{kind}-{parameter}.jpg")
}

/// Checks that there are exactly these strips, each by its [`path`].
pub(crate) fn check(wanted: &BTreeSet<String>) -> Result<()> {
    let found = found(&root().join(FOLDER))?;
    let list = |paths: Vec<&String>| paths.into_iter().map(String::as_str).collect::<Vec<_>>().join(", ");
    let (missing, left_over) =
        (list(wanted.difference(&found).collect()), list(found.difference(wanted).collect()));
    if !missing.is_empty() {
        bail!("there are no strips {missing} in docs/reference: run `cargo xtask strips`");
    }
    if !left_over.is_empty() {
        bail!("no parameter has the strips {left_over} in docs/reference: delete them");
    }
    Ok(())
}

fn found(folder: &Path) -> Result<BTreeSet<String>> {
    let mut found = BTreeSet::new();
    for table in TABLES {
        let listing =
            fs::read_dir(folder.join(table)).with_context(|| format!("cannot list {FOLDER}/{table}"))?;
        for entry in listing {
            found.insert(format!("strips/{table}/{}", entry?.file_name().to_string_lossy()));
        }
    }
    Ok(found)
}
