//! Watches the files of a scene, and asks for it to be opened again when one of them changes.

use crate::message::SceneRequest;
use crate::open_scene::OpenScene;
use bilux::watch::{Changes, Watched};
use std::sync::Arc;
use std::time::Duration;

/// Interval at which the files are looked at.
const EVERY: Duration = Duration::from_millis(400);

/// Watches until the scene ends.
pub(crate) fn watch(files: &Arc<Watched>, open: &OpenScene) {
    let mut changes = Changes::of(files);
    while !open.has_ended() {
        std::thread::sleep(EVERY);
        if changes.are_there() && open.post(SceneRequest::Reload, None).is_ok() {
            changes.seen();
        }
    }
}
