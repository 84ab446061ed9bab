//! Watches the files of a scene, and asks for it to be opened again when one of them changes.

use crate::inbox::Inbox;
use crate::message::Request;
use bilux::watch::{Changes, Watched};
use std::sync::Arc;
use std::time::Duration;

/// How often the files are looked at.
const EVERY: Duration = Duration::from_millis(400);

/// Watches until the inbox ends.
pub(crate) fn watch(files: &Arc<Watched>, inbox: &Arc<Inbox>) {
    let mut changes = Changes::of(files);
    while !inbox.has_ended() {
        std::thread::sleep(EVERY);
        if changes.are_there() && inbox.post(Request::Reload).is_ok() {
            changes.seen();
        }
    }
}
