//! Writes checkpoints of a render from time to time.

use super::file::{Head, SavedRender, part_path, write};
use super::identity::Identity;
use crate::Job;
use crate::error::CheckpointError;
use bilux_transport::{Observer, Standing};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// A checkpoint may take this share of the time: the next one comes at least so many times later as the last one took.
const SHARE: u32 = 10;

/// Writes checkpoints of a job to a file while it is rendered, and a last one when it is stopped.
pub struct CheckpointWriter<'a> {
    job: &'a Job,
    path: PathBuf,
    every: Option<Duration>,
    identity: OnceLock<Identity>,
    begun: Instant,
    /// The time that was spent before.
    earlier: Duration,
    /// When the next one is due, in nanoseconds since the beginning.
    due: AtomicU64,
    state: Mutex<State>,
    on_failure: Box<dyn Fn(&CheckpointError) + Sync + 'a>,
}

#[derive(Default)]
struct State {
    /// Samples per pixel of the checkpoint that is there.
    samples: Option<f64>,
    /// Whether the last attempt failed: it is reported once.
    has_failed: bool,
}

impl<'a> CheckpointWriter<'a> {
    /// Writes checkpoints of a job to a file, one each time that `every` has passed; `None` writes one only when the render is
    /// stopped.
    pub fn new(job: &'a Job, path: &Path, every: Option<Duration>) -> CheckpointWriter<'a> {
        // What a process has left that was killed while it wrote; mostly there is none.
        let _ = std::fs::remove_file(part_path(path));
        CheckpointWriter {
            job,
            path: path.to_owned(),
            every,
            identity: OnceLock::new(),
            begun: job.request.begun.unwrap_or_else(Instant::now),
            earlier: Duration::ZERO,
            due: AtomicU64::new(after(Duration::ZERO, every.unwrap_or(Duration::MAX))),
            state: Mutex::default(),
            on_failure: Box::new(|_| ()),
        }
    }

    /// Goes on with a render that was saved: its time counts.
    #[must_use]
    pub fn continuing(mut self, saved: &SavedRender) -> CheckpointWriter<'a> {
        self.earlier = saved.head.spent;
        self
    }

    /// Keeps the checkpoint that is there until the render has more samples than that.
    #[must_use]
    pub fn keeping_until(mut self, samples: f64) -> CheckpointWriter<'a> {
        self.state = Mutex::new(State { samples: Some(samples), has_failed: false });
        self
    }

    /// Calls this function when a checkpoint cannot be written: the old one is still there, and the render goes on.
    #[must_use]
    pub fn on_failure(mut self, report: impl Fn(&CheckpointError) + Sync + 'a) -> CheckpointWriter<'a> {
        self.on_failure = Box::new(report);
        self
    }

    /// Samples per pixel of the checkpoint that is in the file, if this render or the one that it continues wrote it.
    pub fn samples(&self) -> Option<f64> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner).samples
    }
}

impl Observer for CheckpointWriter<'_> {
    fn wants_checkpoint(&self) -> bool {
        self.begun.elapsed().as_nanos() >= u128::from(self.due.load(Ordering::Relaxed))
    }

    fn keep(&self, standing: &Standing) {
        let begun = Instant::now();
        let samples = standing.samples();
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        if samples > state.samples.unwrap_or(0.0) {
            let identity = self.identity.get_or_init(|| Identity::of(self.job)).clone();
            let head = Head { identity, samples, spent: self.earlier + self.begun.elapsed() };
            match write(&self.path, &head, |out| standing.write(out)) {
                Ok(()) => *state = State { samples: Some(samples), has_failed: false },
                Err(error) => {
                    if !std::mem::replace(&mut state.has_failed, true) {
                        (self.on_failure)(&error);
                    }
                }
            }
        }
        let wait = self.every.unwrap_or(Duration::MAX).max(begun.elapsed() * SHARE);
        self.due.store(after(self.begun.elapsed(), wait), Ordering::Relaxed);
    }
}

/// Nanoseconds up to a time that comes `wait` after another.
fn after(time: Duration, wait: Duration) -> u64 {
    u64::try_from(time.saturating_add(wait).as_nanos()).unwrap_or(u64::MAX)
}
