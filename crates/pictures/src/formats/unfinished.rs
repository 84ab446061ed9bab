//! Files that are being written, under names of their own beside their place, until they are complete.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Those of this process.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// A file that is being written. As long as this value lives, [`remove_unfinished`] removes the file.
#[derive(Debug)]
pub struct Unfinished(PathBuf);

impl Unfinished {
    /// Says that this file is not complete; it need not exist yet.
    pub fn begin(path: &Path) -> Unfinished {
        UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner).push(path.to_owned());
        Unfinished(path.to_owned())
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner).retain(|path| *path != self.0);
    }
}

/// Removes every file that is being written, for a process that ends in the midst of it, and makes all threads wait that
/// begin another one.
pub fn remove_unfinished() {
    // Whoever holds the lock may be the one that has no memory left: after a while it goes on without it.
    for _ in 0..20 {
        if let Ok(files) = UNFINISHED.try_lock() {
            for path in files.iter() {
                // Mostly there is none, since the name is only reserved.
                let _ = fs::remove_file(path);
            }
            std::mem::forget(files);
            return;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}
