//! The documentation of the libraries, in `target/doc`. A warning is an error. Public items may link to private ones that explain
//! them: anyone who wants the explanation reads the source.
//!
//! `cargo doc` checks all dependencies first. What [`build::all`] has left says the same about them, so where nobody develops,
//! rustdoc reads that: it takes a fifth of the time.

use crate::build::{self, Built};
use crate::process::{cargo, output, root, run as run_process, target_folder};
use crate::workspace::{Package, packages};
use anyhow::{Context, Result, bail};
use serde_json::Value;
use std::path::Path;
use std::process::Command;

const FLAGS: [&str; 4] = ["--deny", "warnings", "--allow", "rustdoc::private_intra_doc_links"];

/// Builds the documentation.
pub(crate) fn build() -> Result<()> {
    if build::lints() {
        let (built, packages) = (build::all()?, packages()?);
        return packages.iter().filter(|package| package.member).try_for_each(|package| {
            let mut targets = built.artifacts.iter().filter(|artifact| is_documented(artifact, package));
            targets.try_for_each(|target| document(target, package, &built))
        });
    }
    let mut command = cargo(&["doc", "--locked", "--workspace", "--no-deps", "--quiet"]);
    run_process(command.env("RUSTDOCFLAGS", FLAGS.join(" ")))
}

/// Whether an artifact is a library or a program of a package, as others use it.
fn is_documented(artifact: &Value, package: &Package) -> bool {
    let target = &artifact["target"];
    let kind = target["kind"][0].as_str().unwrap_or_default();
    artifact["package_id"] == package.id.as_str()
        && target["doc"] == true
        && artifact["profile"]["test"] == false
        && ["lib", "cdylib", "bin"].contains(&kind)
}

fn document(artifact: &Value, package: &Package, built: &Built) -> Result<()> {
    let target = &artifact["target"];
    let text = |key: &str| target[key].as_str().with_context(|| format!("cargo does not say '{key}'"));
    let (name, kind) = (text("name")?.replace('-', "_"), target["crate_types"][0].as_str().unwrap_or("lib"));
    let mut rustdoc = Command::new("rustdoc");
    rustdoc.current_dir(root()).args(FLAGS).args(["--edition", text("edition")?, "--crate-name", &name]);
    rustdoc.args(["--crate-type", kind]).arg(text("src_path")?);
    rustdoc.arg("-L").arg(format!("dependency={}", target_folder().join("debug/deps").display()));
    // A program has no public items, and may have the name of a library.
    let is_program = kind == "bin";
    rustdoc.arg("-o").arg(target_folder().join(if is_program { "doc-programs" } else { "doc" }));
    rustdoc.args(is_program.then_some("--document-private-items"));
    for feature in artifact["features"].as_array().into_iter().flatten().filter_map(Value::as_str) {
        rustdoc.arg("--cfg").arg(format!("feature=\"{feature}\""));
    }
    for part in &package.parts {
        // One for another platform has not been built.
        if let Some((name, path)) = library(part, &built.artifacts)? {
            rustdoc.arg("--extern").arg(format!("{name}={path}"));
        }
    }
    rustdoc.env("CARGO_PKG_VERSION", &package.version).env("CARGO_MANIFEST_DIR", &package.folder);
    rustdoc.envs(built.variables(&package.id));
    output(&mut rustdoc).map(drop).with_context(|| format!("the documentation of {name}"))
}

/// The name of a package's library and the file of what it declares, or of the macros in it.
fn library<'a>(id: &str, artifacts: &'a [Value]) -> Result<Option<(&'a str, &'a str)>> {
    let is_library = |artifact: &&Value| {
        let kind = artifact["target"]["kind"][0].as_str().unwrap_or_default();
        artifact["package_id"] == id
            && artifact["profile"]["test"] == false
            && ["lib", "rlib", "proc-macro"].contains(&kind)
    };
    let mut found = artifacts.iter().filter(is_library);
    let Some(artifact) = found.next() else { return Ok(None) };
    if found.next().is_some() {
        bail!("{id} is built in two ways: run `cargo doc`");
    }
    let files = artifact["filenames"].as_array().into_iter().flatten().filter_map(Value::as_str);
    let is_declared = |file: &&str| Path::new(file).extension().is_some_and(|extension| extension == "rmeta");
    let file = files.clone().find(is_declared).or_else(|| files.clone().next());
    Ok(artifact["target"]["name"].as_str().zip(file))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn libraries_are_found_by_their_packages() {
        let artifact = |id: &str, kind: &str, files: &[&str]| json!({ "package_id": id, "target": { "kind": [kind], "name": id, "doc": true }, "profile": { "test": false }, "filenames": files });
        let artifacts = [
            artifact("a", "lib", &["/t/liba.rlib", "/t/deps/liba-1.rmeta"]),
            artifact("m", "proc-macro", &["/t/libm.so"]),
            artifact("b", "lib", &["/t/libb.rlib"]),
            artifact("b", "lib", &["/t/libb-2.rlib"]),
            artifact("p", "bin", &["/t/p"]),
        ];
        assert_eq!(library("a", &artifacts).unwrap(), Some(("a", "/t/deps/liba-1.rmeta")));
        assert_eq!(library("m", &artifacts).unwrap(), Some(("m", "/t/libm.so")));
        assert_eq!(library("p", &artifacts).unwrap(), None);
        assert!(library("b", &artifacts).is_err());
        let package = Package { id: "p".to_owned(), ..Package::default() };
        assert_eq!(artifacts.iter().filter(|artifact| is_documented(artifact, &package)).count(), 1);
    }
}
