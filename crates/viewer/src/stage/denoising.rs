//! Denoising beside the render: it takes long for a large picture, and nobody who moves the camera may wait for it.

use super::Stage;
use crate::frame::Facts;
use crate::inbox::Inbox;
use crate::settings::Level;
use bilux::pictures::Picture;
use bilux::pictures::denoise::{Task, denoiser};
use bilux::{Error, Outcome};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

/// A picture that was denoised.
pub(super) struct Cleaned {
    /// The picture that it is of, and how many samples that had.
    pub(super) picture: u64,
    pub(super) samples: u32,
    /// The denoiser.
    pub(super) by: &'static str,
    pub(super) result: Picture,
    /// How long it took.
    pub(super) time: Duration,
}

/// A picture that is being denoised, on a thread of its own.
pub(super) struct Denoising {
    result: Receiver<Result<Picture, Error>>,
    /// What was known of the picture when it began.
    facts: Facts,
    /// What had changed by then.
    changes: u64,
    by: &'static str,
    begun: Instant,
}

/// Rings when the work ends, in whatever way, and after its result was sent.
struct Bell(Arc<Inbox>);

impl Drop for Bell {
    fn drop(&mut self) {
        self.0.ring();
    }
}

impl Denoising {
    /// Begins; in the end the inbox rings.
    fn begin(
        outcome: &Outcome,
        (by, task): (&'static str, Task),
        (facts, changes): (Facts, u64),
        inbox: Arc<Inbox>,
    ) -> Result<Denoising, Error> {
        let outcome = outcome.clone();
        let (to, result) = channel();
        let bell = Bell(inbox);
        let work = move || {
            let (_bell, to) = (bell, to);
            // Denoisers stay on the thread where they were made.
            let cleaned = denoiser(by, &task).map_err(Error::from).and_then(|it| outcome.denoised(&it));
            // Nobody may want it any more.
            let _ = to.send(cleaned);
        };
        let thread = std::thread::Builder::new().name("denoise".to_owned()).spawn(work);
        let failed =
            |error: std::io::Error| Error::Settings(format!("there is no thread to denoise: {error}"));
        thread.map_err(failed)?;
        Ok(Denoising { result, facts, changes, by, begun: Instant::now() })
    }
}

impl Stage {
    /// Begins to denoise the picture as it is, unless an earlier one still is; it is shown when that is done. One is denoised
    /// at a time, even if it is not wanted any more: where denoising takes long, many together would take longer.
    pub(super) fn begin_denoising(&mut self, facts: Facts) -> Result<(), Error> {
        let Some(outcome) = self.session.outcome().filter(|_| self.denoising.is_none()) else {
            return Ok(());
        };
        let by = self.denoiser.as_ref().map_or(self.for_previews.name, |chosen| chosen.name);
        let (inbox, about) = (self.inbox.clone(), (facts, self.changes));
        self.denoising = Some(Denoising::begin(outcome, (by, self.task()), about, inbox)?);
        Ok(())
    }

    /// What a denoiser has to know.
    pub(super) fn task(&self) -> Task {
        let threads = self.session.job().settings().threads;
        Task { threads, sandboxed: self.common.sandboxed, ..Task::default() }
    }

    /// Shows the picture that was being denoised, if that is done, and the picture is still wanted.
    pub(super) fn take_denoised(&mut self) -> Result<(), Error> {
        let received = self.denoising.as_ref().map(|it| it.result.try_recv());
        let Some(received) = received.filter(|it| !matches!(it, Err(TryRecvError::Empty))) else {
            return Ok(());
        };
        let Some(it) = self.denoising.take() else { return Ok(()) };
        let failed = |_| Err(Error::Settings("the denoiser has failed: please report this".to_owned()));
        let result = received.unwrap_or_else(failed)?;
        if !self.denoises() {
            return Ok(());
        }
        let (picture, samples) = (it.facts.picture, it.facts.samples);
        let is_wanted = it.changes == self.changes;
        if is_wanted {
            let time = it.begun.elapsed();
            self.cleaned = Some(Cleaned { picture, samples, by: it.by, result, time });
            self.show_cleaned(&it.facts)?;
        }
        // The last samples may have been taken meanwhile, or another denoiser chosen, or another picture begun.
        let by = self.denoiser.as_ref().map(|chosen| chosen.name);
        let now = (self.facts.picture, self.session.samples(), by);
        let is_last = is_wanted && (picture, samples, Some(it.by)) == now;
        if self.rests && self.level == Level::Full && !is_last { self.publish() } else { Ok(()) }
    }

    /// Shows the newest picture that was denoised.
    pub(super) fn show_cleaned(&mut self, facts: &Facts) -> Result<(), Error> {
        let Some(cleaned) = &self.cleaned else { return Ok(()) };
        let options = self.session.job().write_options_for(&cleaned.result)?;
        let (picture, facts) = (cleaned.result.clone(), facts.clone());
        self.send(&picture, &options, facts)
    }
}
