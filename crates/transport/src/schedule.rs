//! The order in which the samples of a picture are taken: passes over the whole film, between which it is decided whether
//! there are more.

use crate::batch_means::BatchMeans;
use crate::film::Film;
use crate::settings::{RenderSettings, Stop};
use crate::stop::{Reached, StopMonitor};
use std::collections::VecDeque;
use std::ops::Range;
use std::time::Duration;

/// Decides the passes of a picture, and looks at the film after each of them.
pub(crate) struct Schedule {
    /// Watches what may end the picture early.
    watch: Option<StopMonitor>,
    /// The passes that are left, if nothing ends it early.
    left: VecDeque<Range<u32>>,
    /// The first sample.
    start: u32,
    batches: Option<BatchMeans>,
}

impl Schedule {
    /// `spent` is the time that passed before the first sample.
    pub(crate) fn new(settings: &RenderSettings, spent: Duration) -> Schedule {
        let is_watched = settings.stop.is_any();
        Schedule {
            watch: is_watched.then(|| StopMonitor::new(settings, spent)),
            left: if is_watched { VecDeque::new() } else { batches(settings).into() },
            start: settings.samples.start,
            batches: settings.batch_means.then(BatchMeans::default),
        }
    }

    /// The same passes, none of which is shortened or left out because of the time or, if it does not `measure`, because
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

    /// Looks at the film after these samples.
    pub(crate) fn look(&mut self, film: &Film, samples: &Range<u32>) {
        let done = samples.end - self.start;
        if let Some(watch) = &mut self.watch {
            watch.look(film, samples);
        }
        let is_end = self.watch.is_none() || BatchMeans::ends_at(done);
        if let Some(batches) = self.batches.as_mut().filter(|_| is_end) {
            batches.close(film, done);
        }
    }

    /// The probable number of samples per pixel, if it is not certain.
    pub(crate) fn expected(&self) -> Option<u32> {
        self.watch.as_ref().map(StopMonitor::expected)
    }

    /// How far the picture got, and its batches. `film` is the film, if all passes are complete.
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

/// The samples to be taken, cut into batches where their variance is to be estimated.
fn batches(settings: &RenderSettings) -> Vec<Range<u32>> {
    let Range { start, end } = settings.samples;
    if !settings.batch_means {
        return std::iter::once(start..end).collect();
    }
    let ends = (start + 1..end).filter(|&sample| BatchMeans::ends_at(sample - start)).chain([end]);
    ends.scan(start, |first, end| Some(std::mem::replace(first, end)..end)).collect()
}
