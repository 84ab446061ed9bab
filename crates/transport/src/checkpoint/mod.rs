//! Checkpoints: the state of a render, so that another process can go on from there to the same film, bit for bit.
//!
//! A render stops for a checkpoint between the jobs of its threads: each job, some samples of one tile, is then complete or
//! not begun. So a checkpoint needs the sums of the film, which jobs are complete, and what is kept from one pass to the next:
//! the splats of passes whose light subpaths have not all arrived, what the noise was measured from, batches, replicates. Photons
//! are not kept: they are traced again.

mod bytes;

use crate::film::error::RenderError;
use crate::film::failures::PixelFailures;
use crate::film::interval::Interval;
use crate::film::window::{TILE, Tiling, Window};
use crate::film::{Film, MAX_SAMPLES};
use crate::sampling::splats::Iterations;
use crate::schedule::settings::RenderSettings;
use crate::schedule::{Schedule, ScheduleMemory};
use bilux_accel::Counters;
use std::ops::Range;
use std::time::Duration;

/// Sees a picture while it is rendered.
pub trait Observer: Sync {
    /// True when a checkpoint is due. Asked by every thread between its jobs, so it has to answer at once.
    fn wants_checkpoint(&self) -> bool {
        false
    }

    /// Keeps a checkpoint: one that was due, or the last one of a render that is being cancelled. Nothing is rendered
    /// meanwhile.
    fn keep(&self, _standing: &Standing) {}

    /// True when [`Observer::show`] is to be called soon. Asked as often.
    fn wants_film(&self) -> bool {
        false
    }

    /// Looks at the film so far. Other threads may have to wait meanwhile.
    fn show(&self, _film: &Film) {}
}

/// Sees nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unobserved;

impl Observer for Unobserved {}

/// Sees the film of a render from which no other can go on, and keeps no checkpoint of it.
pub(crate) struct Unkept<'a>(pub(crate) &'a dyn Observer);

impl Observer for Unkept<'_> {
    fn wants_film(&self) -> bool {
        self.0.wants_film()
    }

    fn show(&self, film: &Film) {
        self.0.show(film);
    }
}

/// State of a render, from which a checkpoint is written ([`Standing::write`]).
pub struct Standing<'a> {
    pub(crate) film: &'a Film,
    /// With an interval: the samples before those of the film.
    pub(crate) before: Option<&'a Film>,
    pub(crate) interval: Option<&'a Interval>,
    pub(crate) begun: &'a Begun,
    pub(crate) schedule: &'a Schedule,
    pub(crate) counters: Counters,
    /// The time since the first sample, with that of renders that this one continues.
    pub(crate) rendering: Duration,
}

/// A checkpoint, as it was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    pub(crate) film: Film,
    pub(crate) before: Option<Film>,
    pub(crate) interval: Option<Interval>,
    pub(crate) begun: Begun,
    pub(crate) memory: ScheduleMemory,
    pub(crate) counters: Counters,
    pub(crate) rendering: Duration,
}

/// The samples that are being taken.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Begun {
    /// The tiles.
    pub(crate) tiling: Tiling,
    /// Passes since the last look of the schedule that are complete.
    pub(crate) complete: Vec<Range<u32>>,
    /// The first passes that are not.
    pub(crate) open: Vec<OpenPass>,
    /// Whether the film has the splats of the light subpaths that left this iteration's photons; what failed of them.
    pub(crate) splatted: Option<Vec<(u32, PixelFailures)>>,
}

/// A pass over the film of which some tiles are done.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct OpenPass {
    pub(crate) samples: Range<u32>,
    /// Which tiles are done.
    pub(crate) done: Vec<bool>,
    /// Splats of their light subpaths that the film does not have yet.
    pub(crate) splats: Option<Iterations>,
}

impl Default for Begun {
    fn default() -> Begun {
        Begun { tiling: Tiling::Squares(TILE), complete: Vec::new(), open: Vec::new(), splatted: None }
    }
}

