//! Unpacks what is released, and starts it: a package that does not run is none.

use crate::process::{output, run};
use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Unpacks the archive and, if there is one, the package; starts both, and compares what they render.
pub(super) fn check(archive: &Path, name: &str, deb: Option<&Path>, version: &str) -> Result<()> {
    let folder = archive.with_file_name("started");
    if folder.exists() {
        fs::remove_dir_all(&folder).with_context(|| format!("cannot remove {}", folder.display()))?;
    }
    let from_archive = unpack_archive(archive, name, &folder.join("archive"))?;
    let first = start(&from_archive, version)?;
    if let Some(deb) = deb {
        let from_package = unpack_deb(deb, &folder.join("deb"))?;
        ensure!(
            start(&from_package, version)? == first,
            "the package and the archive render different pictures"
        );
    }
    fs::remove_dir_all(&folder).with_context(|| format!("cannot remove {}", folder.display()))
}

/// The binary of an archive.
pub(super) fn unpack_archive(archive: &Path, name: &str, folder: &Path) -> Result<PathBuf> {
    fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    run(Command::new("tar").arg("--extract").arg("--file").arg(archive).arg("--directory").arg(folder))?;
    Ok(folder.join(name).join("bilux"))
}

/// The binary of a package.
pub(super) fn unpack_deb(deb: &Path, folder: &Path) -> Result<PathBuf> {
    fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    run(Command::new("dpkg-deb").arg("--extract").arg(deb).arg(folder))?;
    Ok(folder.join("usr/bin/bilux"))
}

/// Asks a binary for its version and for a picture, whose bytes it returns.
pub(super) fn start(binary: &Path, version: &str) -> Result<Vec<u8>> {
    let folder = binary.parent().context("the binary lies in a folder")?;
    let said = output(Command::new(binary).arg("-V"))?;
    ensure!(said.starts_with(&format!("bilux {version}")), "{} says {said:?}", binary.display());
    for line in
        ["generate cornell -o started.toml -q", "render started.toml -o started.png --size 16x16 --spp 1 -q"]
    {
        run(Command::new(binary).current_dir(folder).args(line.split(' ')))?;
    }
    let picture = fs::read(folder.join("started.png")).context("there is no picture")?;
    ensure!(picture.starts_with(b"\x89PNG"), "the picture is no PNG");
    println!("{}: started", binary.display());
    Ok(picture)
}
