//! Ctrl-C and SIGTERM: the first signal asks the work to stop and save what there is, the second stops it at once.
//! `--timeout` does both, one after the other.

use crate::output;
use signal_hook::consts::{SIGINT, SIGTERM};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

/// What has interrupted the work, if anything has.
#[derive(Clone)]
pub struct Interrupt {
    /// The signal's number, or [`TIMEOUT`].
    signal: Arc<AtomicUsize>,
    /// Whether there is a picture that can be saved.
    renders: Arc<AtomicBool>,
    /// Whether what is being rendered has changed in the meantime.
    superseded: Arc<AtomicBool>,
}

/// Takes the place of a signal's number when the time is up.
const TIMEOUT: usize = usize::MAX;

/// The exit status after a timeout, the same as that of the command `timeout`.
const TIMED_OUT: u8 = 124;

/// How long saving may take after a timeout.
const GRACE: Duration = Duration::from_secs(2);

impl Interrupt {
    /// Starts listening for signals.
    pub fn listen() -> anyhow::Result<Interrupt> {
        let signal = Arc::new(AtomicUsize::new(0));
        for wanted in [SIGINT, SIGTERM] {
            // The order matters: the shutdown checks the flag that an earlier signal has set.
            let again = Arc::new(AtomicBool::new(false));
            signal_hook::flag::register_conditional_shutdown(wanted, status(wanted as usize), again.clone())?;
            signal_hook::flag::register(wanted, again)?;
            signal_hook::flag::register_usize(wanted, signal.clone(), wanted as usize)?;
        }
        Ok(Interrupt { signal, renders: Arc::default(), superseded: Arc::default() })
    }

    /// Stops the work after this time. What is rendered by then is saved; if nothing is, the program exits at once.
    pub fn end_after(&self, timeout: Duration) {
        let Interrupt { signal, renders, .. } = self.clone();
        std::thread::spawn(move || {
            std::thread::sleep(timeout);
            signal.store(TIMEOUT, Ordering::Relaxed);
            let seconds = timeout.as_secs_f64();
            if renders.load(Ordering::Relaxed) {
                std::thread::sleep(GRACE);
                output::eprint(format_args!(
                    "error: --timeout: the time of {seconds} s was up, and the picture could not be saved"
                ));
            } else {
                output::eprint(format_args!(
                    "error: --timeout: the time of {seconds} s was up before there was a picture to save"
                ));
            }
            std::process::exit(i32::from(TIMED_OUT));
        });
    }

    /// Says whether, from now on, there is a picture that can be saved.
    pub fn renders(&self, yes: bool) {
        self.renders.store(yes, Ordering::Relaxed);
    }

    /// True if the timeout stopped the work.
    pub fn timed_out(&self) -> bool {
        self.signal.load(Ordering::Relaxed) == TIMEOUT
    }

    /// Says whether what is being rendered has changed: then it should stop, and nothing be saved.
    pub fn supersede(&self, yes: bool) {
        self.superseded.store(yes, Ordering::Relaxed);
    }

    /// True if only a change stops the work.
    pub fn is_superseded(&self) -> bool {
        self.superseded.load(Ordering::Relaxed) && !self.is_signalled()
    }

    /// True after a signal or a timeout.
    pub fn is_signalled(&self) -> bool {
        self.signal.load(Ordering::Relaxed) != 0
    }

    /// True when the work should stop.
    pub fn is_requested(&self) -> bool {
        self.is_signalled() || self.superseded.load(Ordering::Relaxed)
    }

    /// Returns 130 or 143 after a signal, 124 after a timeout, and 0 otherwise.
    pub fn exit_status(&self) -> u8 {
        match self.signal.load(Ordering::Relaxed) {
            0 => 0,
            TIMEOUT => TIMED_OUT,
            signal => status(signal) as u8,
        }
    }
}

/// The exit status by which shells report a signal.
fn status(signal: usize) -> i32 {
    128 + signal as i32
}
