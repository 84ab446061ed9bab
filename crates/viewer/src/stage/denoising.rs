//! Denoising beside the render: it takes long for a large picture, and nobody who moves the camera may wait for it.

use super::Stage;
use super::refinement::Refinement;
use crate::frame::Facts;
use crate::inbox::Inbox;
use crate::settings::{Level, denoiser_of};
use bilux::pictures::Picture;
use bilux::pictures::denoise::{DenoiserChoice, Task, denoiser};
use bilux::{Error, Outcome, Settings};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

/// A picture that was denoised.
struct Cleaned {
    /// The picture that it is of, and how many samples that had.
    picture: u64,
    samples: u32,
    /// The denoiser.
    by: &'static str,
    result: Picture,
    /// How long it took.
    time: Duration,
}

/// A picture that is being denoised, on a thread of its own.
struct Denoising {
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

/// What denoises the pictures of a view.
pub(super) struct Denoisers {
    /// What the settings ask for.
    pub(super) chosen: Option<DenoiserChoice>,
    /// What denoises small previews.
    pub(super) for_previews: DenoiserChoice,
    /// The picture that is being denoised.
    work: Option<Denoising>,
    /// The newest picture that was denoised.
    cleaned: Option<Cleaned>,
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
    fn name(&self) -> Option<&'static str> {
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

    /// What was denoised, if that is done.
    fn take(&mut self) -> Option<(Denoising, Result<Picture, Error>)> {
        let received = self.work.as_ref()?.result.try_recv();
        if matches!(received, Err(TryRecvError::Empty)) {
            return None;
        }
        let failed = |_| Err(Error::Settings("the denoiser has failed: please report this".to_owned()));
        Some((self.work.take()?, received.unwrap_or_else(failed)))
    }
}

impl Stage {
    /// Looks for the denoiser that the settings ask for.
    pub(super) fn choose_denoiser(&mut self) -> Result<(), Error> {
        let settings = self.session.job().settings();
        self.denoisers.chosen = self.denoiser_for(settings, self.comparison.is_some())?;
        self.choose_layers()
    }

    /// The denoiser that settings ask for. Two pictures that are compared are not denoised unless that is asked for: what
    /// people want to see is their noise.
    pub(super) fn denoiser_for(
        &self,
        settings: &Settings,
        is_compared: bool,
    ) -> Result<Option<DenoiserChoice>, Error> {
        let is_open = settings.denoise == "display" && is_compared;
        let name = denoiser_of(settings).filter(|_| !is_open);
        Ok(name.map(|name| denoiser(name, &self.task())).transpose()?)
    }

    /// Begins to denoise the picture as it is, unless an earlier one still is; it is shown when that is done. One is denoised
    /// at a time, even if it is not wanted any more: where denoising takes long, many together would take longer.
    pub(super) fn begin_denoising(&mut self, facts: Facts) -> Result<(), Error> {
        let Some(outcome) = self.session.outcome().filter(|_| !self.denoisers.are_at_work()) else {
            return Ok(());
        };
        let by = self.denoisers.name().unwrap_or(self.denoisers.for_previews.name);
        let (inbox, about) = (self.inbox.clone(), (facts, self.refinement.changes));
        self.denoisers.work = Some(Denoising::begin(outcome, (by, self.task()), about, inbox)?);
        Ok(())
    }

    /// What a denoiser has to know.
    fn task(&self) -> Task {
        let threads = self.session.job().settings().threads;
        Task { threads, sandboxed: self.common.sandboxed, ..Task::default() }
    }

    /// Shows the picture that was being denoised, if that is done, and the picture is still wanted.
    pub(super) fn take_denoised(&mut self) -> Result<(), Error> {
        let Some((it, result)) = self.denoisers.take() else { return Ok(()) };
        let result = result?;
        if !self.denoises() {
            return Ok(());
        }
        let (picture, samples) = (it.facts.picture, it.facts.samples);
        let is_wanted = it.changes == self.refinement.changes;
        if is_wanted {
            let time = it.begun.elapsed();
            self.denoisers.cleaned = Some(Cleaned { picture, samples, by: it.by, result, time });
            self.show_cleaned(&it.facts)?;
        }
        // The last samples may have been taken meanwhile, or another denoiser chosen, or another picture begun.
        let Refinement { facts, rests, level, .. } = &self.refinement;
        let now = (facts.picture, self.session.samples(), self.denoisers.name());
        let is_last = is_wanted && (picture, samples, Some(it.by)) == now;
        if *rests && *level == Level::Full && !is_last { self.publish() } else { Ok(()) }
    }

    /// Shows the newest picture that was denoised.
    pub(super) fn show_cleaned(&mut self, facts: &Facts) -> Result<(), Error> {
        let Some(cleaned) = &self.denoisers.cleaned else { return Ok(()) };
        let options = self.session.job().write_options_for(&cleaned.result)?;
        let (picture, facts) = (cleaned.result.clone(), facts.clone());
        self.send(&picture, &options, facts)
    }
}
