//! A view: one thread that owns a session, takes requests, and publishes the newest frame.
//!
//! When the picture changes, small pictures are shown first, by path tracing, each soon after the one before; then a clean
//! one of half the size; and then the picture itself, in full size, by the integrator that was chosen.

mod answers;
mod command;
mod comparing;
mod comparison;
mod denoisers;
mod denoising;
mod json;
mod measure;
mod pace;
mod paths;
mod pick;
mod publisher;
mod questions;
mod refinement;
mod refining;
mod requests;
mod scene;
mod show;
mod state;
mod steps;
mod viewpoint;
mod visits;

use crate::ViewerError;
use crate::common::Common;
use crate::inbox::Inbox;
use crate::open_scene::Version;
use crate::settings::{self, Level};
use bilux::Session;
use bilux::scene::Parameters;
use bilux::transport::aovs::Aov;
use comparison::Comparison;
use denoisers::Denoisers;
pub(crate) use publisher::Outlets;
use publisher::Publisher;
use questions::Questions;
use refinement::Refinement;
use show::Shown;
use std::sync::Arc;
use std::time::Duration;
use viewpoint::Viewpoint;

/// Interval at which the stage looks whether a measurement is over.
const LOOKS: Duration = Duration::from_millis(30);

/// The render of a view.
pub(crate) struct Stage {
    common: Arc<Common>,
    inbox: Arc<Inbox>,
    /// The number of the view among all views.
    number: u64,
    /// The version of the scene that is shown.
    version: Arc<Version>,
    session: Session,
    /// The settings that the user and those who watch ask for.
    user: Parameters,
    viewpoint: Viewpoint,
    refinement: Refinement,
    denoisers: Denoisers,
    /// The picture that this one is compared with.
    comparison: Option<Comparison>,
    questions: Questions,
    shown: Shown,
    /// The layers that the session keeps.
    layers: Vec<Aov>,
    /// Whether it is the turn of other views.
    awaits_turn: bool,
    publisher: Publisher,
}

impl Stage {
    /// A view of the scene that is open.
    ///
    /// # Errors
    /// If the scene cannot be rendered.
    pub(crate) fn new(
        common: Arc<Common>,
        inbox: Arc<Inbox>,
        outlets: Arc<Outlets>,
    ) -> Result<Stage, ViewerError> {
        let closed = || ViewerError::Start("the viewer is closing".to_owned());
        common.open.attach(&inbox);
        let version = common.open.newest().ok_or_else(closed)?;
        let user = common.settings.clone();
        let request = settings::request(&settings::at_time(&user, version.time.as_ref()), common.max_memory);
        let (scene, built) = (version.scene.clone(), version.built.clone());
        let session = Session::sharing(scene, request, built)?;
        let settings = session.job().settings();
        let size = [settings.width, settings.height];
        let mut stage = Stage {
            number: common.room.number(),
            common,
            inbox,
            version,
            user,
            viewpoint: Viewpoint::of_size(size),
            refinement: Refinement::new(),
            denoisers: Denoisers::new(settings.threads)?,
            comparison: None,
            questions: Questions::default(),
            shown: Shown::Picture,
            layers: Vec::new(),
            awaits_turn: false,
            publisher: Publisher::new(outlets),
            session,
        };
        stage.resize(size);
        stage.choose_denoiser()?;
        stage.begin()?;
        stage.publish_state();
        Ok(stage)
    }

    /// Renders until the inbox ends.
    pub(crate) fn run(mut self) {
        loop {
            let waiting = self.inbox.take(self.may_wait());
            if self.inbox.has_ended() {
                return;
            }
            self.serve(waiting);
            let taken = self.take_denoised();
            self.note_problem(taken);
            if !self.may_work() {
                self.publish_progress();
                continue;
            }
            if self.is_turn_of_other() {
                let worked = self.work_on_other();
                self.note_other_problem(worked);
            } else if !self.refinement.rests {
                let worked = self.work();
                self.note_problem(worked);
            }
            self.publish_progress();
            if !self.denoisers.are_at_work() {
                self.common.turns.leave(&self.inbox);
            }
        }
    }

    /// True if it may render now. In full size it has to be its turn.
    fn may_work(&mut self) -> bool {
        let is_needed = self.is_watched() && (!self.refinement.rests || self.is_turn_of_other());
        let measures = self.questions.has_measurement();
        let needs_turn = self.refinement.level == Level::Full || measures;
        if !needs_turn || !is_needed && !self.denoisers.are_at_work() && !measures {
            self.common.turns.leave(&self.inbox);
            self.awaits_turn = false;
            return is_needed;
        }
        self.awaits_turn = !self.common.turns.is_turn_of(&self.inbox);
        // While accelerators are measured, others wait too: the render would slow them.
        !self.awaits_turn && !self.questions.are_measured() && is_needed
    }

    /// Time for which the stage may wait for requests; `None` for as long as there is none.
    fn may_wait(&self) -> Option<Duration> {
        match self.refinement.rests && !self.is_turn_of_other() || !self.is_watched() || self.awaits_turn {
            _ if self.questions.has_measurement() => Some(LOOKS),
            true => None,
            false => Some(Duration::ZERO),
        }
    }

    /// True if anybody sees what is rendered.
    fn is_watched(&self) -> bool {
        self.publisher.is_watched() || self.questions.are_open()
    }

    /// Keeps what went wrong, for the page, and rests.
    fn note_problem(&mut self, result: Result<(), bilux::Error>) {
        if let Err(error) = result {
            self.publisher.problem = Some(error.to_string());
            self.refinement.rests = true;
            self.publish_state();
        }
    }

    /// Keeps why nothing is compared any more, for the page.
    fn note_other_problem(&mut self, result: Result<(), bilux::Error>) {
        if let Err(error) = result {
            self.publisher.problem = Some(format!("cannot compare: {error}"));
            self.publish_state();
        }
    }

    /// The settings that those who watch have asked for, with the camera where they have moved it.
    fn asked(&self) -> Parameters {
        let mut all = settings::at_time(&self.user, self.version.time.as_ref());
        self.viewpoint.place(&mut all);
        all
    }

    /// All settings of a level.
    fn settings_for(&self, level: Level) -> Parameters {
        let mut all = settings::with_defaults(&self.asked());
        settings::set_level(&mut all, &self.session.scene().settings, self.viewpoint.size, level);
        all
    }
}

impl Drop for Stage {
    fn drop(&mut self) {
        // Whatever has ended it: nobody may wait for it.
        self.inbox.end();
        self.common.turns.leave(&self.inbox);
        self.common.room.leave(self.number);
    }
}
