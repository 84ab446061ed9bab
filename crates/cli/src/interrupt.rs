//! Ctrl-C and SIGTERM: the first asks the work to end and save what there is, the second ends it at once. `--timeout` does both, one
//! after the other.

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
    /// There is a picture that can be saved.
    renders: Arc<AtomicBool>,
}

/// In place of a signal: the time is over.
const TIMEOUT: usize = usize::MAX;

/// The exit status of what a timeout has ended, as that of the command `timeout`.
const TIMED_OUT: u8 = 124;

/// So long after a timeout what there is has to be saved.
const GRACE: Duration = Duration::from_secs(2);

impl Interrupt {
    /// Listens from now on.
    pub fn listen() -> anyhow::Result<Interrupt> {
        let signal = Arc::new(AtomicUsize::new(0));
        for wanted in [SIGINT, SIGTERM] {
            // In this order: the shutdown looks at the flag that an earlier signal has set.
            let again = Arc::new(AtomicBool::new(false));
            signal_hook::flag::register_conditional_shutdown(wanted, status(wanted as usize), again.clone())?;
            signal_hook::flag::register(wanted, again)?;
            signal_hook::flag::register_usize(wanted, signal.clone(), wanted as usize)?;
        }
        Ok(Interrupt { signal, renders: Arc::default() })
    }

    /// Ends the work after this time: what is rendered by then is saved; where nothing is, the program ends at once.
    pub fn end_after(&self, timeout: Duration) {
        let Interrupt { signal, renders } = self.clone();
        std::thread::spawn(move || {
            std::thread::sleep(timeout);
            signal.store(TIMEOUT, Ordering::Relaxed);
            let seconds = timeout.as_secs_f64();
            if renders.load(Ordering::Relaxed) {
                std::thread::sleep(GRACE);
                output::say(format_args!(
                    "error: --timeout: the picture could not be saved {seconds} s after the start"
                ));
            } else {
                output::say(format_args!(
                    "error: --timeout: {seconds} s were over before there was a picture to save"
                ));
            }
            std::process::exit(i32::from(TIMED_OUT));
        });
    }

    /// From here on there is a picture that can be saved, or no longer.
    pub fn renders(&self, yes: bool) {
        self.renders.store(yes, Ordering::Relaxed);
    }

    /// True where it was the time that ended the work.
    pub fn timed_out(&self) -> bool {
        self.signal.load(Ordering::Relaxed) == TIMEOUT
    }

    /// True when the work should end.
    pub fn is_requested(&self) -> bool {
        self.signal.load(Ordering::Relaxed) != 0
    }

    /// 130 or 143 after a signal, 124 after a timeout, 0 without.
    pub fn exit_status(&self) -> u8 {
        match self.signal.load(Ordering::Relaxed) {
            0 => 0,
            TIMEOUT => TIMED_OUT,
            signal => status(signal) as u8,
        }
    }
}

/// The exit status by which shells know a signal.
fn status(signal: usize) -> i32 {
    128 + signal as i32
}
