//! One render: a scene, a camera, an integrator and settings, combined and checked.
pub mod compositing;
mod denoising;
pub mod fingerprint;
pub(crate) mod labels;
pub(crate) mod layers;
mod making;
pub(crate) mod outcome;
pub(crate) mod own_light;
pub mod parts;
pub mod progressive;
mod rendering;
mod sensors;
pub mod series;
mod subject;
mod writing;

use crate::Error;
use crate::job::fingerprint::fingerprint;
use crate::job::series::Series;
use crate::request::JobRequest;
use crate::settings::Settings;
use bilux_pictures::denoise::DenoiserChoice;
use bilux_scene::{Camera, Orientation, Scene, SceneBuilder, Warning};
use bilux_transport::integrators::PixelIntegrator;
use bilux_transport::{Plan, RenderSettings};
use std::sync::{Arc, OnceLock};
use std::time::Instant;
pub(crate) use subject::Subject;

/// A picture to be rendered. It never changes; [`at_time`](Job::at_time) and the like make other jobs of it.
#[derive(Clone)]
pub struct Job {
    /// The scene, the camera and the integrator.
    pub(crate) subject: Subject,
    /// The settings of the scene and the request together.
    pub(crate) settings: Settings,
    /// The settings of the sampling.
    pub(crate) render: RenderSettings,
    /// The request.
    pub(crate) request: JobRequest,
    /// Facts that were found out while the job was made.
    pub(crate) found: Arc<Found>,
    /// Facts that are found out when they are first needed.
    pub(crate) known: Arc<Known>,
}

/// Facts that are found out while a job is made.
pub(crate) struct Found {
    warnings: Vec<Warning>,
    notes: Vec<String>,
    studio_light: Option<String>,
    /// The rotation of a model.
    orientation: Option<Orientation>,
    /// The tone curve that `auto` means here.
    pub(crate) auto_curve: &'static str,
}

/// Facts that are found out when they are first needed.
#[derive(Default)]
pub(crate) struct Known {
    fingerprint: OnceLock<String>,
    /// The choice of the integrator.
    plan: OnceLock<Option<Plan>>,
    /// The denoiser of the picture, once something is denoised.
    denoiser: OnceLock<Arc<DenoiserChoice>>,
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

    /// The picture of a scene whose meshes move from their pose in the previous frame, for the layer of backward motion.
    #[must_use]
    pub fn moving_from(&self, previous: &Job) -> Job {
        let previous_pose = Some(Arc::new(previous.subject.clone()));
        Job { subject: Subject { previous_pose, ..self.subject.clone() }, ..self.clone() }
    }

    /// The series of this picture and of those that are to be lit as it is.
    pub fn series(&self) -> Series {
        Series { turn: self.settings.studio.turn, own_light: self.settings.own_light }
    }

    /// Warnings: what is odd about the picture, even though it can be rendered.
    pub fn warnings(&self) -> &[Warning] {
        &self.found.warnings
    }

    /// Decisions that were made where the scene leaves a choice, such as what lights it.
    pub fn notes(&self) -> &[String] {
        &self.found.notes
    }

    /// Lights that the studio adds to the scene, as a list in words, if nothing else is to be told about its light.
    pub fn studio_light(&self) -> Option<&str> {
        self.found.studio_light.as_deref()
    }

    /// Rotation of the model, if it came without a camera or the user asked for a rotation.
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

    /// Choice of an integrator that chooses its strategies, made once for all samples that are rendered from now on in several
    /// ranges or parts. The picture is the same without it, but every range would begin with a choice.
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

    /// Choice that the integrator has made so far.
    fn chosen(&self) -> Option<&Plan> {
        self.known.plan.get().and_then(Option::as_ref)
    }

    /// The integrator that takes the samples.
    pub(crate) fn renders(&self) -> &dyn PixelIntegrator {
        self.chosen().map_or(self.integrator(), |plan| &*plan.integrator)
    }

    /// Denoiser of the picture, if any ([`JobRequest::denoised`]).
    ///
    /// # Errors
    /// If the denoiser that was asked for is not available.
    pub fn denoiser(&self) -> Result<Option<&Arc<DenoiserChoice>>, Error> {
        if self.known.denoiser.get().is_none()
            && let Some(chosen) = denoising::chosen(&self.request, &self.settings, &self.render)?
        {
            // Another thread may have been faster, with the same result.
            let _ = self.known.denoiser.set(Arc::new(chosen));
        }
        Ok(self.known.denoiser.get())
    }

    /// True if its integrator's strategies can be shown separately.
    pub fn has_strategies(&self) -> bool {
        self.subject.integrator.has_strategies()
    }

    /// The fingerprint of this picture: partial films merge only if it agrees.
    pub fn fingerprint(&self) -> &str {
        self.known.fingerprint.get_or_init(|| {
            let plain = fingerprint(&self.subject.source, &self.settings);
            if self.render.interval { plain + "-replicates" } else { plain }
        })
    }
}
