//! `cargo xtask dist`: the binary as it is released, static where possible, in an archive with its licences,
//! completions, man pages and scenes, in a package for Debian, and with the description of an image for containers; the
//! SHA-256 of both next to them. Each is unpacked and started. It is the program that `cargo build --release` makes, for another target.
//!
//! The archive and the package depend only on the sources and the tools: they contain no time, owner or path of the machine that
//! builds them.

mod container;
mod contents;
mod debian;
mod elf;
mod started;

use crate::process::{cargo, output, root, run as run_process, target_folder};
use anyhow::{Context, Result, bail};
use contents::{PAGES, SCENES};
use sha2::{Digest, Sha256};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const SHELLS: &[&str] = &["bash", "zsh", "fish", "powershell", "elvish"];

/// Builds the archive, and prints how large everything is.
pub(crate) fn run(_: &[String]) -> Result<()> {
    let target = Target::best()?;
    let binary = build(&target)?;
    let version = version()?;
    let name = format!("bilux-{version}-{}", target.triple);
    let folder = root().join("dist").join(&name);
    assemble(&folder, &binary)?;
    if target.is_static {
        elf::require_static(&fs::read(folder.join("bilux"))?).context("the binary is not static")?;
        container::write(&folder)?;
    }
    let archive = pack(&folder, &name)?;
    let package = debian::Package { version: &version, triple: &target.triple, is_static: target.is_static };
    let deb = debian::pack(&folder, &package)?;
    started::check(&archive, &name, deb.as_deref(), &version)?;
    if target.is_static {
        container::check(&folder, &version)?;
    }
    let kind = if target.is_static { "static" } else { "dynamic" };
    println!("{} bytes  {name}/bilux ({kind})", fs::metadata(folder.join("bilux"))?.len());
    let mut sums = String::new();
    for file in [&archive].into_iter().chain(&deb) {
        let shown = file.file_name().unwrap_or_default().to_string_lossy();
        println!("{} bytes  dist/{shown}", fs::metadata(file)?.len());
        sums += &format!("{}  {shown}\n", sha256(file)?);
    }
    fs::write(root().join("dist/SHA256SUMS"), &sums).context("cannot write SHA256SUMS")?;
    print!("{sums}");
    Ok(())
}

/// The target that the binary is built for.
struct Target {
    triple: String,
    is_static: bool,
}

impl Target {
    /// On Linux, a static binary with musl, whose licence allows linking it in (glibc's requires more); on other
    /// systems, or if musl is not available, a binary for this machine's system.
    fn best() -> Result<Target> {
        let about = output(Command::new(rustc()).arg("-vV"))?;
        let host = about.lines().find_map(|line| line.strip_prefix("host: "));
        let host = host.context("rustc does not say what it runs on")?.to_owned();
        let musl = host.replace("-linux-gnu", "-linux-musl");
        if musl.ends_with("-linux-musl") && (is_installed(&musl)? || install(&musl)) {
            return Ok(Target { triple: musl, is_static: true });
        }
        println!("no musl for {host}: the binary will need the system's libraries");
        Ok(Target { triple: host, is_static: false })
    }
}

fn rustc() -> std::ffi::OsString {
    std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into())
}

fn is_installed(triple: &str) -> Result<bool> {
    let folder = output(Command::new(rustc()).args(["--print", "target-libdir", "--target", triple]))?;
    Ok(Path::new(folder.trim()).is_dir())
}

fn install(triple: &str) -> bool {
    run_process(Command::new("rustup").args(["target", "add", triple])).is_ok()
}

/// Builds the binary, and returns its path.
fn build(target: &Target) -> Result<PathBuf> {
    let triple = target.triple.as_str();
    let mut command =
        cargo(&["build", "--locked", "--release", "--package", "bilux-cli", "--target", triple]);
    let variable = format!("CARGO_TARGET_{}_RUSTFLAGS", triple.to_uppercase().replace('-', "_"));
    run_process(command.env(variable, flags(target.is_static)))?;
    Ok(target_folder().join(triple).join("release").join("bilux"))
}

/// Panic messages name source files: these flags make the paths relative to the repository's root and to cargo's home,
/// so that no path of this machine's disk remains.
fn flags(is_static: bool) -> String {
    let home = std::env::var_os("CARGO_HOME").map(PathBuf::from);
    let home = home.or_else(|| Some(PathBuf::from(std::env::var_os("HOME")?).join(".cargo")));
    let remap = |from: PathBuf, to: &str| format!("--remap-path-prefix={}={to}", from.display());
    let mut flags = vec![remap(root(), "bilux")];
    flags.extend(is_static.then(|| "-Ctarget-feature=+crt-static".to_owned()));
    flags.extend(home.map(|home| remap(home, "cargo")));
    flags.join(" ")
}

fn version() -> Result<String> {
    let packages = crate::workspace::packages()?;
    let binary = packages.into_iter().find(|package| package.name == "bilux-cli");
    binary.map(|package| package.version).context("the workspace has no bilux-cli")
}

