//! One picture that is refined step by step.

use crate::{Error, Job, Outcome};
use bilux_pictures::Picture;
use bilux_transport::{BatchMeans, Progress};
use std::time::{Duration, Instant};

/// A job whose samples are taken step by step. After all steps its picture is that of [`Job::render`], byte for byte;
/// before, it is that of the samples so far.
///
/// What ends a render early, noise and time, ends no step: the caller decides when to stop.
pub struct Progressive {
    pub(crate) job: Job,
    pub(crate) so_far: Option<Outcome>,
    done: u32,
    /// The time that a sample of all pixels took, last time.
    each: Option<Duration>,
}

/// Budget of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Budget {
    /// So many samples of each pixel.
    Samples(u32),
    /// About so long, but at least one sample of each pixel.
    Time(Duration),
}

impl Progressive {
    /// The picture of a job, without any samples so far.
    pub fn new(job: Job) -> Progressive {
        Progressive { job, so_far: None, done: 0, each: None }
    }

    /// Takes more samples, all at once or, if time is limited, in several passes. Returns how many of each pixel there
    /// are now. If `progress` stops it, the pass that it stops is left out.
    ///
    /// # Errors
    /// As for [`Job::render`].
    pub fn step(&mut self, budget: Budget, progress: &dyn Progress) -> Result<u32, Error> {
        let (begun, first) = (Instant::now(), self.done);
        if self.done < self.total() {
            self.job.plan()?;
        }
        loop {
            let taken = self.done - first;
            let wanted = match budget {
                Budget::Samples(samples) => samples.saturating_sub(taken),
                Budget::Time(time) => {
                    self.that_fit(time.saturating_sub(begun.elapsed())).max(u32::from(taken == 0))
                }
            };
            let end = self.batch_end(self.done.saturating_add(wanted).min(self.total()));
            if end == self.done || progress.is_cancelled() {
                return Ok(self.done);
            }
            let pass = Instant::now();
            if self.job.add(self.done..end, &mut self.so_far, progress)?.is_none() {
                return Ok(self.done);
            }
            self.each = Some(pass.elapsed() / (end - self.done));
            self.done = end;
            self.close_batch();
        }
    }

    /// The end of a pass that may go up to `end`: where the variance is estimated, no pass goes on after the end of a batch,
    /// so that its batches are those of [`Job::render`].
    fn batch_end(&self, end: u32) -> u32 {
        if !self.job.render.batch_means {
            return end;
        }
        (self.done + 1..end).find(|&samples| BatchMeans::ends_at(samples)).unwrap_or(end)
    }

    /// Closes a batch if one ends with the samples so far.
    fn close_batch(&mut self) {
        let ends = BatchMeans::ends_at(self.done) || self.is_done();
        if let (true, Some(outcome)) = (self.job.render.batch_means && ends, &mut self.so_far) {
            let rendered = &mut outcome.rendered;
            rendered.batch_means.get_or_insert_default().close(&rendered.film, self.done);
        }
    }

    /// The number of samples that fit into this time; at most as many as there are so far, because later samples may
    /// take longer.
    fn that_fit(&self, time: Duration) -> u32 {
        let Some(each) = self.each else { return 1 };
        let fit = time.as_secs_f64() / each.as_secs_f64().max(1e-9);
        (fit as u32).min(self.done.max(1))
    }

    /// The samples of each pixel so far.
    pub fn samples(&self) -> u32 {
        self.done
    }

    /// The samples of each pixel that there will be.
    pub fn total(&self) -> u32 {
        self.job.samples_per_pixel()
    }

    /// True when all samples were taken.
    pub fn is_done(&self) -> bool {
        self.done >= self.total()
    }

    /// The picture so far, with its film and the layers that the job keeps; `None` before the first step.
    pub fn outcome(&self) -> Option<&Outcome> {
        self.so_far.as_ref()
    }

    /// The picture so far, in linear light; `None` before the first step.
    ///
    /// # Errors
    /// If memory is short.
    pub fn picture(&self) -> Result<Option<Picture>, Error> {
        self.so_far.as_ref().map(Outcome::picture).transpose()
    }

    /// The job.
    pub fn job(&self) -> &Job {
        &self.job
    }

    /// Goes on with another job, from the first sample on.
    pub(crate) fn restart(&mut self, job: Job) {
        (self.job, self.so_far, self.done) = (job, None, 0);
    }
}
