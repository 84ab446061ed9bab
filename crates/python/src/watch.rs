//! Follows work in another thread: shows its progress, and stops it on Ctrl-C or when a callback says so.

use crate::ending::{is_ending, returning_from, without_gil};
use bilux::transport::Progress;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyBool;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Interval at which signals are looked for and callbacks called.
const EVERY: Duration = Duration::from_millis(50);

/// Counts the work that is done, and says whether to stop.
#[derive(Default)]
pub(crate) struct Watch {
    total: AtomicU64,
    samples: AtomicU64,
    rays: AtomicU64,
    cancelled: AtomicBool,
}

impl Progress for Watch {
    fn begin(&self, samples: u64) {
        self.total.store(samples, Ordering::Relaxed);
        self.samples.store(0, Ordering::Relaxed);
    }

    fn advance(&self, samples: u64, rays: u64) {
        self.samples.fetch_add(samples, Ordering::Relaxed);
        self.rays.fetch_add(rays, Ordering::Relaxed);
    }

    fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed) || is_ending()
    }
}

/// Reason for which the work stopped early.
pub(crate) enum Stopped {
    /// Nothing did.
    No,
    /// The callback returned False.
    Asked,
    /// Ctrl-C.
    Interrupted,
    /// A callback or a signal handler raised an exception.
    Raised(PyErr),
}

/// Does the work in a thread of its own, without the GIL, and returns what it returns and what stopped it.
///
/// Every [`EVERY`], signal handlers run, and `callback` is called with the samples that are done, their total, the rays
/// that were traced, and the seconds since the beginning.
pub(crate) fn follow<T: Send>(
    py: Python<'_>,
    callback: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Watch) -> T + Send,
) -> (Option<T>, Stopped) {
    let watch = Watch::default();
    let begun = Instant::now();
    let mut stopped = Stopped::No;
    let result = std::thread::scope(|scope| {
        let (done, mut wait) = channel::<()>();
        let shared = &watch;
        let worker = scope.spawn(move || {
            // Dropped at the end, also if the work panics: that wakes the caller.
            let _done = done;
            work(shared)
        });
        loop {
            let (waited, _returning);
            ((waited, wait), _returning) = returning_from(py, move || (wait.recv_timeout(EVERY), wait));
            let is_done = !matches!(waited, Err(RecvTimeoutError::Timeout));
            if matches!(stopped, Stopped::No) {
                stopped = look(py, callback.filter(|_| !is_done || begun.elapsed() > EVERY), &watch, begun);
                watch.cancelled.store(!matches!(stopped, Stopped::No), Ordering::Relaxed);
            }
            if is_done {
                break;
            }
        }
        without_gil(py, || worker.join()).ok()
    });
    (result, stopped)
}

/// Runs signal handlers and the callback.
fn look(py: Python<'_>, callback: Option<&Bound<'_, PyAny>>, watch: &Watch, begun: Instant) -> Stopped {
    let raised = |error: PyErr| match error.is_instance_of::<PyKeyboardInterrupt>(py) {
        true => Stopped::Interrupted,
        false => Stopped::Raised(error),
    };
    if let Err(error) = py.check_signals() {
        return raised(error);
    }
    let Some(callback) = callback else { return Stopped::No };
    let load = |number: &AtomicU64| number.load(Ordering::Relaxed);
    let (samples, total, rays) = (load(&watch.samples), load(&watch.total), load(&watch.rays));
    match callback.call1((samples.min(total), total, rays, begun.elapsed().as_secs_f64())) {
        Ok(answer) if answer.cast::<PyBool>().is_ok_and(|answer| !answer.is_true()) => Stopped::Asked,
        Ok(_) => Stopped::No,
        Err(error) => raised(error),
    }
}
