//! A job in several ranges of samples, whose sum is the picture of all of them.

use super::Job;
use crate::settings::Settings;
use crate::{Error, Outcome};
use bilux_transport::integrators::PixelIntegrator;
use bilux_transport::{
    Estimate, Plan, Progress, RenderError, RenderSettings, Rendered, Silent, Stop, Window,
};
use std::ops::Range;

impl Job {
    /// What an integrator that chooses its strategies has chosen, once for all samples that are rendered from now on in
    /// several ranges or parts. The picture is the same without it, but every range would begin with a choice.
    ///
    /// # Errors
    /// As for [`Job::render`].
    pub fn plan(&self) -> Result<Option<&Plan>, Error> {
        if self.known.plan.get().is_none() {
            let plan = bilux_transport::plan(self.scene(), self.camera(), self.integrator(), &self.render)?;
            // Another thread may have been faster, with the same result.
            let _ = self.known.plan.set(plan);
        }
        Ok(self.chosen())
    }

    /// What it has chosen so far.
    pub(super) fn chosen(&self) -> Option<&Plan> {
        self.known.plan.get().and_then(Option::as_ref)
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
        let (scene, camera, integrator) = (self.scene(), self.camera(), self.integrator());
        let rendered = bilux_transport::render(scene, camera, self.renders(), &render, progress)?;
        if rendered.cancelled {
            return Ok(None);
        }
        if let Some(before) = so_far {
            before.rendered.film.merge(&rendered.film)?;
            before.rendered.counters += rendered.counters;
            return Ok(Some(()));
        }
        let mut features = None;
        if self.keeps_features() {
            features = bilux_transport::features(scene, camera, integrator, &render, None, progress)?;
            if features.is_none() {
                return Ok(None);
            }
        }
        let [coverage, model_coverage] = self.coverage(&render, self.render.spp)?;
        let choice = self.chosen().map(|plan| plan.choice.clone());
        let rendered = Rendered { choice, interval: None, ..rendered };
        let linear_transfer = self.settings.linear_transfer;
        *so_far = Some(Outcome { rendered, features, coverage, model_coverage, linear_transfer });
        Ok(Some(()))
    }

    /// The integrator that takes the samples.
    pub(crate) fn renders(&self) -> &dyn PixelIntegrator {
        self.chosen().map_or(self.integrator(), |plan| &*plan.integrator)
    }

    /// The picture with settings that change no sample, and the number of samples ([`Settings::takes_samples_of`]).
    pub(crate) fn showing(&self, settings: &Settings) -> Job {
        let Settings { spp, threads, fps, exposure, states_exposure, auto_exposure, .. } = *settings;
        let Settings { background, linear_transfer, .. } = *settings;
        let (tonemap, denoise) = (settings.tonemap.clone(), settings.denoise.clone());
        let settings = Settings {
            spp,
            threads,
            fps,
            exposure,
            states_exposure,
            auto_exposure,
            background,
            linear_transfer,
            tonemap,
            denoise,
            ..self.settings.clone()
        };
        let render = RenderSettings { threads, spp, samples: 0..spp, ..self.render.clone() };
        Job { settings, render, ..self.clone() }
    }

    /// True if the number of samples changes nothing but the number of samples.
    pub(crate) fn may_take_more(&self) -> bool {
        self.integrator().is_random() && !self.settings.background.is_cut_out()
    }
}
