//! Publisher of what those who watch are told: frames, the state of the view, and how far the picture is.

use crate::frame::{Facts, Frame};
use bilux::Error;
use bilux::pictures::{Picture, WriteOptions};
use serde_json::Value;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::sync::watch;

/// Interval at which the progress of the picture is published.
const PROGRESS_EVERY: Duration = Duration::from_millis(250);

/// Channels on which frames and the state of the stage are published: all who watch see the newest of each.
pub(crate) struct Outlets {
    /// The newest frame.
    pub(crate) frames: watch::Sender<Option<Arc<Frame>>>,
    /// The newest frame of the picture that it is compared with.
    pub(crate) other: watch::Sender<Option<Arc<Frame>>>,
    /// The newest state, in JSON.
    pub(crate) state: watch::Sender<Arc<str>>,
    /// The newest progress of the picture, in JSON.
    pub(crate) progress: watch::Sender<Arc<str>>,
}

impl Default for Outlets {
    fn default() -> Outlets {
        let (frames, other) = (watch::Sender::new(None), watch::Sender::new(None));
        let (state, progress) = (watch::Sender::new("".into()), watch::Sender::new("".into()));
        Outlets { frames, other, state, progress }
    }
}

/// Publishes what a view shows.
pub(super) struct Publisher {
    outlets: Arc<Outlets>,
    /// The number of the newest frame.
    frame: u64,
    last_shown: Instant,
    last_progress: Instant,
    /// The problem, if something went wrong, for the page.
    pub(super) problem: Option<String>,
    /// The number of times that requests were served: the state says so, and each time is another state.
    pub(super) served: u64,
}

impl Publisher {
    pub(super) fn new(outlets: Arc<Outlets>) -> Publisher {
        let now = Instant::now();
        Publisher { outlets, frame: 0, last_shown: now, last_progress: now, problem: None, served: 0 }
    }

    /// True if anybody sees the frames.
    pub(super) fn is_watched(&self) -> bool {
        self.outlets.frames.receiver_count() > 0
    }

    /// Requests are served: what went wrong before is over.
    pub(super) fn serve(&mut self) {
        self.problem = None;
        self.served += 1;
    }

    /// Keeps the first problem, for the page.
    pub(super) fn note(&mut self, result: Result<(), String>) {
        if let Err(problem) = result {
            self.problem.get_or_insert(problem);
        }
    }

    /// The next frame, of a picture that refines into one of the size `full`.
    ///
    /// # Errors
    /// If memory is short.
    pub(super) fn frame(
        &mut self,
        picture: &Picture,
        options: &WriteOptions,
        full: [u32; 2],
        facts: &Facts,
    ) -> Result<Arc<Frame>, Error> {
        self.frame += 1;
        Ok(Arc::new(Frame::new(self.frame, picture, options, full, facts)?))
    }

    /// Shows a frame of the picture.
    pub(super) fn show(&mut self, frame: Arc<Frame>) {
        self.outlets.frames.send_replace(Some(frame));
        self.last_shown = Instant::now();
    }

    /// Shows a frame of the picture that it is compared with, or none.
    pub(super) fn show_other(&self, frame: Option<Arc<Frame>>) {
        self.outlets.other.send_replace(frame);
    }

    /// Time since a frame of the picture was shown.
    pub(super) fn since_shown(&self) -> Duration {
        self.last_shown.elapsed()
    }

    /// Publishes the state, unless it is published already: those who wait for an answer must not take an older one for it.
    pub(super) fn state(&self, state: &Value) {
        send_if_new(&self.outlets.state, state);
    }

    /// True if it is time to say again how far the picture is: frames come more rarely.
    pub(super) fn is_progress_due(&self) -> bool {
        self.last_progress.elapsed() >= PROGRESS_EVERY
    }

    /// Says how far the picture is.
    pub(super) fn progress(&mut self, progress: &Value) {
        self.last_progress = Instant::now();
        send_if_new(&self.outlets.progress, progress);
    }
}

fn send_if_new(outlet: &watch::Sender<Arc<str>>, value: &Value) {
    let text = value.to_string();
    outlet.send_if_modified(|last| {
        let is_new = **last != *text;
        *last = text.into();
        is_new
    });
}
