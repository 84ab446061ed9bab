//! The limit of time within passes: no job is begun after it, and one that is under way is dropped.

use crate::schedule::progress::Progress;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// A limit of time, as the threads of a render share it.
pub(super) struct Limit {
    at: Instant,
    /// The number of the first jobs that are done whatever time it is.
    least: u64,
    is_late: AtomicBool,
}

impl Limit {
    pub(super) fn new(at: Instant, least: u64) -> Limit {
        Limit { at, least, is_late: AtomicBool::new(false) }
    }

    /// Whether a job was not begun or not completed because of it.
    pub(super) fn is_late(&self) -> bool {
        self.is_late.load(Ordering::Relaxed)
    }

    /// Whether it is too late for a job.
    pub(super) fn is_over_for(&self, job: u64) -> bool {
        let is_over = job >= self.least && (self.is_late() || Instant::now() >= self.at);
        if is_over {
            self.is_late.store(true, Ordering::Relaxed);
        }
        is_over
    }
}

/// Progress of a job that a limit of time ends too.
pub(super) struct Limited<'a> {
    pub(super) progress: &'a dyn Progress,
    pub(super) limit: Option<&'a Limit>,
    pub(super) job: u64,
}

impl Progress for Limited<'_> {
    fn advance(&self, samples: u64, rays: u64) {
        self.progress.advance(samples, rays);
    }

    fn is_cancelled(&self) -> bool {
        self.progress.is_cancelled() || self.limit.is_some_and(|limit| limit.is_over_for(self.job))
    }
}
