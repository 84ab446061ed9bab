//! A view: one thread that owns a session, takes requests, and publishes the newest frame.
//!
//! When the picture changes, small pictures are shown first, by path tracing, each soon after the one before; then a clean
//! one of half the size; and then the picture itself, in full size, by the integrator that was chosen.

mod answers;
mod command;
mod comparing;
mod comparison;
mod denoising;
mod json;
mod measure;
mod pace;
mod paths;
mod pick;
mod refining;
mod requests;
mod scene;
mod show;
mod state;
mod visits;

use crate::ViewerError;
use crate::common::Common;
use crate::eye::Eye;
use crate::frame::{Facts, Frame};
use crate::inbox::Inbox;
use crate::message::Question;
use crate::open_scene::Version;
use crate::settings::{self, Level};
use bilux::Session;
use bilux::pictures::denoise::{DenoiserChoice, Task, denoiser};
use bilux::scene::{Parameters, Value};
use bilux::transport::NoiseMeter;
use bilux::transport::aovs::Aov;
use comparison::Comparison;
use denoising::{Cleaned, Denoising};
use measure::Measurement;
use pace::Pace;
use show::Shown;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::sync::watch;

/// How often it looks whether a measurement is over.
const LOOKS: Duration = Duration::from_millis(30);

/// Where frames and the state of the stage are published: all who watch see the newest of each.
pub(crate) struct Outlets {
    /// The newest frame.
    pub(crate) frames: watch::Sender<Option<Arc<Frame>>>,
    /// The newest frame of the picture that it is compared with.
    pub(crate) other: watch::Sender<Option<Arc<Frame>>>,
    /// The newest state, in JSON.
    pub(crate) state: watch::Sender<Arc<str>>,
    /// How far the picture is, in JSON.
    pub(crate) progress: watch::Sender<Arc<str>>,
}

impl Default for Outlets {
    fn default() -> Outlets {
        let (frames, other) = (watch::Sender::new(None), watch::Sender::new(None));
        let (state, progress) = (watch::Sender::new("".into()), watch::Sender::new("".into()));
        Outlets { frames, other, state, progress }
    }
}

