//! The package for Debian and its relatives, by their own tool, `dpkg-deb`: the same files as in the archive, where that system
//! expects them.

use super::contents::{PAGES, SCENES};
use crate::process::{output, run};
use anyhow::{Context, Result};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Properties of the package.
pub(super) struct Package<'a> {
    pub version: &'a str,
    /// The target's triple.
    pub triple: &'a str,
    pub is_static: bool,
}

/// Makes `bilux_VERSION_ARCHITECTURE.deb` of the folder that is packed into the archive, in the folder that contains it;
/// `None` where the tool is missing.
pub(super) fn pack(folder: &Path, package: &Package) -> Result<Option<PathBuf>> {
    if Command::new("dpkg-deb").arg("--version").output().is_err() {
        println!("skipped: no .deb, since there is no dpkg-deb here");
        return Ok(None);
    }
    let parent = folder.parent().context("the folder has no parent")?;
    let name = format!("bilux_{}_{}.deb", package.version, architecture(package.triple));
    let (tree, deb) = (parent.join("deb"), parent.join(name));
    if tree.exists() {
        fs::remove_dir_all(&tree).with_context(|| format!("cannot remove {}", tree.display()))?;
    }
    lay_out(folder, &tree)?;
    let size = size_of(&tree)?.div_ceil(1024);
    write(&tree.join("DEBIAN/control"), &control(package, size))?;
    let mut tool = Command::new("dpkg-deb");
    // No time of this machine, and no owner of it.
    tool.env("SOURCE_DATE_EPOCH", "0").args(["--root-owner-group", "-Zxz", "--build"]).arg(&tree).arg(&deb);
    output(&mut tool)?;
    fs::remove_dir_all(&tree).with_context(|| format!("cannot remove {}", tree.display()))?;
    Ok(Some(deb))
}

/// Debian's name of a processor.
fn architecture(triple: &str) -> &str {
    match triple.split('-').next().unwrap_or(triple) {
        "x86_64" => "amd64",
        "aarch64" => "arm64",
        other => other,
    }
}

fn control(package: &Package, kilobytes: u64) -> String {
    let Package { version, triple, is_static } = package;
    let needs = if *is_static { "" } else { "Depends: libc6, libgcc-s1\n" };
    format!(
        "Package: bilux\nVersion: {version}\nArchitecture: {}\nMaintainer: The authors of Bilux <https://github.com/bilux/bilux>\n\
         Installed-Size: {kilobytes}\n{needs}Section: graphics\nPriority: optional\n\
         Homepage: https://github.com/bilux/bilux\nDescription: physically based renderer for the CPU\n \
         Renders glTF, OBJ, PLY, pbrt and other scenes, without a GPU or a display.\n",
        architecture(triple)
    )
}

/// Copies the files of the archive to their places in the package.
fn lay_out(folder: &Path, tree: &Path) -> Result<()> {
    let doc = tree.join("usr/share/doc/bilux");
    copy(&folder.join("bilux"), &tree.join("usr/bin/bilux"))?;
    for page in PAGES {
        copy(&folder.join(page), &doc.join(page))?;
    }
    copy(&folder.join("LICENSE-MIT"), &doc.join("copyright"))?;
    for (shell, place) in [
        ("bash", "bash-completion/completions/bilux"),
        ("zsh", "zsh/vendor-completions/_bilux"),
        ("fish", "fish/vendor_completions.d/bilux.fish"),
    ] {
        copy(&folder.join(format!("completions/bilux.{shell}")), &tree.join("usr/share").join(place))?;
    }
    copy_all(&folder.join("man"), &tree.join("usr/share/man/man1"))?;
    copy_all(&folder.join(SCENES), &tree.join("usr/share/bilux/scenes"))?;
    let mut zip = Command::new("gzip");
    zip.args(["-n9", "-r"]).arg(tree.join("usr/share/man"));
    run(&mut zip)
}

fn copy_all(from: &Path, to: &Path) -> Result<()> {
    for entry in fs::read_dir(from).with_context(|| format!("cannot read {}", from.display()))? {
        let entry = entry?;
        copy(&entry.path(), &to.join(entry.file_name()))?;
    }
    Ok(())
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    let folder = to.parent().context("a file lies in a folder")?;
    fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    fs::copy(from, to).with_context(|| format!("cannot copy {}", from.display()))?;
    Ok(())
}

fn write(path: &Path, text: &str) -> Result<()> {
    let folder = path.parent().context("a file lies in a folder")?;
    fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))
}

/// The bytes of all files in a folder.
fn size_of(folder: &Path) -> Result<u64> {
    let mut size = 0;
    for entry in fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))? {
        let entry = entry?;
        let metadata = entry.metadata()?;
        size += if metadata.is_dir() { size_of(&entry.path())? } else { metadata.len() };
    }
    Ok(size)
}