impl Begun {
    /// One after the last sample of these passes.
    pub(crate) fn end(&self) -> Option<u32> {
        let open = self.open.iter().map(|pass| pass.samples.end);
        self.complete.iter().map(|samples| samples.end).chain(open).max()
    }
}

impl Standing<'_> {
    /// Samples per pixel, on average.
    pub fn samples(&self) -> f64 {
        mean_samples(self.film, self.before)
    }

    /// The time that rendering took, with that of renders that this one continues.
    pub fn rendering(&self) -> Duration {
        self.rendering
    }
}

impl Checkpoint {
    /// Samples per pixel, on average.
    pub fn samples(&self) -> f64 {
        mean_samples(&self.film, self.before.as_ref())
    }

    /// The time that rendering took, with that of renders that this one continues.
    pub fn rendering(&self) -> Duration {
        self.rendering
    }

    /// Refuses a checkpoint that does not fit to what is to be rendered: a film of this scale, with these `sampled` pixels.
    pub(crate) fn check(
        &self,
        settings: &RenderSettings,
        scale: i32,
        sampled: Window,
    ) -> Result<(), RenderError> {
        let other = |what: &str| RenderError::OtherCheckpoint { what: what.to_owned() };
        let (window, first) = (settings.window(), settings.samples.start);
        for film in [Some(&self.film), self.before.as_ref()].into_iter().flatten() {
            if (film.width(), film.height()) != (settings.width, settings.height) {
                return Err(other("it has another size"));
            }
            if film.window() != window {
                return Err(other("it has another crop"));
            }
            if film.scale_exponent() != scale {
                return Err(other("its light is of another brightness"));
            }
        }
        if self.interval.is_some() != settings.interval || self.before.is_some() != settings.interval {
            return Err(other("one of them is rendered with intervals (--aov interval), the other is not"));
        }
        let passes = self.begun.open.iter().map(|pass| &pass.samples).chain(&self.begun.complete);
        let mut next = first.saturating_add(self.memory.done);
        let mut passes: Vec<Range<u32>> = passes.cloned().collect();
        passes.sort_by_key(|samples| samples.start);
        // Samples of the schedule's range that were taken before these are complete.
        next = passes.first().map_or(next, |samples| samples.start.max(next));
        for samples in passes {
            if samples.start != next || samples.is_empty() || samples.end > MAX_SAMPLES {
                return Err(other("its passes do not follow each other"));
            }
            next = samples.end;
        }
        if next > settings.samples.end {
            return Err(RenderError::CheckpointBeyond { samples: next - first });
        }
        let (tiles, pixels) = (sampled.divided(self.begun.tiling).len(), window.pixels());
        let fits = |splats: &Iterations| splats.sums.len() == pixels && are_within(&splats.failures, pixels);
        let open_fits = |pass: &OpenPass| pass.done.len() == tiles && pass.splats.as_ref().is_none_or(fits);
        let counts = self.film.counts.iter().chain(&self.film.iterations);
        let are_few = |mut counts: Box<dyn Iterator<Item = &u32> + '_>| counts.all(|&count| count <= next);
        let replicates = self.interval.as_ref().is_none_or(|interval| interval.samples() <= next);
        if !self.begun.open.iter().all(open_fits)
            || !self.begun.splatted.as_ref().is_none_or(|failures| are_within(failures, pixels))
            || !are_few(Box::new(counts))
            || !replicates
        {
            return Err(other("its parts do not fit together"));
        }
        Ok(())
    }
}

fn are_within(failures: &[(u32, PixelFailures)], pixels: usize) -> bool {
    failures.iter().all(|(index, _)| (*index as usize) < pixels)
}

fn mean_samples(film: &Film, before: Option<&Film>) -> f64 {
    let sum = |film: &Film| film.counts.iter().map(|&count| f64::from(count)).sum::<f64>();
    (sum(film) + before.map_or(0.0, sum)) / film.window().pixels().max(1) as f64
}
