//! The packages of the workspace and everything that they depend on, as cargo reports them.

use crate::process::{cargo, output};
use anyhow::{Context, Result};
use serde_json::Value;
use std::path::PathBuf;

/// One package of `Cargo.lock`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Package {
    pub(crate) name: String,
    pub(crate) version: String,
    /// The SPDX expression in its manifest, if there is one.
    pub(crate) licence: Option<String>,
    pub(crate) repository: Option<String>,
    /// The folder of its manifest.
    pub(crate) folder: PathBuf,
    /// True for our own packages.
    pub(crate) member: bool,
    /// The names of the packages that it depends on, for any purpose and platform.
    pub(crate) dependencies: Vec<String>,
    /// The names of those among them that are not for tests and examples alone.
    pub(crate) shipped: Vec<String>,
    /// Cargo's unique id for this package, version and source.
    pub(crate) id: String,
    /// The packages, by their `id`, that end up in whatever is built from this one.
    pub(crate) parts: Vec<String>,
}

/// Every package of `Cargo.lock`, for all platforms, sorted by name and version.
pub(crate) fn packages() -> Result<Vec<Package>> {
    let text = output(&mut cargo(&["metadata", "--locked", "--quiet", "--format-version", "1"]))?;
    read(&serde_json::from_str(&text).context("cargo metadata wrote no JSON")?)
}

/// The package of this name and everything it is built from, on any platform, without development and build
/// dependencies.
pub(crate) fn built_into<'a>(name: &str, packages: &'a [Package]) -> Vec<&'a Package> {
    let mut waiting: Vec<_> = packages.iter().filter(|package| package.name == name).collect();
    let mut found: Vec<&Package> = Vec::new();
    while let Some(package) = waiting.pop() {
        if found.iter().all(|other| other.id != package.id) {
            found.push(package);
            waiting.extend(packages.iter().filter(|other| package.parts.contains(&other.id)));
        }
    }
    found.sort_by(|a, b| (&a.name, &a.version).cmp(&(&b.name, &b.version)));
    found
}

fn read(metadata: &Value) -> Result<Vec<Package>> {
    let list = metadata["packages"].as_array().context("cargo metadata lists no packages")?;
    let nodes = metadata["resolve"]["nodes"].as_array().context("cargo metadata resolves nothing")?;
    let mut packages = list.iter().map(read_package).collect::<Result<Vec<_>>>()?;
    for package in &mut packages {
        let node = nodes.iter().find(|node| node["id"] == package.id.as_str());
        package.parts = node.map(parts).unwrap_or_default();
    }
    packages.sort_by(|a, b| (&a.name, &a.version).cmp(&(&b.name, &b.version)));
    Ok(packages)
}

fn read_package(package: &Value) -> Result<Package> {
    let text = |key: &str| package[key].as_str().map(str::to_owned);
    let needed = |key: &str| text(key).with_context(|| format!("a package of cargo metadata has no '{key}'"));
    let dependencies = package["dependencies"].as_array().into_iter().flatten();
    let shipped = dependencies.clone().filter(|d| d["kind"] != "dev");
    Ok(Package {
        name: needed("name")?,
        version: needed("version")?,
        licence: text("license"),
        repository: text("repository"),
        folder: PathBuf::from(needed("manifest_path")?).parent().map(PathBuf::from).unwrap_or_default(),
        member: package["source"].is_null(),
        dependencies: dependencies.filter_map(|d| d["name"].as_str().map(str::to_owned)).collect(),
        shipped: shipped.filter_map(|d| d["name"].as_str().map(str::to_owned)).collect(),
        id: needed("id")?,
        parts: Vec::new(),
    })
}

/// The ordinary dependencies of a node, by `id`.
fn parts(node: &Value) -> Vec<String> {
    let dependencies = node["deps"].as_array().into_iter().flatten();
    let ordinary = dependencies.filter(|dependency| {
        dependency["dep_kinds"].as_array().into_iter().flatten().any(|kind| kind["kind"].is_null())
    });
    ordinary.filter_map(|dependency| dependency["pkg"].as_str().map(str::to_owned)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn package(name: &str) -> Value {
        json!({ "id": name, "name": name, "version": "1.0.0", "manifest_path": format!("/x/{name}/Cargo.toml"),
            "license": "MIT", "source": null, "dependencies": [] })
    }

    #[test]
    fn development_and_build_dependencies_are_not_parts() {
        let dependency = |name: &str, kind: Value| json!({ "pkg": name, "dep_kinds": [{ "kind": kind }] });
        let list = ["tool", "part", "part-of-part", "tester", "builder"].map(package);
        let metadata = json!({
            "packages": list,
            "resolve": { "nodes": [
                { "id": "tool", "deps": [
                    dependency("part", Value::Null), dependency("tester", json!("dev")),
                    dependency("builder", json!("build")),
                ] },
                { "id": "part", "deps": [dependency("part-of-part", Value::Null)] },
            ] },
        });
        let packages = read(&metadata).expect("the metadata is whole");
        let names: Vec<_> = built_into("tool", &packages).iter().map(|package| &package.name).collect();
        assert_eq!(names, ["part", "part-of-part", "tool"]);
        assert_eq!(packages[0].folder, PathBuf::from("/x/builder"));
        assert!(read(&json!({})).is_err());
    }
}
