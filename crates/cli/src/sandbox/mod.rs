//! `--sandbox`: what a command may still touch once it begins to read what strangers made. Bilux's own checks refuse other
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
    /// Which files are opened.
    Files,
    /// Which files are opened, and that no TCP connection is made.
    FilesAndNetwork,
}

impl Enforcement {
    /// In the words of `-V`.
    fn describe(self) -> &'static str {
        match self {
            Enforcement::Nothing => "not enforced by this kernel",
            Enforcement::Files => "enforced by the kernel (files)",
            Enforcement::FilesAndNetwork => "enforced by the kernel (files and network)",
        }
    }
}

/// What `-V` says about sandboxes here.
pub fn describe() -> &'static str {
    kernel::available().describe()
}

/// What a command needs while it runs.
#[derive(Debug, Default)]
pub struct Confines {
    /// Files, and folders with all that is in them, that may be read.
    read: Vec<PathBuf>,
    /// The folder of what is written.
    write: Option<PathBuf>,
}

impl Confines {
    /// A scene file may be read, and so may whatever is in its folder.
    pub fn reading_scene(mut self, scene: &Path) -> Confines {
        self.read.push(folder_of(scene).to_owned());
        self.reading(scene)
    }

    /// This file may be read.
    pub fn reading(mut self, file: &Path) -> Confines {
        // Where it is a link, what it leads to.
        self.read.extend(std::fs::canonicalize(file));
        self
    }

    /// Files may be written into the folder of this one.
    pub fn writing(mut self, file: &Path) -> Confines {
        self.write = Some(folder_of(file).to_owned());
        self
    }

    /// Refuses a file that is to be written somewhere else.
    pub fn check_written(&self, file: &Path, common: &Common) -> anyhow::Result<()> {
        if !common.sandbox {
            return Ok(());
        }
        let folder = self.write.as_deref().and_then(|folder| folder.canonicalize().ok());
        let Some(folder) = folder else {
            bail!("{}: --sandbox writes no file beside a picture on standard output", file.display());
        };
        // A link that is in the folder already may lead anywhere.
        let target = file.canonicalize().or_else(|_| folder_of(file).canonicalize().map(|at| at.join("new")));
        if !target.is_ok_and(|target| target.parent() == Some(&folder)) {
            bail!(
                "{}: --sandbox writes only into {}, the folder of the picture: name a file there",
                file.display(),
                folder.display()
            );
        }
        Ok(())
    }

    /// From here on nothing else is opened, where `--sandbox` asks for it. It has to come before the first thread is
    /// started, since threads that run already stay free.
    pub fn enter(&self, common: &Common) -> anyhow::Result<()> {
        if !common.sandbox {
            return Ok(());
        }
        let enforced = kernel::restrict(&self.read, self.write.as_deref())?;
        if !common.quiet {
            match enforced {
                Enforcement::Nothing => output::warning(
                    "this kernel has no Landlock: Bilux itself keeps to the sandbox, but nothing stops a faulty decoder",
                ),
                Enforcement::Files => {
                    output::warning(
                        "this kernel is too old to block the network: the sandbox covers files alone",
                    );
                }
                Enforcement::FilesAndNetwork => {}
            }
        }
        Ok(())
    }
}

/// The folder that a file is in.
pub fn folder_of(file: &Path) -> &Path {
    match file.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}
