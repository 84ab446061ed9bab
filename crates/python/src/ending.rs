//! The end of the interpreter. A thread that works without the GIL by then must not come back: Python would end it inside
//! our frames, which aborts the process. So when the interpreter is about to end, such threads stay where they are.

use pyo3::prelude::*;
use std::cell::Cell;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Time that the interpreter waits for the callbacks of threads that it will end.
const PATIENCE: Duration = Duration::from_secs(2);

/// Whether the interpreter is about to end.
static ENDING: AtomicBool = AtomicBool::new(false);

/// The number of threads that are on the way back to Python, or in a callback of a render.
static RETURNING: AtomicUsize = AtomicUsize::new(0);

thread_local! {
    /// Whether this is the thread that ends the interpreter. What it does after that is as safe as ever.
    static IS_LAST: Cell<bool> = const { Cell::new(false) };
}

/// While there is one, the interpreter does not end, except after [`PATIENCE`].
pub(crate) struct Returning(());

impl Returning {
    /// Waits for ever if the interpreter is about to end.
    fn new() -> Returning {
        RETURNING.fetch_add(1, Ordering::SeqCst);
        let returning = Returning(());
        if is_ending() {
            drop(returning);
            loop {
                std::thread::park();
            }
        }
        returning
    }
}

impl Drop for Returning {
    fn drop(&mut self) {
        RETURNING.fetch_sub(1, Ordering::SeqCst);
    }
}

/// Whether the interpreter is about to end, so that nobody will see what this thread finds.
pub(crate) fn is_ending() -> bool {
    ENDING.load(Ordering::SeqCst) && !IS_LAST.get()
}

/// Does work without the GIL.
pub(crate) fn without_gil<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> T {
    returning_from(py, work).0
}

/// Does work without the GIL. What is returned with the result keeps the interpreter from ending: for callers that then call
/// functions in Python, which may hand the GIL to another thread.
pub(crate) fn returning_from<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> (T, Returning) {
    py.detach(|| {
        let result = work();
        (result, Returning::new())
    })
}

/// Has Python call [`end`] before it ends the interpreter.
pub(crate) fn watch_for_it(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let end = pyo3::wrap_pyfunction!(end, module)?;
    module.py().import("atexit")?.call_method1("register", (end,))?;
    Ok(())
}

/// Keeps all other threads from coming back.
#[pyfunction]
fn end(py: Python<'_>) {
    IS_LAST.set(true);
    ENDING.store(true, Ordering::SeqCst);
    let begun = Instant::now();
    py.detach(|| {
        while RETURNING.load(Ordering::SeqCst) > 0 && begun.elapsed() < PATIENCE {
            std::thread::sleep(Duration::from_millis(1));
        }
    });
}
