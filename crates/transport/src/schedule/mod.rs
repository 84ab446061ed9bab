//! The order in which the samples of a picture are taken: passes over the whole film, between which it is decided whether
//! there are more.

pub(crate) mod gathering;
pub(crate) mod plan;
pub(crate) mod progress;
pub(crate) mod rendered;
pub(crate) mod settings;
pub(crate) mod stop;

use crate::film::Film;
use crate::film::batch_means::BatchMeans;
use crate::film::bytes::{Rest, put_counts};
use crate::film::error::{FilmError, RenderError};
use crate::schedule::settings::{RenderSettings, Stop};
use crate::schedule::stop::{NoiseMemory, Reached, StopMonitor};
use std::collections::VecDeque;
use std::ops::Range;
use std::time::{Duration, Instant};

/// Decides the passes of a picture, and looks at the film after each of them.
pub(crate) struct Schedule {
    /// Watches what may end the picture early.
    watch: Option<StopMonitor>,
    /// The passes that are left, if nothing ends it early.
    left: VecDeque<Range<u32>>,
    /// The first sample.
    start: u32,
    /// Samples per pixel of the last film that was looked at.
    done: u32,
    batches: Option<BatchMeans>,
}

/// State that a schedule keeps of the films that it has looked at.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ScheduleMemory {
    /// Samples per pixel of the last of them.
    pub(crate) done: u32,
    /// Measured noise, where noise or time may end the picture.
    pub(crate) noise: Option<NoiseMemory>,
    /// Batches, where the variance is estimated.
    pub(crate) batches: Option<BatchMeans>,
}

impl Schedule {
    /// `spent` is the time that passed before the first sample.
    pub(crate) fn new(settings: &RenderSettings, spent: Duration) -> Schedule {
        let is_watched = settings.stop.is_any();
        Schedule {
            watch: is_watched.then(|| StopMonitor::new(settings, spent)),
            left: if is_watched { VecDeque::new() } else { batches(settings).into() },
            start: settings.samples.start,
            done: 0,
            batches: settings.batch_means.then(BatchMeans::default),
        }
    }

    /// Goes on where another schedule was, whose samples took so long.
    ///
    /// # Errors
    /// When the other one did not remember what these settings ask for.
    pub(crate) fn going_on(
        settings: &RenderSettings,
        spent: Duration,
        memory: ScheduleMemory,
        earlier: Duration,
    ) -> Result<Schedule, RenderError> {
        let mut schedule = Schedule::new(settings, spent);
        let ScheduleMemory { done, noise, batches } = memory;
        // After the first sample there is something to remember.
        let knows_noise = noise.as_ref().is_some_and(|noise| done == 0 || noise.meter.has_looked());
        if settings.stop.noise.is_some() && !knows_noise {
            return Err(RenderError::CheckpointLacks {
                what: "the noise so far, which a limit of noise needs",
            });
        }
        if settings.batch_means && batches.is_none() {
            return Err(RenderError::CheckpointLacks {
                what: "the variance of pixels, which denoising and the layer 'variance' need",
            });
        }
        if let Some(watch) = &mut schedule.watch {
            watch.go_on(done, earlier, noise.unwrap_or_default());
        }
        let next = schedule.start.saturating_add(done);
        schedule.left.retain(|samples| samples.end > next);
        if let Some(first) = schedule.left.front_mut() {
            first.start = first.start.max(next);
        }
        schedule.batches = batches.filter(|_| settings.batch_means);
        schedule.done = done;
        Ok(schedule)
    }

    /// Appends what it remembers.
    pub(crate) fn put(&self, bytes: &mut Vec<u8>) {
        let has = [self.watch.is_some(), self.batches.is_some()].map(u32::from);
        put_counts(bytes, &[self.done, has[0], has[1]]);
        if let Some(watch) = &self.watch {
            watch.put_memory(bytes);
        }
        if let Some(batches) = &self.batches {
            batches.put(bytes);
        }
    }

