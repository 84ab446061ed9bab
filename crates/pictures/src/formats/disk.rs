//! Reads and writes whole files.

use super::unfinished::Unfinished;
use crate::{Limits, PictureError};
use std::fs::{self, File, OpenOptions};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// Opens a regular file for reading.
///
/// # Errors
/// If it cannot be opened, or is a pipe, a socket or a device: those may never give a byte, or never end.
pub fn open_regular(path: &Path) -> std::io::Result<File> {
    // Asked before it is opened, since opening a pipe waits for who writes into it.
    let metadata = fs::metadata(path)?;
    if !metadata.is_file() && !metadata.is_dir() {
        return Err(std::io::Error::other("this is a pipe or a device, not a file"));
    }
    File::open(path)
}

/// The bytes of a file; an error if they exceed the limit, whatever length the file claims to have.
pub(super) fn read_within(path: &Path, limits: &Limits) -> Result<Vec<u8>, PictureError> {
    let file = open_regular(path).map_err(|source| PictureError::Io { action: "open it", source })?;
    let mut bytes = Vec::new();
    let limit = limits.max_bytes.saturating_add(1);
    file.take(limit)
        .read_to_end(&mut bytes)
        .map_err(|source| PictureError::Io { action: "read it", source })?;
    if bytes.len() as u64 == limit {
        return Err(PictureError::FileTooLarge { limit: limits.max_bytes });
    }
    Ok(bytes)
}

/// Writes a file atomically: a reader sees either the old file or the new one, never a partial one. The bytes go into
/// a new file next to the target, which is renamed over it once they are on the disk; if that fails, the new file is
/// removed. Links are followed, also to files that do not exist yet, and a file that is replaced keeps its permissions.
/// Anything that is not a regular file (a pipe, a terminal) is written to directly.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), PictureError> {
    let target = target_of(path);
    let before = fs::metadata(&target).ok();
    if before.as_ref().is_some_and(|metadata| !metadata.is_file()) {
        return fs::write(&target, bytes).map_err(|source| PictureError::Io { action: "write it", source });
    }
    let (unfinished, file) =
        create_beside(&target).map_err(|source| PictureError::Io { action: "write beside it", source })?;
    if let Some(before) = before {
        // A file system that has no permissions, or does not let them be set, is no reason to lose a picture.
        let _ = file.set_permissions(before.permissions());
    }
    let written = fill(file, bytes).and_then(|()| unfinished.complete(&target));
    written.map_err(|source| PictureError::Io { action: "write it", source })
}

/// Longer chains of links are circles, as for the system.
const MAX_LINKS: usize = 40;

/// The file that a path stands for: that at the end of all links, whether it exists or not.
fn target_of(path: &Path) -> PathBuf {
    if let Ok(found) = fs::canonicalize(path) {
        return found;
    }
    let mut target = path.to_owned();
    for _ in 0..MAX_LINKS {
        let Ok(next) = fs::read_link(&target) else { return target };
        target = target.parent().map_or_else(|| next.clone(), |folder| folder.join(&next));
    }
    // A circle: what is written there replaces the link.
    path.to_owned()
}

fn fill(mut file: File, bytes: &[u8]) -> std::io::Result<()> {
    file.write_all(bytes)?;
    file.sync_all()
}

/// Creates a new file in the target's folder, under a name that does not exist yet.
fn create_beside(target: &Path) -> std::io::Result<(Unfinished, File)> {
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    let process = std::process::id();
    let mut attempt = 0;
    loop {
        let beside = target.with_file_name(format!(".{name}.{process}.{attempt}.part"));
        match Unfinished::create(&beside, OpenOptions::new().write(true).create_new(true)) {
            Ok(created) => return Ok(created),
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists && attempt < 1000 => attempt += 1,
            Err(error) => return Err(error),
        }
    }
}
