//! `--sandbox`: what a command may still access once it starts to read untrusted files. Bilux's own checks refuse other
//! files with a message that names them; the kernel, where it can, refuses them whatever a faulty decoder may try.

#[cfg(target_os = "linux")]
#[path = "landlock.rs"]
mod kernel;
#[cfg(not(target_os = "linux"))]
#[path = "unsupported.rs"]
mod kernel;

use crate::arguments::Common;
use crate::output;
use anyhow::bail;
use std::path::{Path, PathBuf};

/// What the kernel enforces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Enforcement {
    /// Nothing.
    Nothing,
    /// Which files may be opened.
    Files,
    /// Which files may be opened, and that no TCP connection is made.
    FilesAndNetwork,
}

impl Enforcement {
    /// The wording that `-V` prints.
    fn describe(self) -> &'static str {
        match self {
            Enforcement::Nothing => "not enforced by this kernel",
            Enforcement::Files => "enforced by the kernel (files)",
            Enforcement::FilesAndNetwork => "enforced by the kernel (files and network)",
        }
    }
}

/// What `-V` says about sandboxes on this machine.
pub fn describe() -> &'static str {
    kernel::available().describe()
}

/// The files that a command needs while it runs.
#[derive(Debug, Default)]
pub struct SandboxPaths {
    /// Files that may be read, and folders with everything in them.
    read: Vec<PathBuf>,
    /// The folder that may be written to.
    write: Option<PathBuf>,
}

impl SandboxPaths {
    /// Allows reading a scene file and everything in its folder.
    pub fn reading_scene(mut self, scene: &Path) -> SandboxPaths {
        self.read.push(folder_of(scene).to_owned());
        self.reading(scene)
    }

    /// Allows reading this file.
    pub fn reading(mut self, file: &Path) -> SandboxPaths {
        // If it is a link, its target is what will be opened.
        self.read.extend(std::fs::canonicalize(file));
        self
    }

    /// Allows writing files into this file's folder.
    pub fn writing(mut self, file: &Path) -> SandboxPaths {
        self.write = Some(folder_of(file).to_owned());
        self
    }

    /// Refuses a file that would be written anywhere else.
    pub fn check_written(&self, file: &Path, common: &Common) -> anyhow::Result<()> {
        if !common.sandbox {
            return Ok(());
        }
        let folder = self.write.as_deref().and_then(|folder| folder.canonicalize().ok());
        let Some(folder) = folder else {
            bail!(
                "{}: --sandbox writes no other file if the picture goes to standard output",
                file.display()
            );
        };
        // A link that is already in the folder may lead anywhere.
        let target = file.canonicalize().or_else(|_| folder_of(file).canonicalize().map(|at| at.join("new")));
        if !target.is_ok_and(|target| target.parent() == Some(&folder)) {
            bail!(
                "{}: --sandbox writes only to {}, the picture's folder: name a file there",
                file.display(),
                folder.display()
            );
        }
        Ok(())
    }

    /// Restricts the process to these files if `--sandbox` asks for it. This must come before the first thread starts,
    /// since threads that are already running stay unrestricted.
    pub fn enter(&self, common: &Common) -> anyhow::Result<()> {
        if !common.sandbox {
            return Ok(());
        }
        let enforced = kernel::restrict(&self.read, self.write.as_deref())?;
        if !common.quiet {
            match enforced {
                Enforcement::Nothing => output::warning(
                    "this kernel has no Landlock: Bilux itself respects the sandbox, but nothing would stop a faulty \
                     decoder",
                ),
                Enforcement::Files => {
                    output::warning(
                        "this kernel is too old to block the network: the sandbox covers only files",
                    );
                }
                Enforcement::FilesAndNetwork => {}
            }
        }
        Ok(())
    }
}

/// The folder that contains a file.
pub fn folder_of(file: &Path) -> &Path {
    match file.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}