/// Fills the folder that is packed.
fn assemble(folder: &Path, binary: &Path) -> Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("cannot remove {}", folder.display()))?;
    }
    let completions = folder.join("completions");
    fs::create_dir_all(&completions).with_context(|| format!("cannot make {}", folder.display()))?;
    fs::copy(binary, folder.join("bilux")).with_context(|| format!("cannot copy {}", binary.display()))?;
    for page in PAGES {
        fs::copy(root().join(page), folder.join(page)).with_context(|| format!("cannot copy {page}"))?;
    }
    copy_folder(&root().join(SCENES), &folder.join(SCENES))?;
    for shell in SHELLS {
        let text = output(Command::new(folder.join("bilux")).args(["completions", shell]))?;
        fs::write(completions.join(format!("bilux.{shell}")), text)?;
    }
    run_process(Command::new(folder.join("bilux")).arg("man").arg(folder.join("man")))
}

/// Copies the files of a folder, which contains no subfolders.
fn copy_folder(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to).with_context(|| format!("cannot make {}", to.display()))?;
    for entry in fs::read_dir(from).with_context(|| format!("cannot read {}", from.display()))? {
        let entry = entry?;
        fs::copy(entry.path(), to.join(entry.file_name()))
            .with_context(|| format!("cannot copy {}", entry.path().display()))?;
    }
    Ok(())
}

/// Packs the folder, the same way every time.
fn pack(folder: &Path, name: &str) -> Result<PathBuf> {
    let parent = folder.parent().context("the folder has no parent")?;
    let archive = parent.join(format!("{name}.tar.gz"));
    let mut tar = Command::new("tar");
    tar.current_dir(parent).args(["--sort=name", "--owner=0", "--group=0", "--numeric-owner"]);
    tar.args(["--mtime=@0", "--mode=u+rw,go=rX", "--use-compress-program=gzip -n9", "--create", "--file"]);
    run_process(tar.arg(&archive).arg(name))?;
    if !archive.is_file() {
        bail!("tar made no {}", archive.display());
    }
    Ok(archive)
}

fn sha256(path: &Path) -> Result<String> {
    let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    Ok(Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_those_of_the_standard() {
        let path = std::env::temp_dir().join(format!("bilux-sum-{}", std::process::id()));
        fs::write(&path, "abc").expect("a file for the test");
        let sum = sha256(&path);
        fs::remove_file(&path).expect("the file of the test goes away");
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(sum.expect("the file can be read"), expected);
    }

    /// A program that answers as the binary does, in the folder that is packed.
    #[cfg(unix)]
    fn packed(parent: &Path, name: &str) -> PathBuf {
        use std::os::unix::fs::PermissionsExt;
        let folder = parent.join(name);
        for inner in ["completions", "man", SCENES] {
            fs::create_dir_all(folder.join(inner)).expect("a folder for the test");
        }
        let program = "#!/bin/sh\ncase $1 in\n-V) echo 'bilux 1.2.3 (test)';;\n\
            render) printf '\\211PNG and so on' > started.png;;\nesac\n";
        fs::write(folder.join("bilux"), program).expect("a program for the test");
        fs::set_permissions(folder.join("bilux"), fs::Permissions::from_mode(0o755))
            .expect("it can be started");
        let completions = SHELLS.iter().map(|shell| format!("completions/bilux.{shell}"));
        let more = ["man/bilux.1".to_owned(), format!("{SCENES}/a.toml")];
        for file in completions.chain(more).chain(PAGES.iter().map(|page| (*page).to_owned())) {
            fs::write(folder.join(&file), file).expect("a file for the test");
        }
        folder
    }

    #[cfg(unix)]
    #[test]
    fn what_is_packed_starts_when_it_is_unpacked() {
        let parent = std::env::temp_dir().join(format!("bilux-dist-{}", std::process::id()));
        let folder = packed(&parent, "bilux-1.2.3-x86_64-unknown-linux-musl");
        container::write(&folder).expect("the description of the image");
        let archive = pack(&folder, "bilux-1.2.3-x86_64-unknown-linux-musl").expect("an archive");
        let package =
            debian::Package { version: "1.2.3", triple: "x86_64-unknown-linux-musl", is_static: true };
        let deb = debian::pack(&folder, &package).expect("a package, or none where the tool is missing");
        let name = "bilux-1.2.3-x86_64-unknown-linux-musl";
        started::check(&archive, name, deb.as_deref(), "1.2.3").expect("both start");
        // Another version than the one that is released is noticed.
        assert!(started::check(&archive, name, deb.as_deref(), "1.2.4").is_err());
        if let Some(deb) = deb {
            assert_eq!(deb.file_name().and_then(|name| name.to_str()), Some("bilux_1.2.3_amd64.deb"));
            let field =
                |name: &str| output(Command::new("dpkg-deb").arg("--field").arg(&deb).arg(name)).expect(name);
            assert_eq!([field("Package").trim(), field("Version").trim()], ["bilux", "1.2.3"]);
            let listed = output(Command::new("dpkg-deb").arg("--contents").arg(&deb)).expect("a list");
            for file in
                ["./usr/bin/bilux", "./usr/share/man/man1/bilux.1.gz", "./usr/share/doc/bilux/copyright"]
            {
                assert!(
                    listed.lines().any(|line| line.ends_with(file) && line.contains("root/root")),
                    "{file}"
                );
            }
            let first = sha256(&deb).expect("a sum");
            let again = debian::pack(&folder, &package).expect("a package").expect("the tool is there");
            assert_eq!(sha256(&again).expect("a sum"), first, "the same files give another package");
        }
        fs::remove_dir_all(&parent).expect("the folder of the test goes away");
    }

    #[test]
    fn the_folder_of_the_repository_is_renamed() {
        assert!(flags(true).contains(&format!("--remap-path-prefix={}=bilux", root().display())));
    }
}