    /// Schedule of the same passes, none of which is shortened or left out because of the time or, if it does not `measure`, because
    /// of the noise.
    pub(crate) fn without_clock(settings: &RenderSettings, measures: bool) -> Schedule {
        let noise = settings.stop.noise.filter(|_| measures);
        let unlimited = RenderSettings { stop: Stop { noise, time_limit: None }, ..settings.clone() };
        let watch = settings.stop.is_any().then(|| StopMonitor::new(&unlimited, Duration::ZERO));
        Schedule { watch, ..Schedule::new(settings, Duration::ZERO) }
    }

    /// Assumes that these samples were taken, without a film.
    pub(crate) fn assume(&mut self, samples: &Range<u32>) {
        if let Some(watch) = &mut self.watch {
            watch.done += samples.len() as u32;
        }
    }

    /// True if the picture is a single pass.
    pub(crate) fn is_single_pass(&self) -> bool {
        self.watch.is_none() && self.batches.is_none()
    }

    /// The next samples to take; `None` when the picture is done.
    pub(crate) fn next(&mut self) -> Option<Range<u32>> {
        match &mut self.watch {
            Some(watch) => watch.next(),
            None => self.left.pop_front(),
        }
    }

    /// The next samples to take, if samples up to `begun` are begun already: then these have to be completed, whatever time it is.
    ///
    /// # Errors
    /// When they are more than the picture takes.
    pub(crate) fn next_from(&mut self, begun: Option<u32>) -> Result<Option<Range<u32>>, RenderError> {
        let next = self.next();
        let Some(end) = begun else { return Ok(next) };
        let has_clock = self.watch.as_ref().is_some_and(StopMonitor::has_clock);
        match next {
            Some(samples) if samples.end >= end => Ok(Some(samples)),
            _ if has_clock => Ok(Some(self.start + self.done..end)),
            _ => Err(RenderError::CheckpointBeyond { samples: end - self.start }),
        }
    }

    /// Looks at the film after these samples.
    pub(crate) fn look(&mut self, film: &Film, samples: &Range<u32>) {
        let done = samples.end - self.start;
        self.done = done;
        if let Some(watch) = &mut self.watch {
            watch.look(film, samples);
        }
        let is_end = self.watch.is_none() || BatchMeans::ends_at(done);
        if let Some(batches) = self.batches.as_mut().filter(|_| is_end) {
            batches.close(film, done);
        }
    }

    /// When time ends the picture.
    pub(crate) fn deadline(&self) -> Option<Instant> {
        self.watch.as_ref().and_then(StopMonitor::deadline)
    }

    /// Notes that time ended the picture within a pass.
    pub(crate) fn cut_short(&mut self) {
        self.watch.iter_mut().for_each(StopMonitor::cut_short);
    }

    /// The probable number of samples per pixel, if it is not certain.
    pub(crate) fn expected(&self) -> Option<u32> {
        self.watch.as_ref().map(StopMonitor::expected)
    }

    /// State that the picture has reached, and its batches. `film` is the film, if all passes are complete.
    pub(crate) fn end(self, film: Option<&Film>) -> (Option<Reached>, Option<BatchMeans>) {
        let Schedule { watch, mut batches, .. } = self;
        if let Some(batches) = &mut batches {
            if let (Some(watch), Some(film)) = (&watch, film) {
                batches.close(film, watch.done);
            }
            batches.finish();
        }
        (watch.and_then(|watch| watch.reached), batches)
    }
}

impl ScheduleMemory {
    /// Reads what the schedule of a film with so many pixels remembered.
    pub(crate) fn read(rest: &mut Rest, pixels: usize) -> Result<ScheduleMemory, FilmError> {
        let [done, has_noise, has_batches] = rest.numbers()?;
        let noise = (has_noise == 1).then(|| NoiseMemory::read(rest, pixels)).transpose()?;
        let batches = (has_batches == 1).then(|| BatchMeans::read(rest, pixels)).transpose()?;
        Ok(ScheduleMemory { done, noise, batches })
    }
}

/// The samples to be taken, cut into batches where their variance is to be estimated.
fn batches(settings: &RenderSettings) -> Vec<Range<u32>> {
    let Range { start, end } = settings.samples;
    if !settings.batch_means {
        return std::iter::once(start..end).collect();
    }
    let ends = (start + 1..end).filter(|&sample| BatchMeans::ends_at(sample - start)).chain([end]);
    ends.scan(start, |first, end| Some(std::mem::replace(first, end)..end)).collect()
}
