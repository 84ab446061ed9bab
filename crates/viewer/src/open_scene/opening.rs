//! Opening the scene: again when its files change, with other variants, animations and environments, at other times, and
//! files that are dropped in.

use super::keeper::Keeper;
use crate::dropped::{Dropped, Kept};
use crate::options::{AS_OPENED, Opening};
use crate::settings;
use bilux::Session;
use bilux::scene::{Animation, SceneBuilder};
use std::sync::Arc;

/// The place of the scene's file in [`crate::Options::command`].
pub(crate) const SCENE: usize = 2;

impl Keeper {
    /// The words of the command line that renders the scene as it is opened.
    pub(super) fn words(&self) -> Vec<String> {
        let mut words = self.options.command.clone();
        if let (Some(kept), Some(scene)) = (&self.kept, words.get_mut(SCENE)) {
            // The other words are about the scene that the viewer was started with.
            scene.clone_from(&kept.name);
            words.truncate(SCENE + 1);
        }
        let Opening { variant, animation, environment, .. } = &self.opening;
        for (option, chosen) in [("--variant", variant), ("--animation", animation), ("--env", environment)] {
            let Some(chosen) = chosen else { continue };
            if let Some(old) = words.iter().position(|word| word == option) {
                words.drain(old..(old + 2).min(words.len()));
            }
            words.extend([option.to_owned(), chosen.clone()]);
        }
        words
    }

    /// The name of the scene's file.
    pub(super) fn title(&self) -> &str {
        self.kept.as_ref().map_or(&self.options.title, |kept| &kept.name)
    }

    /// Opens the scene again; if that fails, everything stays as it is. If only its edits do not fit it any more, it is open
    /// without them.
    pub(super) fn reload(&mut self) -> Result<(), String> {
        let scene = (self.options.open)(&self.opening)?;
        self.take(scene)?;
        let again = self.edits.again(&mut self.session);
        let message = |error| format!("the scene has changed, and the edits do not fit it any more: {error}");
        self.misfit = again.err().map(message);
        Ok(())
    }

    /// Opens a file that was dropped in, in the place of the scene; if that fails, everything stays as it is.
    pub(super) fn open(&mut self, dropped: Dropped) -> Result<(), String> {
        let Dropped { file, to } = dropped;
        let opened = self.open_file(file);
        // Whoever has dropped it may have gone.
        let _ = to.send(opened.clone());
        opened
    }

    fn open_file(&mut self, file: Kept) -> Result<(), String> {
        let opening = Opening { file: Some(file.path()), ..Opening::default() };
        let scene = (self.options.open)(&opening).map_err(|error| shown_as(&error, &file))?;
        let before = (self.user.clone(), self.time.take());
        // Camera and time were asked for in another scene.
        self.user.clone_from(&self.options.settings);
        settings::forget_camera(&mut self.user);
        self.take(scene).map_err(|error| {
            (self.user, self.time) = before;
            shown_as(&error, &file)
        })?;
        (self.opening, self.edits) = (opening, Default::default());
        self.kept = Some(Arc::new(file));
        self.files += 1;
        Ok(())
    }

    /// Opens the scene with another variant of its materials; with the one at the start if the name is empty.
    pub(super) fn choose_variant(&mut self, name: String) -> Result<(), String> {
        if !name.is_empty() && !self.session.scene().inventory.variants.contains(&name) {
            return Err(format!("there is no variant '{name}' of the materials"));
        }
        self.open_as(|opening| opening.variant = Some(name).filter(|name| !name.is_empty()))
    }

    /// Opens the scene with another one of its animations; with those at the start if the name is empty.
    pub(super) fn choose_animation(&mut self, name: String) -> Result<(), String> {
        let animations = &self.session.scene().inventory.animations;
        let is_there = (0..animations.len()).any(|i| animation_word(animations, i) == name);
        if !name.is_empty() && !is_there {
            return Err(format!("there is no animation '{name}' in the scene"));
        }
        self.open_as(|opening| opening.animation = Some(name).filter(|name| !name.is_empty()))
    }

    /// Lights the scene with another environment; with the one at the start if the name is empty.
    pub(super) fn choose_environment(&mut self, name: String) -> Result<(), String> {
        if name != AS_OPENED && !self.options.environments.contains(&name) {
            return Err(format!("there is no environment '{name}' to choose"));
        }
        self.open_as(|opening| opening.environment = Some(name).filter(|name| name != AS_OPENED))
    }

    /// Opens the scene in another way; if that fails, everything stays as it is.
    fn open_as(&mut self, change: impl FnOnce(&mut Opening)) -> Result<(), String> {
        let before = self.opening.clone();
        change(&mut self.opening);
        self.reload().inspect_err(|_| self.opening = before)
    }

    /// Opens the scene at another time if its file has to be read for that.
    pub(super) fn pose(&mut self) -> Result<(), String> {
        let time = self.session.job().settings().time;
        if !self.session.scene().inventory.moves() || self.opening.time.unwrap_or(self.first_time) == time {
            return Ok(());
        }
        self.open_as(|opening| opening.time = Some(time))
    }

    /// Shows another scene; if that fails, everything stays as it is.
    fn take(&mut self, scene: SceneBuilder) -> Result<(), String> {
        self.watched.add(&scene.files);
        let opened = scene.clone();
        let session = Session::new(scene, settings::request(&self.user, self.options.max_memory));
        self.session = session.map_err(|error| error.to_string())?;
        self.unedited = opened;
        Ok(())
    }
}

/// A message that names a file as people know it.
fn shown_as(message: &str, file: &Kept) -> String {
    message.replace(&file.path().display().to_string(), &file.name)
}

/// The word that chooses an animation on the command line: its name if no other one has it, or else its number from 0, with
/// zeros before it if it is a name of another one.
pub(crate) fn animation_word(animations: &[Animation], index: usize) -> String {
    let is_named = |word: &str| animations.iter().filter(|animation| animation.name == word).count();
    let name = &animations[index].name;
    if !name.is_empty() && is_named(name) == 1 {
        return name.clone();
    }
    let mut number = index.to_string();
    while is_named(&number) > 0 {
        number.insert(0, '0');
    }
    number
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names need not be there, nor be different (glTF 2.0, 5.1.1), and a name is looked for before a number is.
    #[test]
    fn every_animation_has_a_word_of_its_own() {
        let named = |name: &&str| Animation { name: (*name).to_owned(), seconds: 1.0, plays: false };
        let words = |names: &[&str]| -> Vec<String> {
            let all: Vec<Animation> = names.iter().map(named).collect();
            (0..all.len()).map(|i| animation_word(&all, i)).collect()
        };
        assert_eq!(words(&["walk", "run"]), ["walk", "run"]);
        assert_eq!(words(&["walk", "walk", ""]), ["0", "1", "2"]);
        assert_eq!(words(&["1", "walk", "walk", "02"]), ["1", "01", "2", "02"]);
        assert_eq!(words(&["2", "2", "", "02"]), ["0", "1", "002", "02"]);
    }
}
