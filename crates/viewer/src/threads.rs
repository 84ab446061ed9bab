//! Threads.

use crate::ViewerError;
use std::thread::JoinHandle;

/// Starts a thread with a name, which debuggers show.
///
/// # Errors
/// If the system has no thread for it.
pub(crate) fn start(name: &str, work: impl FnOnce() + Send + 'static) -> Result<JoinHandle<()>, ViewerError> {
    let thread = std::thread::Builder::new().name(name.to_owned()).spawn(work);
    thread.map_err(|error| ViewerError::Start(error.to_string()))
}
