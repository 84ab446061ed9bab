//! A scene that is edited while its picture is refined: what a viewer shows, and what makes many pictures of one scene.
mod edit;
mod showing;
pub mod watch;

pub use edit::Edit;

use crate::job::progressive::{Budget, Progressive};
use crate::preparation::built::Built;
use crate::{Denoised, Error, Job, JobRequest, Outcome, Settings};
use bilux_pictures::Picture;
use bilux_scene::{Parameters, SceneBuilder, TreeWork, Value};
use bilux_transport::Progress;
use bilux_transport::aovs::Aov;
use showing::{may_take_more, showing};

/// A scene, its settings, and a picture that is refined step by step. After an edit only what changed is built anew, and
/// the picture starts again, unless the edit changes no sample.
///
/// ```
/// use bilux::math::Motion;
/// use bilux::prelude::*;
/// use bilux::{Budget, Edit, Session};
///
/// let scene = bilux::generate(&Spec::new("", "cornell"))?;
/// let mut session = Session::new(scene, JobRequest::new().size(16, 16).spp(4))?;
/// session.step(Budget::Samples(2), &Quiet)?;
/// session.apply(Edit::Set("exposure".to_owned(), Value::Number(1.0)))?;
/// assert_eq!(session.samples(), 2, "only the display changes");
/// session.apply(Edit::Place(0, Motion::still(Transform::translate(Vec3::Y).ok_or("a translation")?)))?;
/// assert_eq!(session.samples(), 0, "the picture starts again");
/// session.step(Budget::Samples(4), &Quiet)?;
/// assert!(session.picture()?.is_some() && session.is_done());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Session {
    scene: SceneBuilder,
    request: JobRequest,
    built: Built,
    picture: Progressive,
}

impl Session {
    /// A session with a scene, and with what is asked of its picture; edits keep to that too. Limits of noise and time have no
    /// effect: the steps decide when the picture is good enough, up to the number of samples that the settings say. Nothing is denoised.
    ///
    /// # Errors
    /// As for [`Job::new`].
    pub fn new(scene: SceneBuilder, request: impl Into<JobRequest>) -> Result<Session, Error> {
        Session::sharing(scene, request, Built::default())
    }

    /// A session with what another one has built of the scene ([`Session::built`]): both then hold the same trees.
    ///
    /// # Errors
    /// As for [`Session::new`].
    pub fn sharing(
        scene: SceneBuilder,
        request: impl Into<JobRequest>,
        mut built: Built,
    ) -> Result<Session, Error> {
        let request = without_limits(request.into());
        let job = Job::with_built(&scene, request.clone(), &mut built)?;
        Ok(Session { scene, request, built, picture: Progressive::new(job) })
    }

    /// Keeps these layers of the picture ([`JobRequest::layers`]) from now on. The picture starts again.
    ///
    /// # Errors
    /// As for [`Session::new`].
    pub fn with_layers(&mut self, wanted: &[Aov]) -> Result<(), Error> {
        self.restart(self.scene.clone(), self.request.clone().layers(wanted))
    }

    /// Makes an edit. Returns whether the picture starts again.
    ///
    /// # Errors
    /// If the edit names what there is not, or what it makes is wrong: then the session stays as it was.
    pub fn apply(&mut self, edit: Edit) -> Result<bool, Error> {
        self.apply_all(vec![edit])
    }

    /// Makes several edits, one after the other, and builds the scene once.
    ///
    /// # Errors
    /// As for [`Session::apply`]; no edit is made if one of them is wrong.
    pub fn apply_all(&mut self, edits: Vec<Edit>) -> Result<bool, Error> {
        let (mut scene, mut request) = (self.scene.clone(), self.request.clone());
        let mut changes_scene = false;
        for edit in edits {
            changes_scene |= edit.make(&mut scene, &mut request.settings)?;
        }
        let request = without_limits(request);
        let before = Settings::of(&self.scene, &self.request.settings)?;
        let settings = Settings::of(&scene, &request.settings)?;
        let has_room =
            settings.spp == before.spp || settings.spp >= self.samples() && may_take_more(&self.picture.job);
        if changes_scene || !has_room || !settings.takes_samples_of(&before) {
            self.restart(scene, request)?;
            return Ok(true);
        }
        let shown = showing(&self.picture.job, &settings);
        shown.write_options()?;
        self.picture.job = shown;
        if let Some(outcome) = &mut self.picture.so_far {
            outcome.linear_transfer = settings.linear_transfer;
        }
        (self.scene, self.request) = (scene, request);
        Ok(false)
    }

    /// Shows another scene with other settings, and with what another session has built of it. The picture starts again.
    ///
    /// # Errors
    /// As for [`Session::new`]: then the session stays as it was.
    pub fn replace(&mut self, scene: SceneBuilder, user: &Parameters, built: Built) -> Result<(), Error> {
        let before = std::mem::replace(&mut self.built, built);
        let request = JobRequest { settings: user.clone(), ..self.request.clone() };
        let replaced = self.restart(scene, without_limits(request));
        if replaced.is_err() {
            self.built = before;
        }
        replaced
    }

    /// Starts the picture of another scene or of other settings.
    fn restart(&mut self, scene: SceneBuilder, request: JobRequest) -> Result<(), Error> {
        let job = Job::with_built(&scene, request.clone(), &mut self.built)?;
        job.write_options()?;
        self.picture.restart(job);
        (self.scene, self.request) = (scene, request);
        Ok(())
    }

    /// Refines the picture, as [`Progressive::step`].
    ///
    /// # Errors
    /// As for [`Job::render`].
    pub fn step(&mut self, budget: Budget, progress: &dyn Progress) -> Result<u32, Error> {
        self.picture.step(budget, progress)
    }

    /// The picture so far, with its film and its layers; `None` before the first step.
    pub fn outcome(&self) -> Option<&Outcome> {
        self.picture.outcome()
    }

    /// The picture so far, in linear light; `None` before the first step.
    ///
    /// # Errors
    /// If memory is short.
    pub fn picture(&self) -> Result<Option<Picture>, Error> {
        self.picture.picture()
    }

    /// The samples of each pixel so far.
    pub fn samples(&self) -> u32 {
        self.picture.samples()
    }

    /// True when all samples were taken.
    pub fn is_done(&self) -> bool {
        self.picture.is_done()
    }

    /// The scene with all edits.
    pub fn scene(&self) -> &SceneBuilder {
        &self.scene
    }

    /// The job that takes the samples: its settings, its warnings, and how its pictures are shown.
    pub fn job(&self) -> &Job {
        &self.picture.job
    }

    /// Parts that were built of the scene, for sessions that share it ([`Session::sharing`]).
    pub fn built(&self) -> &Built {
        &self.built
    }

    /// The trees that were built so far.
    pub fn tree_work(&self) -> TreeWork {
        self.built.tree_work()
    }
}

/// Request without limits of noise and time, for all samples, not denoised.
fn without_limits(request: JobRequest) -> JobRequest {
    let request = JobRequest { samples: None, denoised: Denoised::No, ..request };
    request.set("noise", Value::Integer(0)).set("time_limit", Value::Integer(0))
}
