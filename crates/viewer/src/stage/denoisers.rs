//! Work of denoisers, on threads of their own.

use crate::frame::Facts;
use crate::inbox::Inbox;
use bilux::pictures::Picture;
use bilux::pictures::denoise::{DenoiserChoice, Task, denoiser};
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
    /// The time that denoising took.
    pub(super) time: Duration,
}

/// A picture that is being denoised, on a thread of its own.
pub(super) struct Denoising {
    pub(super) result: Receiver<Result<Picture, Error>>,
    /// The facts of the picture when denoising began.
    pub(super) facts: Facts,
    /// The number of changes by then.
    pub(super) changes: u64,
    pub(super) by: &'static str,
    pub(super) begun: Instant,
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
    pub(super) fn begin(
        outcome: &Outcome,
        by: &'static str,
        task: Task,
        facts: Facts,
        changes: u64,
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

/// Denoisers of the pictures of a view.
pub(super) struct Denoisers {
    /// The denoiser that the settings ask for.
    pub(super) chosen: Option<DenoiserChoice>,
    /// The denoiser of small previews.
    pub(super) for_previews: DenoiserChoice,
    /// The picture that is being denoised.
    pub(super) work: Option<Denoising>,
    /// The newest picture that was denoised.
    pub(super) cleaned: Option<Cleaned>,
}

impl Denoisers {
    /// Denoises previews on this number of threads, and nothing else so far.
    ///
    /// # Errors
    /// If the built-in denoiser fails.
    pub(super) fn new(threads: usize) -> Result<Denoisers, Error> {
        let for_previews = denoiser("builtin", &Task { threads, ..Task::default() })?;
        Ok(Denoisers { chosen: None, for_previews, work: None, cleaned: None })
    }

    /// True while a picture is being denoised.
    pub(super) fn are_at_work(&self) -> bool {
        self.work.is_some()
    }

    /// The name of the one that was chosen.
    pub(super) fn name(&self) -> Option<&'static str> {
        self.chosen.as_ref().map(|chosen| chosen.name)
    }

    /// The time that denoising took last.
    pub(super) fn time(&self) -> Option<Duration> {
        self.cleaned.as_ref().map(|it| it.time)
    }

    /// The samples of the picture with these facts that was denoised last by what is chosen now, if any was.
    pub(super) fn cleaned_samples(&self, facts: &Facts) -> Option<u32> {
        let is_same = |it: &&Cleaned| (it.picture, Some(it.by)) == (facts.picture, self.name());
        self.cleaned.as_ref().filter(is_same).map(|it| it.samples)
    }

    /// Takes the denoised picture, or what went wrong, if that is done.
    pub(super) fn take(&mut self) -> Option<(Denoising, Result<Picture, Error>)> {
        let received = self.work.as_ref()?.result.try_recv();
        if matches!(received, Err(TryRecvError::Empty)) {
            return None;
        }
        let failed = |_| Err(Error::Settings("the denoiser has failed: please report this".to_owned()));
        Some((self.work.take()?, received.unwrap_or_else(failed)))
    }
}
