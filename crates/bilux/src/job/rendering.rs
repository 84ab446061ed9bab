//! A job from its first sample to its last, within a limit of time.

use super::Job;
use crate::budget::time_for_rendering;
use crate::{Error, Outcome};
use bilux_transport::{Checkpoint, Features, Observer, Progress, Unobserved};
use std::time::{Duration, Instant};

/// If a time limit ends the picture, the pass that collects surface features (albedo, normals, …) takes at most one
/// part in this many of it.
const FEATURES_PART: u32 = 12;

impl Job {
    /// Renders the picture.
    ///
    /// # Errors
    /// If the size or the crop makes no sense, memory is short, or the denoiser that was asked for is not available.
    pub fn render(&self, progress: &dyn Progress) -> Result<Outcome, Error> {
        self.render_observed(None, Duration::ZERO, progress, &Unobserved)
    }

    /// Renders what a checkpoint lacks, if there is one. `aside` is the time that was spent before on other work than
    /// rendering.
    pub(crate) fn render_observed(
        &self,
        from: Option<Checkpoint>,
        aside: Duration,
        progress: &dyn Progress,
        observer: &dyn Observer,
    ) -> Result<Outcome, Error> {
        let now = Instant::now();
        let (scene, camera) = (self.scene(), self.camera());
        let mut render = self.render.clone();
        let aside = aside + self.time_aside(now)?;
        let end = render.stop.time_limit.map(|limit| now + time_for_rendering(limit, aside));
        let features = self.features_within(end.map(|end| end - now), progress)?;
        render.stop.time_limit = end.map(|end| end.saturating_duration_since(Instant::now()));
        let rendered =
            bilux_transport::render_from(from, scene, camera, self.renders(), &render, progress, observer)?;
        self.completed(rendered, features)
    }

    /// The time that a limit leaves to other work than rendering, as far as it is spent by now or known.
    pub(crate) fn time_aside(&self, now: Instant) -> Result<Duration, Error> {
        let before = now.duration_since(self.request.begun.unwrap_or(now));
        Ok(before + self.denoising_time()? + self.shadow_time())
    }

    /// The features of surfaces, if they are wanted, in a part of the time that the picture may take.
    pub(crate) fn features_within(
        &self,
        time: Option<Duration>,
        progress: &dyn Progress,
    ) -> Result<Option<Features>, Error> {
        if !self.keeps_features() {
            return Ok(None);
        }
        let (scene, camera, integrator) = (self.scene(), self.camera(), self.integrator());
        let part = time.map(|time| time / FEATURES_PART);
        Ok(bilux_transport::features(scene, camera, integrator, &self.render, part, progress)?)
    }
}