/// The render of a view.
pub(crate) struct Stage {
    common: Arc<Common>,
    /// Its number among all views.
    number: u64,
    /// The version of the scene that is shown.
    version: Arc<Version>,
    session: Session,
    /// The picture that this one is compared with.
    comparison: Option<Comparison>,
    /// Accelerators that are being measured.
    measurement: Option<Measurement>,
    /// The settings that the user and those who watch ask for.
    user: Parameters,
    shown: Shown,
    /// The layers that the session keeps.
    layers: Vec<Aov>,
    denoiser: Option<DenoiserChoice>,
    /// What denoises small previews.
    for_previews: DenoiserChoice,
    /// The picture that is being denoised.
    denoising: Option<Denoising>,
    /// The newest picture that was denoised.
    cleaned: Option<Cleaned>,
    /// Where the scene has its camera.
    home: Option<Eye>,
    /// Where the camera is now.
    eye: Option<Eye>,
    is_moved: bool,
    /// The size that is asked for, and the one that there is room for.
    wanted_size: [u32; 2],
    size: [u32; 2],
    level: Level,
    /// When something last changed, and how many times.
    changed: Instant,
    changes: u64,
    pace: Pace,
    meter: NoiseMeter,
    problem: Option<String>,
    /// How many times requests were served: the state says so, and each time is another state.
    served: u64,
    /// Whether nothing is to be done until something changes.
    rests: bool,
    /// Whether it is the turn of other views.
    awaits_turn: bool,
    facts: Facts,
    frame: u64,
    last_shown: Instant,
    last_progress: Instant,
    /// The samples that the picture in full size has before it takes the place of the clean one of half the size.
    enough: u32,
    /// Whether the picture in full size was shown.
    is_full_shown: bool,
    /// Time that the last change of level took.
    entering: Duration,
    /// Time that the samples of the picture took so far.
    worked: Duration,
    /// What waits for a picture.
    questions: Vec<Question>,
    inbox: Arc<Inbox>,
    outlets: Arc<Outlets>,
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
        let request = settings::request(&settings::at_time(&user, &version), common.max_memory);
        let (scene, built) = (version.scene.clone(), version.built.clone());
        let session = Session::sharing(scene, request, built)?;
        let settings = session.job().settings();
        let size = [settings.width, settings.height];
        let task = Task { threads: settings.threads, ..Task::default() };
        let for_previews = denoiser("builtin", &task).map_err(bilux::Error::from)?;
        let now = Instant::now();
        let mut stage = Stage {
            number: common.room.number(),
            common,
            version,
            home: None,
            eye: None,
            session,
            comparison: None,
            measurement: None,
            user,
            shown: Shown::Picture,
            layers: Vec::new(),
            denoiser: None,
            for_previews,
            denoising: None,
            cleaned: None,
            is_moved: false,
            wanted_size: size,
            size,
            level: Level::Full,
            changed: now,
            changes: 0,
            pace: Pace::new(),
            meter: NoiseMeter::default(),
            problem: None,
            served: 0,
            rests: false,
            awaits_turn: false,
            facts: Facts { side: "own", ..Facts::default() },
            frame: 0,
            last_shown: now,
            last_progress: now,
            enough: 1,
            is_full_shown: false,
            entering: Duration::ZERO,
            worked: Duration::ZERO,
            questions: Vec::new(),
            inbox,
            outlets,
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
            } else if !self.rests {
                let worked = self.work();
                self.note_problem(worked);
            }
            self.publish_progress();
            if self.denoising.is_none() {
                self.common.turns.leave(&self.inbox);
            }
        }
    }

    /// True if it may render now. In full size it has to be its turn.
    fn may_work(&mut self) -> bool {
        let is_needed = self.is_watched() && (!self.rests || self.is_turn_of_other());
        let needs_turn = self.level == Level::Full || self.measurement.is_some();
        if !needs_turn || !is_needed && self.denoising.is_none() && self.measurement.is_none() {
            self.common.turns.leave(&self.inbox);
            self.awaits_turn = false;
            return is_needed;
        }
        self.awaits_turn = !self.common.turns.is_turn_of(&self.inbox);
        // While accelerators are measured, others wait too: the render would slow them.
        !self.awaits_turn && !self.is_measuring() && is_needed
    }

    /// How long it may wait for requests; `None` for as long as there is none.
    fn may_wait(&self) -> Option<Duration> {
        match self.rests && !self.is_turn_of_other() || !self.is_watched() || self.awaits_turn {
            _ if self.measurement.is_some() => Some(LOOKS),
            true => None,
            false => Some(Duration::ZERO),
        }
    }

    /// True while accelerators are measured.
    fn is_measuring(&mut self) -> bool {
        self.measurement = self.measurement.take().filter(Measurement::goes_on);
        self.measurement.is_some()
    }

    /// True if anybody sees what is rendered.
    fn is_watched(&self) -> bool {
        self.outlets.frames.receiver_count() > 0 || !self.questions.is_empty()
    }

    /// Keeps what went wrong, for the page, and rests.
    fn note_problem(&mut self, result: Result<(), bilux::Error>) {
        if let Err(error) = result {
            self.problem = Some(error.to_string());
            self.rests = true;
            self.publish_state();
        }
    }

    /// Keeps why nothing is compared any more, for the page.
    fn note_other_problem(&mut self, result: Result<(), bilux::Error>) {
        if let Err(error) = result {
            self.problem = Some(format!("cannot compare: {error}"));
            self.publish_state();
        }
    }

    /// Publishes the state, unless it is published already: those who wait for an answer must not take an older one for it.
    fn publish_state(&mut self) {
        let state = state::state(self).to_string();
        self.outlets.state.send_if_modified(|last| {
            let is_new = **last != *state;
            *last = state.into();
            is_new
        });
    }

    /// The settings that those who watch have asked for, with the camera where they have moved it.
    fn asked(&self) -> Parameters {
        let mut all = settings::at_time(&self.user, &self.version);
        if let (true, Some(eye)) = (self.is_moved, &self.eye) {
            eye.settings().into_iter().for_each(|(key, value)| match value.parse() {
                Ok(number) if key == "zoom" => all.set(key, Value::Number(number)),
                _ => all.set(key, value),
            });
        }
        all
    }

    /// All settings of a level.
    fn settings_for(&self, level: Level) -> Parameters {
        let mut all = settings::with_defaults(&self.asked());
        settings::set_level(&mut all, &self.session.scene().settings, self.size, level);
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
