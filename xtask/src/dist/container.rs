//! An image for containers: the static binary in an empty base.

use crate::process::{output, run};
use anyhow::{Context, Result};
use std::fs;
use std::path::Path;
use std::process::Command;

/// The file that describes the image; it is part of the archive, next to the binary.
pub(super) const FILE: &str = "Containerfile";

/// The user is nobody's, and `/work` is where the files are mounted.
pub(super) const TEXT: &str = "FROM scratch\nCOPY bilux /bilux\nCOPY LICENSE-MIT LICENSE-APACHE LICENSES.txt /licenses/\n\
    USER 65534:65534\nWORKDIR /work\nENTRYPOINT [\"/bilux\"]\n";

/// Programs that build and run containers.
const PROGRAMS: [&str; 2] = ["docker", "podman"];

/// Puts the file into the folder that is packed.
pub(super) fn write(folder: &Path) -> Result<()> {
    fs::write(folder.join(FILE), TEXT).with_context(|| format!("cannot write {FILE}"))
}

/// Builds the image from the folder and starts it, where there is a program for that; otherwise says that it did not.
pub(super) fn check(folder: &Path, version: &str) -> Result<()> {
    let works = |program: &&&str| {
        Command::new(program).arg("info").output().is_ok_and(|output| output.status.success())
    };
    let Some(program) = PROGRAMS.iter().find(works) else {
        println!(
            "skipped: the image is neither built nor started, since neither docker nor podman runs here"
        );
        return Ok(());
    };
    let image = format!("bilux:{version}");
    run(Command::new(program).args(["build", "--tag", &image, "--file"]).arg(folder.join(FILE)).arg(folder))?;
    let said = output(Command::new(program).args(["run", "--rm", &image, "-V"]))?;
    anyhow::ensure!(said.starts_with(&format!("bilux {version}")), "the image says {said:?}");
    let picture = Command::new(program)
        .args(["run", "--rm", "--network=none", &image])
        .args(["render", "/nowhere.obj", "-o", "-"])
        .output()
        .with_context(|| format!("cannot start {program}"))?;
    anyhow::ensure!(picture.status.code() == Some(1), "a scene that is not there gives {}", picture.status);
    println!("{image}: built and started by {program}");
    Ok(())
}
