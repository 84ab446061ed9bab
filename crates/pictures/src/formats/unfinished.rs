//! Files that are being written, under names of their own beside their place, until they are complete.

use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Unfinished files of this process. Whoever creates a file, or puts one in its place, holds the lock meanwhile: so none
/// appears after [`remove_unfinished`].
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A file that is being written. It is removed with this value, unless it is [completed](Unfinished::complete), and by
/// [`remove_unfinished`].
#[derive(Debug)]
pub struct Unfinished(PathBuf);

impl Unfinished {
    /// Opens a file, which is not complete, to be written.
    pub fn create(path: &Path, how: &OpenOptions) -> io::Result<(Unfinished, File)> {
        let mut files = unfinished();
        let file = how.open(path)?;
        files.push(path.to_owned());
        Ok((Unfinished(path.to_owned()), file))
    }

    /// The file is complete: puts it in its place.
    pub fn complete(self, place: &Path) -> io::Result<()> {
        let mut files = unfinished();
        let renamed = fs::rename(&self.0, place);
        if renamed.is_ok() {
            files.retain(|path| *path != self.0);
        }
        drop(files);
        renamed
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        let mut files = unfinished();
        if let Some(index) = files.iter().position(|path| *path == self.0) {
            // Something has failed before, which is what gets reported.
            let _ = fs::remove_file(files.swap_remove(index));
        }
    }
}

/// Removes every file that is being written, for a process that ends in the midst of it, and makes all threads wait that
/// begin or complete another one.
pub fn remove_unfinished() {
    // Whoever holds the lock may be the one that has no memory left: after a while it goes on without it.
    for _ in 0..20 {
        if let Ok(files) = UNFINISHED.try_lock() {
            for path in files.iter() {
                let _ = fs::remove_file(path);
            }
            std::mem::forget(files);
            return;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}
