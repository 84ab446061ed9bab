//! What becomes of a view when the scene changes, or the shape of the window.

use super::Stage;
use crate::eye::Eye;
use crate::settings::{self, Level};

impl Stage {
    /// Takes the newest version of the scene; if that fails, everything stays as it is, and it is tried again with the next
    /// request: the settings that it does not fit, such as a camera that is gone, may have changed.
    pub(super) fn take_newest(&mut self) -> Result<(), String> {
        let Some(newest) = self.common.open.newest().filter(|it| it.number != self.version.number) else {
            return Ok(());
        };
        let before = std::mem::replace(&mut self.version, newest);
        let camera = (self.user.clone(), self.eye, self.is_moved);
        let (is_other_file, is_posed) =
            (before.file != self.version.file, before.opening.time != self.version.opening.time);
        if is_other_file {
            settings::forget_camera(&mut self.user);
            (self.is_moved, self.eye) = (false, None);
        }
        // The studio frames the model as it is; it would follow each movement.
        self.is_moved |= is_posed && self.version.scene.cameras.is_empty() && self.eye.is_some();
        let mut asked = settings::with_defaults(&self.asked());
        settings::set_level(&mut asked, &self.version.scene.settings, self.size, self.level);
        let (scene, built) = (self.version.scene.clone(), self.version.built.clone());
        if let Err(error) = self.session.replace(scene, &asked, built) {
            self.version = before;
            (self.user, self.eye, self.is_moved) = camera;
            return Err(error.to_string());
        }
        if let Some(it) = &mut self.comparison {
            (it.session, it.is_current) = (None, false);
        }
        self.find_home();
        if !self.is_moved {
            self.eye = self.home;
        }
        self.choose_denoiser().map_err(|error| error.to_string())
    }

    /// Renders pictures of this size from now on, or smaller ones of the same shape if there is no room for them. Whatever
    /// was in the picture stays in it: the scene's own camera may stand farther away where a window is narrow, and a camera
    /// that was moved does the same.
    pub(super) fn resize(&mut self, wanted: [u32; 2]) {
        let pixels = u64::from(wanted[0]) * u64::from(wanted[1]);
        let pictures = 1 + u64::from(self.comparison.is_some());
        let (room, most) = (&self.common.room, self.common.max_memory);
        let granted = room.take(self.number, [pictures, pixels], &self.version.scene, most);
        let factor = (granted as f64 / pixels.max(1) as f64).sqrt().min(1.0);
        let size = wanted.map(|side| ((f64::from(side) * factor) as u32).max(1));
        self.wanted_size = wanted;
        if size == self.size && self.home.is_some() {
            return;
        }
        self.size = size;
        let before = self.home;
        self.find_home();
        match (self.is_moved, &mut self.eye, before, self.home) {
            (true, Some(eye), Some(before), Some(home)) => eye.keep_in_view(&before, &home),
            (true, ..) => {}
            (false, ..) => self.eye = self.home,
        }
    }

    /// Finds where the scene has its camera in a window of this shape.
    pub(super) fn find_home(&mut self) {
        let mut asked = settings::at_time(&self.user, &self.version);
        asked = settings::with_defaults(&asked);
        let scene = self.session.scene();
        settings::set_level(&mut asked, &scene.settings, self.size, Level::Full);
        self.home = Eye::at_home(self.session.job(), scene, &asked);
    }
}
