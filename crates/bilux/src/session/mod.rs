//! A scene that is edited while its picture is refined: what a viewer shows, and what makes many pictures of one scene.

mod edit;

pub use edit::Edit;

use crate::built::Built;
use crate::progressive::{Budget, Progressive};
use crate::series::Series;
use crate::{Error, Job, Outcome, Settings};
use bilux_pictures::Picture;
use bilux_scene::{Parameters, SceneBuilder, TreeWork, Value};
use bilux_transport::Progress;
use bilux_transport::aovs::Aov;

/// A scene, its settings, and a picture that is refined step by step. After an edit only what changed is built anew, and
/// the picture starts again, unless the edit changes no sample.
///
/// ```
/// use bilux::math::Motion;
/// use bilux::prelude::*;
/// use bilux::{Budget, Edit, Session};
///
/// let scene = bilux::generate(&Spec::new("", "cornell"))?;
/// let mut settings = Parameters::default();
/// settings.set("size", "16x16");
/// settings.set("spp", Value::Integer(4));
/// let mut session = Session::new(scene, &settings)?;
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
    user: Parameters,
    most: u64,
    layers: Vec<Aov>,
    built: Built,
    picture: Progressive,
}

impl Session {
    /// A session with a scene and the user's settings, which take precedence over the scene's. Limits of noise and time
    /// have no effect: the steps decide when the picture is good enough, up to the number of samples that the settings
    /// say.
    ///
    /// # Errors
    /// If a setting or anything in the scene is wrong.
    pub fn new(scene: SceneBuilder, user: &Parameters) -> Result<Session, Error> {
        Session::within(scene, user, u64::MAX)
    }

    /// The same, but only if `most` bytes of memory are enough; edits keep to it too.
    ///
    /// # Errors
    /// As for [`Session::new`]; and if the picture would take more memory.
    pub fn within(scene: SceneBuilder, user: &Parameters, most: u64) -> Result<Session, Error> {
        Session::sharing(scene, user, most, Built::default())
    }

    /// The same, with what another session has built of the scene ([`Session::built`]): both then hold the same trees.
    ///
    /// # Errors
    /// As for [`Session::within`].
    pub fn sharing(
        scene: SceneBuilder,
        user: &Parameters,
        most: u64,
        mut built: Built,
    ) -> Result<Session, Error> {
        let user = without_limits(user.clone());
        let job = Job::with_built(&scene, &user, most, &Series::default(), &mut built)?;
        let picture = Progressive::new(job);
        Ok(Session { scene, user, most, layers: Vec::new(), built, picture })
    }

    /// Keeps these layers of the picture ([`Job::with_layers`]) from now on. The picture starts again.
    ///
    /// # Errors
    /// As for [`Session::new`].
    pub fn with_layers(&mut self, wanted: &[Aov]) -> Result<(), Error> {
        self.layers = wanted.to_vec();
        self.restart(self.scene.clone(), self.user.clone())
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
        let (mut scene, mut user) = (self.scene.clone(), self.user.clone());
        let mut changes_scene = false;
        for edit in edits {
            changes_scene |= edit.make(&mut scene, &mut user)?;
        }
        let user = without_limits(user);
        let before = Settings::of(&self.scene, &self.user)?;
        let settings = Settings::of(&scene, &user)?;
        let has_room =
            settings.spp == before.spp || settings.spp >= self.samples() && self.picture.job.may_take_more();
        if changes_scene || !has_room || !settings.takes_samples_of(&before) {
            self.restart(scene, user)?;
            return Ok(true);
        }
        self.picture.job.show(&settings);
        if let Err(error) = self.picture.job.write_options() {
            self.picture.job.show(&before);
            return Err(error);
        }
        if let Some(outcome) = &mut self.picture.so_far {
            outcome.linear_transfer = settings.linear_transfer;
        }
        (self.scene, self.user) = (scene, user);
        Ok(false)
    }

    /// Shows another scene with other settings, and with what another session has built of it. The picture starts again.
    ///
    /// # Errors
    /// As for [`Session::within`]: then the session stays as it was.
    pub fn replace(&mut self, scene: SceneBuilder, user: &Parameters, built: Built) -> Result<(), Error> {
        let before = std::mem::replace(&mut self.built, built);
        let user = without_limits(user.clone());
        let replaced = self.restart(scene, user);
        if replaced.is_err() {
            self.built = before;
        }
        replaced
    }

    /// Starts the picture of another scene or of other settings.
    fn restart(&mut self, scene: SceneBuilder, user: Parameters) -> Result<(), Error> {
        let mut job = Job::with_built(&scene, &user, self.most, &Series::default(), &mut self.built)?;
        job.with_layers(&self.layers);
        job.write_options()?;
        self.picture.restart(job);
        (self.scene, self.user) = (scene, user);
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

    /// What was built of the scene, for sessions that share it ([`Session::sharing`]).
    pub fn built(&self) -> &Built {
        &self.built
    }

    /// The trees that were built so far.
    pub fn tree_work(&self) -> TreeWork {
        self.built.tree_work()
    }
}

/// The settings without limits of noise and time.
fn without_limits(mut user: Parameters) -> Parameters {
    user.set("noise", Value::Integer(0));
    user.set("time_limit", Value::Integer(0));
    user
}
