//! One render: a scene, a camera, an integrator and settings, combined and checked.

mod making;
mod ranges;
mod rendering;
mod subject;

use crate::Error;
use crate::fingerprint::fingerprint;
use crate::outcome::Outcome;
use crate::request::JobRequest;
use crate::series::Series;
use crate::settings::Settings;
use bilux_pictures::denoise::DenoiserChoice;
use bilux_scene::{Camera, Orientation, Scene, SceneBuilder, Warning};
use bilux_transport::integrators::PixelIntegrator;
use bilux_transport::{
    Features, Plan, Progress, RenderSettings, Rendered, Replay, SamplePlace, Stop, Strategies, coverage,
    shadow_alpha,
};
use std::sync::{Arc, OnceLock};
use std::time::Instant;
pub(crate) use subject::Subject;

/// A picture to be rendered. It never changes; [`at_time`](Job::at_time) and the like make other jobs of it.
#[derive(Clone)]
pub struct Job {
    /// What is rendered.
    pub(crate) subject: Subject,
    /// How the picture is to be, as the scene and the request say it together.
    pub(crate) settings: Settings,
    /// How the samples are taken.
    pub(crate) render: RenderSettings,
    /// What was asked for.
    pub(crate) request: JobRequest,
    /// What was found out while it was made.
    pub(crate) found: Arc<Found>,
    /// What is found out when it is first needed.
    pub(crate) known: Arc<Known>,
}

/// What is found out while a job is made.
pub(crate) struct Found {
    warnings: Vec<Warning>,
    notes: Vec<String>,
    studio_light: Option<String>,
    /// How a model was rotated.
    orientation: Option<Orientation>,
    /// The tone curve that `auto` means here.
    pub(crate) auto_curve: &'static str,
}

/// What is found out when it is first needed.
#[derive(Default)]
pub(crate) struct Known {
    fingerprint: OnceLock<String>,
    /// What the integrator has chosen.
    plan: OnceLock<Option<Plan>>,
    /// What denoises the picture.
    pub(crate) denoiser: OnceLock<Option<Arc<DenoiserChoice>>>,
}

impl Job {
    /// The picture at another time, in seconds. Static objects are not rebuilt.
    #[must_use]
    pub fn at_time(&self, time: f32) -> Job {
        let settings = Settings { time, ..self.settings.clone() };
        let subject = self.subject.at_time_of(&settings);
        Job { subject, settings, known: Arc::default(), ..self.clone() }
    }

    /// The picture with another beginning of its time limit ([`JobRequest::begun_at`]), as the next frame of an animation has.
    #[must_use]
    pub fn begun_at(&self, begun: Instant) -> Job {
        Job { request: self.request.clone().begun_at(begun), ..self.clone() }
    }

    /// The picture with a count of its work ([`JobRequest::counting_work`]).
    #[must_use]
    pub fn counting_work(&self) -> Job {
        Job { render: RenderSettings { count_work: true, ..self.render.clone() }, ..self.clone() }
    }

    /// The picture of a scene whose meshes move to their pose in the next frame, for the layer of motion. Other movement is
    /// known without it.
    #[must_use]
    pub fn moving_to(&self, next: &Job) -> Job {
        let next_pose = Some(Arc::new(next.subject.clone()));
        Job { subject: Subject { next_pose, ..self.subject.clone() }, ..self.clone() }
    }

    /// The series of this picture and of those that are to be lit as it is.
    pub fn series(&self) -> Series {
        Series { turn: self.settings.studio.turn, own_light: self.settings.own_light }
    }

    /// What is odd about the picture, even though it can be rendered.
    pub fn warnings(&self) -> &[Warning] {
        &self.found.warnings
    }

    /// What was decided where the scene leaves a choice, such as what lights it.
    pub fn notes(&self) -> &[String] {
        &self.found.notes
    }

    /// What the studio lights the scene with, as a list in words, if nothing else is to be told about its light.
    pub fn studio_light(&self) -> Option<&str> {
        self.found.studio_light.as_deref()
    }

    /// How the model was rotated, if it came without a camera or the user asked for a rotation.
    pub fn orientation(&self) -> Option<Orientation> {
        self.found.orientation
    }

    /// The number of samples that each pixel gets, unless noise or time ends the picture.
    pub fn samples_per_pixel(&self) -> u32 {
        self.render.samples.end - self.render.samples.start
    }

    /// The number of samples that each pixel was to get, if noise or time alone does not decide it.
    pub fn asked_samples(&self) -> Option<u32> {
        self.settings.asked_spp().map(|_| self.samples_per_pixel())
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.subject.scene
    }

    /// The scene's description, with what the studio adds, and the camera where the settings have moved it.
    pub fn completed_scene(&self) -> &SceneBuilder {
        &self.subject.source
    }

    /// The camera.
    pub fn camera(&self) -> &dyn Camera {
        &*self.subject.camera
    }

    pub(crate) fn integrator(&self) -> &dyn PixelIntegrator {
        &*self.subject.integrator
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Adds to what was rendered whatever else the picture needs.
    pub(crate) fn completed(
        &self,
        mut rendered: Rendered,
        features: Option<Features>,
    ) -> Result<Outcome, Error> {
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
        Ok(Outcome { rendered, features, coverage, model_coverage, linear_transfer })
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
                let denoiser = self.shadow_denoiser()?;
                let denoiser = denoiser.as_deref();
                shadow_alpha(scene, camera, integrator, render, samples, catcher, denoiser)?.map(Some)
            }
        })
    }

    /// True if its integrator's strategies can be shown separately.
    pub fn has_strategies(&self) -> bool {
        self.subject.integrator.has_strategies()
    }

    /// Renders a picture for each of the integrator's strategies, from the same samples as the main picture. Returns
    /// `None` if it was stopped or there are no strategies.
    ///
    /// # Errors
    /// As [`Job::render`].
    pub fn strategies(&self, of: &Outcome, progress: &dyn Progress) -> Result<Option<Strategies>, Error> {
        self.strategies_of(of.rendered.reached.map(|reached| reached.spp), progress)
    }

    /// The same for the first samples of each pixel; by default for all.
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

    /// The fingerprint of this picture: partial films merge only if it agrees.
    pub fn fingerprint(&self) -> &str {
        self.known.fingerprint.get_or_init(|| {
            let plain = fingerprint(&self.subject.source, &self.settings);
            if self.render.interval { plain + "-replicates" } else { plain }
        })
    }
}
