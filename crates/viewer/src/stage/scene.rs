//! Changes of a view when the scene changes, or the shape of the window.

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
        let camera = (self.user.clone(), self.viewpoint);
        let (is_other_file, is_posed) =
            (before.file != self.version.file, before.opening.time != self.version.opening.time);
        if is_other_file {
            settings::forget_camera(&mut self.user);
            (self.viewpoint.is_moved, self.viewpoint.eye) = (false, None);
        }
        // The studio frames the model as it is; it would follow each movement.
        self.viewpoint.is_moved |=
            is_posed && self.version.scene.cameras.is_empty() && self.viewpoint.eye.is_some();
        let mut asked = settings::with_defaults(&self.asked());
        settings::set_level(
            &mut asked,
            &self.version.scene.settings,
            self.viewpoint.size,
            self.refinement.level,
        );
        let (scene, built) = (self.version.scene.clone(), self.version.built.clone());
        if let Err(error) = self.session.replace(scene, &asked, built) {
            self.version = before;
            (self.user, self.viewpoint) = camera;
            return Err(error.to_string());
        }
        if let Some(it) = &mut self.comparison {
            it.forget();
        }
        self.viewpoint.home = self.home();
        if !self.viewpoint.is_moved {
            self.viewpoint.go_home();
        }
        self.choose_denoiser().map_err(|error| error.to_string())
    }

    /// Renders pictures of this size from now on, or smaller ones of the same shape if there is no room for them. Whatever
    /// was in the picture stays in it.
    pub(super) fn resize(&mut self, wanted: [u32; 2]) {
        let pixels = u64::from(wanted[0]) * u64::from(wanted[1]);
        let pictures = 1 + u64::from(self.comparison.is_some());
        let (room, most) = (&self.common.room, self.common.max_memory);
        let granted = room.take(self.number, [pictures, pixels], &self.version.scene, most);
        if self.viewpoint.resize(wanted, granted, self.session.job().camera().shape()) {
            let home = self.home();
            self.viewpoint.keep_in_view(home);
        }
    }

    /// Camera of the scene in a window of this shape.
    pub(super) fn home(&self) -> Option<Eye> {
        let mut asked = settings::with_defaults(&settings::at_time(&self.user, self.version.time.as_ref()));
        let scene = self.session.scene();
        settings::set_level(&mut asked, &scene.settings, self.viewpoint.size, Level::Full);
        Eye::at_home(self.session.job(), scene, &asked)
    }
}
