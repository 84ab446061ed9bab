//! Watches the files of a scene, and asks for it to be opened again when one of them changes.

use crate::inbox::Inbox;
use crate::message::Request;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, SystemTime};

/// How often the files are looked at.
const EVERY: Duration = Duration::from_millis(400);

/// The files that are watched, which change when the scene is opened again.
#[derive(Default)]
pub(crate) struct Watched(Mutex<BTreeSet<PathBuf>>);

impl Watched {
    /// Adds files. One that was watched before stays, even if a broken scene no longer names it.
    pub(crate) fn add(&self, files: &BTreeSet<PathBuf>) {
        self.lock().extend(files.iter().cloned());
    }

    /// Size and time of change of each file; none for a file that is not there.
    fn state(&self) -> Vec<Option<(u64, Option<SystemTime>)>> {
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

/// Watches until the inbox ends. A file that is being written changes more than once: the scene is opened when all files
/// have stayed the same for a while.
pub(crate) fn watch(files: &Arc<Watched>, inbox: &Arc<Inbox>) {
    let (mut opened, mut last) = (files.state(), files.state());
    while !inbox.has_ended() {
        std::thread::sleep(EVERY);
        let now = files.state();
        // Files that join are not a change of those before.
        let have_joined = now.len() != opened.len();
        let has_changed = !have_joined && now != opened && now == last;
        if have_joined || (has_changed && inbox.post(Request::Reload).is_ok()) {
            opened.clone_from(&now);
        }
        last = now;
    }
}
