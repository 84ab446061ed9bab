//! The thread that keeps the scene: it opens it, edits it, and publishes each version.

use super::edits::Edits;
use super::mail::Sent;
use super::{OpenScene, Version};
use crate::ViewerError;
use crate::dropped::Kept;
use crate::message::{Request, SceneRequest};
use crate::options::{Opening, Options};
use crate::settings;
use bilux::scene::{Parameters, SceneBuilder, Value};
use bilux::watch::Watched;
use bilux::{Edit, Session};
use std::sync::Arc;

/// Keeps the scene.
pub(crate) struct Keeper {
    pub(super) options: Options,
    /// Checks what is asked for, and builds it; it renders nothing.
    pub(super) session: Session,
    /// The scene as it was opened.
    pub(super) unedited: SceneBuilder,
    /// The choices with which the scene was opened.
    pub(super) opening: Opening,
    /// The time in seconds that the scene was opened at.
    pub(super) first_time: f32,
    /// The file that was dropped in, while it is shown.
    pub(super) kept: Option<Arc<Kept>>,
    pub(super) edits: Edits,
    /// The settings that the viewer was started with, with the time that is shown.
    pub(super) user: Parameters,
    pub(super) time: Option<Value>,
    /// Why the edits do not fit a scene that was opened again.
    pub(super) misfit: Option<String>,
    /// Counts the files that were opened.
    pub(super) files: u64,
    /// Counts the versions that were published.
    versions: u64,
    pub(super) watched: Arc<Watched>,
    open: Arc<OpenScene>,
}

impl Keeper {
    /// Opens the scene that the options name, and publishes it.
    ///
    /// # Errors
    /// If the scene cannot be opened or rendered.
    pub(crate) fn new(
        options: Options,
        open: Arc<OpenScene>,
        watched: Arc<Watched>,
    ) -> Result<Keeper, ViewerError> {
        let scene = (options.open)(&Opening::default()).map_err(ViewerError::Open)?;
        watched.add(&scene.files);
        let (user, unedited) = (options.settings.clone(), scene.clone());
        let session = Session::new(scene, settings::request(&user, options.max_memory))?;
        let keeper = Keeper {
            first_time: session.job().settings().time,
            options,
            session,
            unedited,
            opening: Opening::default(),
            kept: None,
            edits: Edits::default(),
            user,
            time: None,
            misfit: None,
            files: 0,
            versions: 0,
            watched,
            open,
        };
        keeper.publish();
        Ok(keeper)
    }

    /// Serves requests until the scene ends.
    pub(crate) fn run(mut self) {
        loop {
            let sent = self.open.mail.take();
            if self.open.has_ended() {
                return;
            }
            self.serve(sent);
        }
    }

    /// Does what is asked for. What cannot be done keeps nothing else from being done: others may have asked for that.
    fn serve(&mut self, all: Vec<Sent>) {
        let (mut has_changed, mut answers) = (false, Vec::new());
        for Sent { request, from } in all {
            let done = self.make(request);
            has_changed |= matches!(done, Ok(true));
            answers.push((from, done.err().or_else(|| self.misfit.take())));
        }
        if has_changed {
            self.versions += 1;
            self.publish();
        }
        for (from, problem) in answers {
            match from {
                // These answers always find room.
                Some(inbox) => drop(inbox.post(Request::Answered(problem))),
                // A file that is broken, or that the edits do not fit, is everybody's business.
                None if problem.is_some() => self.open.tell(|| Request::Answered(problem.clone())),
                None => {}
            }
        }
    }

    /// Does one thing. Returns whether that changes the scene.
    fn make(&mut self, request: SceneRequest) -> Result<bool, String> {
        let is_edit = matches!(request, SceneRequest::Edit { .. } | SceneRequest::Undo | SceneRequest::Redo);
        if is_edit && !self.options.may_edit {
            return Err("this viewer is read-only: start it with --edit to change the scene".to_owned());
        }
        let session = &mut self.session;
        match request {
            SceneRequest::Undo if !self.edits.can_undo() => return Ok(false),
            SceneRequest::Redo if !self.edits.can_redo() => return Ok(false),
            SceneRequest::Edit { part, number, key, value } => {
                self.edits.change(session, part, number, &key, value).map_err(|error| error.to_string())
            }
            SceneRequest::Undo => self.edits.undo(session).map_err(|error| error.to_string()),
            SceneRequest::Redo => self.edits.redo(session).map_err(|error| error.to_string()),
            SceneRequest::Variant(name) => self.choose_variant(name),
            SceneRequest::Animation(name) => self.choose_animation(name),
            SceneRequest::Environment(name) => self.choose_environment(name),
            SceneRequest::Time(time) => self.show_time(time),
            SceneRequest::Open(dropped) => self.open(dropped),
            SceneRequest::Reload => self.reload(),
        }
        .map(|()| true)
    }

    /// Shows another time.
    fn show_time(&mut self, time: Value) -> Result<(), String> {
        let before = (self.user.clone(), self.time.clone());
        self.user.set("time", time.clone());
        self.time = Some(time);
        let applied = self.session.apply(Edit::Settings(settings::with_defaults(&self.user)));
        let shown = applied.map_err(|error| error.to_string()).and_then(|_| self.pose());
        shown.inspect_err(|_| {
            (self.user, self.time) = before;
            // The settings before were accepted, and are again.
            let _ = self.session.apply(Edit::Settings(settings::with_defaults(&self.user)));
        })
    }

    fn publish(&self) {
        let scene = self.session.scene();
        self.open.publish(Version {
            number: self.versions,
            file: self.files,
            scene: scene.clone(),
            unedited: self.unedited.clone(),
            built: self.session.built().clone(),
            opening: self.opening.clone(),
            time: self.time.clone(),
            words: self.words(),
            title: self.title().to_owned(),
            changes: self.edits.changes(scene),
            can_undo: self.edits.can_undo(),
            can_redo: self.edits.can_redo(),
            _kept: self.kept.clone(),
        });
    }
}
