//! `cargo xtask package`: a rehearsal of publishing the libraries, each built from nothing but the contents of its
//! package. `--quick` packs them without building.

use crate::process::{cargo, run as run_process};
use anyhow::{Result, bail};

/// The published libraries, in order of dependency.
pub(crate) const LIBRARIES: &[&str] = &[
    "bilux-math",
    "bilux-accel",
    "bilux-visibility",
    "bilux-pictures",
    "bilux-scene",
    "bilux-gallery",
    "bilux-transport",
    "bilux-import",
    "bilux-meshes",
    "bilux-gltf",
    "bilux-usd",
    "bilux-dcc",
    "bilux-renderers",
    "bilux-step",
    "bilux-formats",
    "bilux",
];

/// Rehearses the publishing.
pub(crate) fn run(arguments: &[String]) -> Result<()> {
    run_process(&mut cargo(&command(arguments)?))
}

fn command(arguments: &[String]) -> Result<Vec<&'static str>> {
    let mut command = vec!["publish", "--dry-run", "--locked", "--quiet"];
    match arguments {
        [] => {}
        // Uncommitted changes are packed too.
        [word] if word == "--quick" => command.extend(["--no-verify", "--allow-dirty"]),
        _ => bail!("only `--quick` can be asked for"),
    }
    command.extend(LIBRARIES.iter().flat_map(|name| ["--package", name]));
    Ok(command)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_crate_that_a_library_depends_on_is_a_library() {
        let packages = crate::workspace::packages().unwrap();
        for library in packages.iter().filter(|package| LIBRARIES.contains(&&*package.name)) {
            let parts = crate::workspace::built_into(&library.name, &packages);
            let ours = parts.iter().filter(|part| part.member).map(|part| &*part.name);
            assert!(
                ours.clone().all(|name| LIBRARIES.contains(&name)),
                "{}",
                ours.collect::<Vec<_>>().join(" ")
            );
        }
        assert!(command(&["--fast".to_owned()]).is_err());
        assert!(command(&[]).unwrap().ends_with(&["--package", "bilux"]));
    }
}
