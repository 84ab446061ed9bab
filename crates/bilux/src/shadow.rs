//! The shadow on an invisible ground: what denoises it, and the time that it takes.

use crate::{Error, Job};
use bilux_pictures::denoise::{Denoiser, Task, denoiser};
use bilux_transport::shadow_alpha_time;
use std::time::Duration;

impl Job {
    /// What removes the noise of a shadow on an invisible ground: the built-in filter, where the picture is denoised.
    pub(crate) fn shadow_denoiser(&self) -> Result<Option<Box<dyn Denoiser>>, Error> {
        if self.denoising_time()?.is_zero() {
            return Ok(None);
        }
        Ok(Some(denoiser("builtin", &self.threads_task())?.denoiser))
    }

    /// The time set aside for the shadow on an invisible ground.
    pub(crate) fn shadow_time(&self) -> Duration {
        if self.subject.catcher.is_none() || !self.settings.background.is_cut_out() {
            return Duration::ZERO;
        }
        let pixels = self.render.width as usize * self.render.height as usize;
        shadow_alpha_time(pixels, self.threads_task().thread_count())
    }

    fn threads_task(&self) -> Task {
        Task { threads: self.settings.threads, ..Task::default() }
    }
}
