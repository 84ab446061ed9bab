//! Ctrl-C, SIGTERM and the end of the terminal for the process that reads the jobs: it goes on until the job under way has its result.

use crate::process::signals;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The signal that came, if one has.
pub struct Signals(Arc<AtomicUsize>);

impl Signals {
    /// Starts listening.
    pub fn listen() -> std::io::Result<Signals> {
        let signal = Arc::default();
        for wanted in signals::wanted() {
            signal_hook::flag::register_usize(wanted, Arc::clone(&signal), wanted as usize)?;
        }
        Ok(Signals(signal))
    }

    /// The exit status by which shells report the signal, if one came.
    pub fn status(&self) -> Option<u8> {
        let signal = self.0.load(Ordering::Relaxed);
        (signal != 0).then_some(128 + signal as u8)
    }
}
