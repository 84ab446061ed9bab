//! The scene that is open: one for all visitors, with its edits. One thread keeps it. Visitors get each version of it with
//! what is built of it, so that all of them share meshes, textures and trees.

mod edits;
mod keeper;
mod mail;
mod opening;

use crate::dropped::Kept;
use crate::inbox::Inbox;
use crate::message::{Request, SceneRequest};
use crate::options::Opening;
use bilux::Built;
use bilux::scene::{Change, SceneBuilder, Value};
pub(crate) use keeper::Keeper;
use mail::{Mail, Sent};
pub(crate) use opening::{SCENE, animation_word};
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// A version of the scene.
pub(crate) struct Version {
    /// Counts the versions.
    pub(crate) number: u64,
    /// Counts the files: another one is another scene, with another camera.
    pub(crate) file: u64,
    /// The scene with its edits.
    pub(crate) scene: SceneBuilder,
    /// The scene as it was opened.
    pub(crate) unedited: SceneBuilder,
    /// The parts that are built of it.
    pub(crate) built: Built,
    /// The choices with which it was opened.
    pub(crate) opening: Opening,
    /// The time that is shown, if a visitor has set it.
    pub(crate) time: Option<Value>,
    /// The words of the command line that renders it without its edits.
    pub(crate) words: Vec<String>,
    /// The name of its file.
    pub(crate) title: String,
    /// The changes that the edits have made.
    pub(crate) changes: Vec<Change>,
    pub(crate) can_undo: bool,
    pub(crate) can_redo: bool,
    /// The file that was dropped in: it stays as long as a version needs it.
    _kept: Option<Arc<Kept>>,
}

/// Open scene, as all visitors know it.
#[derive(Default)]
pub(crate) struct OpenScene {
    mail: Mail,
    newest: Mutex<Option<Arc<Version>>>,
    audience: Mutex<Vec<Weak<Inbox>>>,
}

impl OpenScene {
    /// Asks for a change of the scene; what comes of it is answered to `from`.
    ///
    /// # Errors
    /// If too much waits already; the message is for whoever asked.
    pub(crate) fn post(&self, request: SceneRequest, from: Option<Arc<Inbox>>) -> Result<(), String> {
        self.mail.post(Sent { request, from })
    }

    /// The newest version; `None` before the scene was opened.
    pub(crate) fn newest(&self) -> Option<Arc<Version>> {
        self.newest.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Tells an inbox of new versions from now on.
    pub(crate) fn attach(&self, inbox: &Arc<Inbox>) {
        let mut audience = self.audience.lock().unwrap_or_else(PoisonError::into_inner);
        audience.retain(|other| other.strong_count() > 0);
        audience.push(Arc::downgrade(inbox));
    }

    /// Nothing changes any more.
    pub(crate) fn end(&self) {
        self.mail.end();
    }

    pub(crate) fn has_ended(&self) -> bool {
        self.mail.has_ended()
    }

    fn publish(&self, version: Version) {
        *self.newest.lock().unwrap_or_else(PoisonError::into_inner) = Some(Arc::new(version));
        self.tell(|| Request::SceneChanged);
    }

    /// Tells all visitors something.
    fn tell(&self, what: impl Fn() -> Request) {
        self.audience.lock().unwrap_or_else(PoisonError::into_inner).retain(|inbox| {
            let Some(inbox) = inbox.upgrade() else { return false };
            // These requests always find room.
            let _ = inbox.post(what());
            true
        });
    }
}
