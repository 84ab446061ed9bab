//! `--sandbox`: what a command may still access once it starts to read untrusted files. Bilux's own checks refuse other
//! files with a message that names them; the kernel, where it can, refuses them whatever a faulty decoder may try.

use crate::arguments::Common;
use crate::arguments::studio::StudioArguments;
use crate::process::{memory, output, signals};
use crate::sandbox::{Enforcement, restrict};
use anyhow::bail;
use bilux::formats::archive_of;
use std::path::{Path, PathBuf};
use std::sync::Once;

/// The files that a command needs while it runs.
#[derive(Debug, Default)]
pub struct SandboxPaths {
    /// Files that may be read, and folders with everything in them.
    read: Vec<PathBuf>,
    /// The folder that may be written to.
    write: Option<PathBuf>,
    /// Files that lead out of the folder in which they are named.
    outside: Vec<PathBuf>,
}

impl SandboxPaths {
    /// Allows reading a scene file and everything in its folder; of one in an archive, the archive.
    pub fn reading_scene(mut self, scene: &Path) -> SandboxPaths {
        let scene = archive_of(scene).unwrap_or(scene);
        self.read.push(folder_of(scene).to_owned());
        self.reading(scene)
    }

    /// Allows reading this file; if it is a link, within the folder in which it is named.
    pub fn reading(mut self, file: &Path) -> SandboxPaths {
        match (leads_out(file), file.canonicalize()) {
            (true, _) => self.outside.push(file.to_owned()),
            (false, Ok(target)) => self.read.push(target),
            // A file that is missing is reported when it is opened.
            (false, Err(_)) => {}
        }
        self
    }

    /// Allows reading the files that these options name.
    pub fn reading_options(mut self, studio: &StudioArguments) -> SandboxPaths {
        for file in studio.picture_around().into_iter().chain(studio.picture_behind()) {
            self = self.reading(file);
        }
        // COLMAP has its cameras beside its images.
        match &studio.intrinsics {
            Some(file) => self.reading_scene(file),
            None => self,
        }
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

    /// The files that may be read, the folders with everything in them, and the folder that may be written to.
    pub fn places(&self) -> (impl Iterator<Item = &Path>, Option<&Path>) {
        (self.read.iter().map(PathBuf::as_path), self.write.as_deref())
    }

    /// Restricts the process to these files if `--sandbox` asks for it, and then starts the first threads: those that are
    /// already running would stay unrestricted.
    pub fn enter(&self, common: &Common) -> anyhow::Result<()> {
        let wanted = signals::wanted();
        if common.sandbox {
            self.restrict(common)?;
        }
        // A process that takes one job after the other comes here for each.
        static BEGUN: Once = Once::new();
        let mut begun = Ok(());
        BEGUN.call_once(|| begun = signals::listen(&wanted).and_then(|()| memory::begin_work()));
        begun
    }

    fn restrict(&self, common: &Common) -> anyhow::Result<()> {
        self.outside.iter().try_for_each(|file| check_read(file, common))?;
        let enforced = restrict(&self.read, self.write.as_deref())?;
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

/// True for a link that leads out of the folder in which it is named. Folders may be links: whoever names a folder means
/// what it stands for.
pub fn leads_out(file: &Path) -> bool {
    if file.is_dir() {
        return false;
    }
    let (target, folder) = (file.canonicalize(), folder_of(file).canonicalize());
    matches!((target, folder), (Ok(target), Ok(folder)) if !target.starts_with(&folder))
}

/// Refuses a file that leads out of its folder, if `--sandbox` asks for it: whoever has put the link there may not be the
/// one who may read its target.
pub fn check_read(file: &Path, common: &Common) -> anyhow::Result<()> {
    if common.sandbox && leads_out(file) {
        let folder = folder_of(file).display();
        bail!(
            "{}: --sandbox reads only what is in the folder {folder}, and this is a link that leads out of it: copy the \
             file there, or name the file that the link stands for",
            file.display()
        );
    }
    Ok(())
}

/// The folder that contains a file.
pub fn folder_of(file: &Path) -> &Path {
    match file.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}
