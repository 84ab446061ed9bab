//! Opening scenes: again when their files change, with other variants, at other times, and files that are dropped in.

use super::{SCENE, Stage, settings};
use crate::dropped::Dropped;
use crate::options::Opening;
use bilux::Session;
use bilux::scene::SceneBuilder;

impl Stage {
    /// The words of the command line that renders the scene as it is opened.
    pub(super) fn words(&self) -> Vec<String> {
        let mut words = self.options.command.clone();
        if let (Some(kept), Some(scene)) = (&self.kept, words.get_mut(SCENE)) {
            // The other words are about the scene that the viewer was started with.
            scene.clone_from(&kept.name);
            words.truncate(SCENE + 1);
        }
        if let Some(variant) = &self.opening.variant {
            if let Some(old) = words.iter().position(|word| word == "--variant") {
                words.drain(old..(old + 2).min(words.len()));
            }
            words.extend(["--variant".to_owned(), variant.clone()]);
        }
        words
    }

    /// The name of the scene's file.
    pub(super) fn title(&self) -> &str {
        self.kept.as_ref().map_or(&self.options.title, |kept| &kept.name)
    }

    /// Opens the scene again; if that fails, everything stays as it is.
    pub(super) fn reload(&mut self) -> Result<(), String> {
        let scene = (self.options.open)(&self.opening)?;
        self.take(scene)?;
        let again = self.edits.again(&mut self.session);
        self.go_home(!self.is_moved);
        again.map_err(|error| format!("the scene has changed, and the edits do not fit it any more: {error}"))
    }

    /// Opens a file that was dropped in, in the place of the scene; if that fails, everything stays as it is.
    pub(super) fn open(&mut self, dropped: Dropped) -> Result<(), String> {
        let Dropped { file, to } = dropped;
        let opened = match self.options.may_edit && self.options.may_drop {
            true => self.open_file(file),
            false => Err("this viewer opens no other files: start it with --edit".to_owned()),
        };
        // Whoever has dropped it may have gone.
        let _ = to.send(opened.clone());
        opened
    }

    fn open_file(&mut self, file: crate::dropped::Kept) -> Result<(), String> {
        let opening = Opening { file: Some(file.path()), ..Opening::default() };
        let scene = (self.options.open)(&opening).map_err(|error| shown_as(&error, &file))?;
        self.take(scene).map_err(|error| shown_as(&error, &file))?;
        (self.opening, self.edits) = (opening, Default::default());
        self.kept = Some(file);
        self.go_home(true);
        Ok(())
    }

    /// Opens the scene with another variant of its materials.
    pub(super) fn choose_variant(&mut self, name: String) -> Result<(), String> {
        if !self.session.scene().inventory.variants.contains(&name) {
            return Err(format!("there is no variant '{name}' of the materials"));
        }
        let before = self.opening.variant.replace(name);
        self.reload().inspect_err(|_| self.opening.variant = before)
    }

    /// Opens the scene at another time if its file has to be read for that.
    pub(super) fn pose(&mut self) -> Result<(), String> {
        let time = self.session.job().settings().time;
        if !self.session.scene().inventory.moves() || self.opening.time.unwrap_or(self.first_time) == time {
            return Ok(());
        }
        // The studio frames the model as it is; it would follow each movement.
        self.is_moved |= self.session.scene().cameras.is_empty() && self.eye.is_some();
        let before = self.opening.time.replace(time);
        self.reload().inspect_err(|_| self.opening.time = before)
    }

    /// Shows another scene; if that fails, everything stays as it is.
    fn take(&mut self, scene: SceneBuilder) -> Result<(), String> {
        self.watched.add(&scene.files);
        let (opened, settings) = (scene.clone(), settings::with_defaults(&self.user));
        let session = Session::within(scene, &settings, self.options.max_memory);
        self.session = session.map_err(|error| error.to_string())?;
        (self.unedited, self.layers) = (opened, Vec::new());
        if let Some(it) = &mut self.comparison {
            (it.session, it.is_current) = (None, false);
        }
        self.choose_layers().map_err(|error| error.to_string())
    }
}

/// A message that names a file as people know it.
fn shown_as(message: &str, file: &crate::dropped::Kept) -> String {
    message.replace(&file.path().display().to_string(), &file.name)
}
