//! Sampling of a job: all samples within a limit of time, ranges of them, those of one pixel, or one.

use super::{Job, Subject, denoising};
use crate::job::outcome::Surfaces;
use crate::limits::budget::time_for_rendering;
use crate::{Error, Outcome};
use bilux_transport::aovs::Aov;
use bilux_transport::{
    Checkpoint, Estimate, Observer, Progress, RenderError, RenderSettings, Rendered, Replay, SamplePlace,
    Silent, Stop, Strategies, Unobserved, Window, coverage, shadow_alpha,
};
use std::ops::Range;
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
        let surfaces = self.surfaces_within(end.map(|end| end - now), progress)?;
        render.stop.time_limit = end.map(|end| end.saturating_duration_since(Instant::now()));
        let rendered =
            bilux_transport::render_from(from, scene, camera, self.renders(), &render, progress, observer)?;
        self.completed(rendered, surfaces)
    }

    /// Features and labels of surfaces, as far as wanted; features take a part of the time that the picture may take.
    pub(crate) fn surfaces_within(
        &self,
        time: Option<Duration>,
        progress: &dyn Progress,
    ) -> Result<Surfaces, Error> {
        let begun = Instant::now();
        let labels = self.labels(progress)?;
        if !self.keeps_features() {
            return Ok(Surfaces { features: None, labels, time: begun.elapsed() });
        }
        let (scene, camera, integrator) = (self.scene(), self.camera(), self.integrator());
        let part = time.map(|time| time / FEATURES_PART);
        let features = bilux_transport::features(scene, camera, integrator, &self.render, part, progress)?;
        Ok(Surfaces { features, labels, time: begun.elapsed() })
    }

    /// Takes this many other samples of one pixel, at least two, and returns the mean of each colour channel with its 95%
    /// interval. `None` for integrators that are deterministic, and for those whose light paths reach any pixel: there the
    /// samples of one pixel take those of all.
    ///
    /// # Errors
    /// If the pixel is outside the picture, or memory is short.
    pub fn estimate(&self, [x, y]: [u32; 2], samples: u32) -> Result<Option<[Estimate; 3]>, Error> {
        let RenderSettings { width, height, .. } = self.render;
        if x >= width || y >= height {
            return Err(RenderError::Pixel { x, y, width, height }.into());
        }
        if !self.renders().is_random() || self.renders().splats() {
            return Ok(None);
        }
        let (pixel, spp) = (Window { x, y, width: 1, height: 1 }, samples.max(2));
        let render = RenderSettings { samples: 0..spp, spp, crop: Some(pixel), ..self.render.clone() };
        let render = RenderSettings { interval: true, stop: Stop::default(), batch_means: false, ..render };
        let (scene, camera) = (self.scene(), self.camera());
        let rendered = bilux_transport::render(scene, camera, self.renders(), &render, &Silent)?;
        Ok(rendered.interval.map(|interval| [0, 1, 2].map(|channel| interval.channel(&pixel, channel))))
    }

    /// Adds a range of samples to a picture that has all those before it; the first range also makes its features and
    /// its alpha. `None` if it was stopped: the picture is then as it was.
    pub(crate) fn add(
        &self,
        samples: Range<u32>,
        so_far: &mut Option<Outcome>,
        progress: &dyn Progress,
    ) -> Result<Option<()>, Error> {
        let mut render = RenderSettings { samples, ..self.render.clone() };
        (render.stop, render.batch_means) = (Stop::default(), false);
        let rendered =
            bilux_transport::render(self.scene(), self.camera(), self.renders(), &render, progress)?;
        if rendered.cancelled {
            return Ok(None);
        }
        if let Some(before) = so_far {
            before.rendered.film.merge(&rendered.film)?;
            before.rendered.counters += rendered.counters;
            return Ok(Some(()));
        }
        let surfaces = self.surfaces_within(None, progress)?;
        if progress.is_cancelled() {
            return Ok(None);
        }
        let [coverage, model_coverage] = self.coverage(&render, self.render.spp)?;
        let choice = self.chosen().map(|plan| plan.choice.clone());
        let rendered = Rendered { choice, interval: None, ..rendered };
        let linear_transfer = self.settings.linear_transfer;
        *so_far = Some(Outcome { rendered, surfaces, coverage, model_coverage, linear_transfer });
        Ok(Some(()))
    }

    /// Renders a picture for each of the integrator's strategies, from the same samples as the main picture. Returns
    /// `None` if it was stopped or there are no strategies.
    ///
    /// # Errors
    /// As [`Job::render`].
    pub fn strategies(&self, of: &Outcome, progress: &dyn Progress) -> Result<Option<Strategies>, Error> {
        self.strategies_of(of.rendered.reached.map(|reached| reached.spp), progress)
    }

    /// Renders a picture for each strategy from the first samples of each pixel; by default from all.
    ///
    /// # Errors
    /// As [`Job::render`].
    pub fn strategies_of(
        &self,
        samples: Option<u32>,
        progress: &dyn Progress,
    ) -> Result<Option<Strategies>, Error> {
        let mut settings = RenderSettings { stop: Stop::default(), ..self.render.clone() };
        if let Some(samples) = samples {
            (settings.spp, settings.samples) = (samples, 0..samples);
        }
        let Subject { scene, camera, integrator, .. } = &self.subject;
        Ok(bilux_transport::strategies(scene, &**camera, &**integrator, &settings, progress)?)
    }

    /// Traces one sample again and records what happens to it.
    ///
    /// # Errors
    /// If the pixel is outside the picture.
    pub fn replay(&self, x: u32, y: u32, sample: u32) -> Result<Replay, Error> {
        let (scene, camera, place) = (self.scene(), self.camera(), SamplePlace { x, y, sample });
        Ok(bilux_transport::replay(scene, camera, self.renders(), &self.render, place)?)
    }

    /// Adds to what was rendered whatever else the picture needs.
    pub(crate) fn completed(&self, mut rendered: Rendered, surfaces: Surfaces) -> Result<Outcome, Error> {
        let render = &self.render;
        let samples = rendered.reached.map_or(render.spp, |reached| reached.spp);
        let [coverage, model_coverage] = self.coverage(render, samples)?;
        if rendered.cancelled {
            rendered.batch_means = None;
        }
        if rendered.cancelled || render.crop.is_some() || render.samples != (0..render.spp) {
            self.fingerprint().clone_into(&mut rendered.film.fingerprint);
        }
        let chosen = || self.chosen().map(|plan| plan.choice.clone());
        rendered.choice = rendered.choice.or_else(chosen);
        let linear_transfer = self.settings.linear_transfer;
        Ok(Outcome { rendered, surfaces, coverage, model_coverage, linear_transfer })
    }

    /// The alpha of each pixel after so many samples; `None` for a picture without an alpha channel. If a shadow is part of it,
    /// also the coverage by the model alone.
    fn coverage(&self, render: &RenderSettings, samples: u32) -> Result<[Option<Vec<f32>>; 2], Error> {
        let Subject { scene, camera, integrator, catcher, .. } = &self.subject;
        let (camera, integrator) = (&**camera, &**integrator);
        Ok(match (self.settings.background.is_cut_out(), *catcher) {
            (false, _) => [None, None],
            (true, None) => [Some(coverage(scene, camera, integrator, render, samples)?), None],
            (true, Some(catcher)) => {
                let is_denoised = !self.denoising_time()?.is_zero();
                let denoiser = is_denoised.then(|| denoising::of_shadow(&self.settings)).transpose()?;
                let denoiser = denoiser.as_deref();
                shadow_alpha(scene, camera, integrator, render, samples, catcher, denoiser)?.map(Some)
            }
        })
    }

    /// The time that a limit leaves to other work than rendering, as far as it is spent by now or known.
    pub(crate) fn time_aside(&self, now: Instant) -> Result<Duration, Error> {
        let before = now.duration_since(self.request.begun.unwrap_or(now));
        Ok(before + self.denoising_time()? + denoising::shadow_time(&self.subject, &self.settings))
    }

    /// The time set aside for denoising.
    fn denoising_time(&self) -> Result<Duration, Error> {
        Ok(self.denoiser()?.map_or(Duration::ZERO, |chosen| chosen.time))
    }

    /// Whether albedo and the like are wanted.
    fn keeps_features(&self) -> bool {
        self.request.layers.iter().copied().any(Aov::is_feature)
            || self.request.denoiser_name(&self.settings).is_some()
    }
}
