//! The render: one thread that owns the session, takes requests, and publishes the newest frame.
//!
//! When the picture changes, small pictures are shown first, by path tracing, each soon after the one before; then larger
//! ones; and when nothing has changed for a moment, the picture itself, in full size, by the integrator that was chosen.

mod answers;
mod command;
mod comparing;
mod comparison;
mod edits;
mod json;
mod measure;
mod opening;
mod pace;
mod paths;
mod pick;
mod refining;
mod requests;
mod settings;
mod show;
mod state;
mod visits;

use crate::ViewerError;
use crate::dropped::Kept;
use crate::eye::Eye;
use crate::frame::{Facts, Frame};
use crate::inbox::Inbox;
use crate::message::Question;
use crate::options::{Opening, Options};
use bilux::Session;
use bilux::pictures::denoise::{DenoiserChoice, Task, denoiser};
use bilux::scene::{Parameters, SceneBuilder, Value};
use bilux::transport::NoiseMeter;
use bilux::transport::aovs::Aov;
use bilux::watch::Watched;
use comparison::Comparison;
use edits::Edits;
use measure::Measurement;
use pace::Pace;
use show::Shown;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::sync::watch;

/// The place of the scene's file in [`Options::command`].
const SCENE: usize = 2;

/// How often it looks whether a measurement is over.
const LOOKS: Duration = Duration::from_millis(30);

/// The maximum number of samples of each pixel, if neither the user nor the scene says it.
const SAMPLES: i64 = 1024;

/// Where frames and the state of the stage are published: all who watch see the newest of each.
pub(crate) struct Outlets {
    /// The newest frame.
    pub(crate) frames: watch::Sender<Option<Arc<Frame>>>,
    /// The newest frame of the picture that it is compared with.
    pub(crate) other: watch::Sender<Option<Arc<Frame>>>,
    /// The newest state, in JSON.
    pub(crate) state: watch::Sender<Arc<str>>,
}

impl Default for Outlets {
    fn default() -> Outlets {
        let (frames, other) = (watch::Sender::new(None), watch::Sender::new(None));
        Outlets { frames, other, state: watch::Sender::new("".into()) }
    }
}

/// What is being rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Level {
    /// A picture whose sides are divided by this.
    Preview(u32),
    /// The picture itself.
    Full,
}

/// The render.
pub(crate) struct Stage {
    options: Options,
    session: Session,
    /// The scene as it was opened.
    unedited: SceneBuilder,
    /// What was opened, and how.
    opening: Opening,
    /// The time in seconds that the scene was opened at.
    first_time: f32,
    /// The file that was dropped in, while it is shown.
    kept: Option<Kept>,
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
    /// Where the scene has its camera.
    home: Option<Eye>,
    /// Where the camera is now.
    eye: Option<Eye>,
    is_moved: bool,
    size: [u32; 2],
    level: Level,
    /// When something last changed.
    changed: Instant,
    pace: Pace,
    meter: NoiseMeter,
    edits: Edits,
    problem: Option<String>,
    /// How many times requests were served: the state says so, and each time is another state.
    served: u64,
    /// Whether nothing is to be done until something changes.
    rests: bool,
    facts: Facts,
    frame: u64,
    last_shown: Instant,
    /// Time that the last change of level took.
    entering: Duration,
    /// Time that the samples of the picture took so far.
    worked: Duration,
    /// What waits for a picture.
    questions: Vec<Question>,
    inbox: Arc<Inbox>,
    outlets: Arc<Outlets>,
    watched: Arc<Watched>,
}

impl Stage {
    /// A stage with the scene that the options open.
    ///
    /// # Errors
    /// If the scene cannot be opened or rendered.
    pub(crate) fn new(
        options: Options,
        inbox: Arc<Inbox>,
        outlets: Arc<Outlets>,
        watched: Arc<Watched>,
    ) -> Result<Stage, ViewerError> {
        let scene = (options.open)(&Opening::default()).map_err(ViewerError::Open)?;
        watched.add(&scene.files);
        let (user, unedited) = (options.settings.clone(), scene.clone());
        let session = Session::within(scene, &settings::with_defaults(&user), options.max_memory)?;
        let settings = session.job().settings();
        let (size, first_time) = ([settings.width, settings.height], settings.time);
        let task = Task { threads: settings.threads, ..Task::default() };
        let for_previews = denoiser("builtin", &task).map_err(bilux::Error::from)?;
        let (now, home) = (Instant::now(), Eye::of(session.job()));
        let mut stage = Stage {
            home,
            eye: home,
            options,
            session,
            unedited,
            opening: Opening::default(),
            first_time,
            kept: None,
            comparison: None,
            measurement: None,
            user,
            shown: Shown::Picture,
            layers: Vec::new(),
            denoiser: None,
            for_previews,
            is_moved: false,
            size,
            level: Level::Full,
            changed: now,
            pace: Pace::new(),
            meter: NoiseMeter::default(),
            edits: Edits::default(),
            problem: None,
            served: 0,
            rests: false,
            facts: Facts { side: "own", ..Facts::default() },
            frame: 0,
            last_shown: now,
            entering: Duration::ZERO,
            worked: Duration::ZERO,
            questions: Vec::new(),
            inbox,
            outlets,
            watched,
        };
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
            if self.is_measuring() || !self.is_watched() {
                continue;
            }
            if self.is_turn_of_other() {
                let worked = self.work_on_other();
                self.note_other_problem(worked);
            } else if !self.rests {
                let worked = self.work();
                self.note_problem(worked);
            }
        }
    }

    /// How long it may wait for requests; `None` for as long as there is none.
    fn may_wait(&self) -> Option<Duration> {
        match self.rests && !self.is_turn_of_other() || !self.is_watched() {
            _ if self.measurement.is_some() => Some(LOOKS),
            true => None,
            false => Some(Duration::ZERO),
        }
    }

    /// True while accelerators are measured: the render would slow them.
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
        let mut all = self.user.clone();
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
