//! Refuses to work in a process that was forked from one that already used threads: the threads are not there any
//! more, and waiting for them would never end.

use crate::errors::Error;
use pyo3::PyResult;
use std::sync::atomic::{AtomicU32, Ordering};

/// The process in which threads were used first; 0 before that.
static THREADED: AtomicU32 = AtomicU32::new(0);

/// Call this before any work in threads.
///
/// # Errors
/// If the threads were left behind in another process.
pub(crate) fn check() -> PyResult<()> {
    let here = std::process::id();
    match THREADED.compare_exchange(0, here, Ordering::Relaxed, Ordering::Relaxed) {
        Err(there) if there != here => Err(Error::new_err(
            "this process was forked after Bilux had started its threads, which do not survive that: start processes \
             with multiprocessing.get_context('spawn') or 'forkserver'",
        )),
        _ => Ok(()),
    }
}
