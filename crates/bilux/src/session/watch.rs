//! Watches the files of a scene for changes.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};
use std::time::SystemTime;

/// The files that are watched, which change when the scene is opened again.
#[derive(Debug, Default)]
pub struct Watched(Mutex<BTreeSet<PathBuf>>);

/// Size and time of change of each file; none for a file that is not there.
type State = Vec<Option<(u64, Option<SystemTime>)>>;

impl Watched {
    /// Adds files. One that was watched before stays, even if a broken scene no longer names it.
    pub fn add(&self, files: &BTreeSet<PathBuf>) {
        self.lock().extend(files.iter().cloned());
    }

    fn state(&self) -> State {
        let of = |path: &PathBuf| {
            let facts = std::fs::metadata(path).ok()?;
            Some((facts.len(), facts.modified().ok()))
        };
        self.lock().iter().map(of).collect()
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, BTreeSet<PathBuf>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Changes in files that are looked at from time to time. A file that is being written changes more than once: a change counts
/// when all files have stayed the same from one look to the next.
#[derive(Debug)]
pub struct Changes<'a> {
    files: &'a Watched,
    /// The files when the scene was opened.
    opened: State,
    last: State,
}

impl<'a> Changes<'a> {
    /// Changes from now on.
    pub fn of(files: &'a Watched) -> Changes<'a> {
        let state = files.state();
        Changes { files, opened: state.clone(), last: state }
    }

    /// Looks at the files: true if they have changed since the scene was opened.
    pub fn are_there(&mut self) -> bool {
        let now = self.files.state();
        // Files that join are not a change of those before.
        if now.len() != self.opened.len() {
            self.opened.clone_from(&now);
        }
        let have_changed = now != self.opened && now == self.last;
        self.last = now;
        have_changed
    }

    /// The scene is opened again as it was at the last look.
    pub fn seen(&mut self) {
        self.opened.clone_from(&self.last);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_counts_once_when_it_is_over() {
        let folder = tempfile::tempdir().unwrap();
        let [one, other] = ["a.obj", "a.mtl"].map(|name| folder.path().join(name));
        std::fs::write(&one, "v").unwrap();
        let watched = Watched::default();
        watched.add(&BTreeSet::from([one.clone(), other.clone()]));
        let mut changes = Changes::of(&watched);
        assert!(!changes.are_there());
        std::fs::write(&one, "v 1").unwrap();
        assert!(!changes.are_there(), "it may still be being written");
        assert!(changes.are_there());
        changes.seen();
        assert!(!changes.are_there());
        // A file appears, and then goes.
        std::fs::write(&other, "x").unwrap();
        assert!(!changes.are_there());
        assert!(changes.are_there());
        changes.seen();
        std::fs::remove_file(&other).unwrap();
        assert!(!changes.are_there());
        assert!(changes.are_there());
        // Joining is no change.
        watched.add(&BTreeSet::from([folder.path().join("more")]));
        changes.seen();
        assert!(!changes.are_there());
        assert!(!changes.are_there());
    }
}
