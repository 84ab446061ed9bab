//! Interruption of the work: Ctrl-C, SIGTERM, the end of the terminal, `--timeout`, or a change of what is rendered.

use signal_hook::consts::SIGTERM;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

/// Interruption of the work, if any.
#[derive(Clone, Default)]
pub struct Interrupt {
    /// The signal's number, or [`TIMEOUT`].
    signal: Arc<AtomicUsize>,
    /// Whether the work ends by itself when it is interrupted, and saves what there is.
    ends_itself: Arc<AtomicBool>,
    /// Whether what is being rendered has changed in the meantime.
    superseded: Arc<AtomicBool>,
    /// Whether more signals change nothing.
    ignores_more: Arc<AtomicBool>,
}

/// The exit status after a timeout, the same as that of the command `timeout`.
pub const TIMED_OUT: u8 = 124;

/// Takes the place of a signal's number when the time is up.
const TIMEOUT: usize = usize::MAX;

/// The one of this process.
static INTERRUPT: OnceLock<Interrupt> = OnceLock::new();

/// Interruption of the work of this process.
pub fn interrupt() -> &'static Interrupt {
    INTERRUPT.get_or_init(Interrupt::default)
}

impl Interrupt {
    /// Notes a signal by its number; returns false if it is not the first, or the time was up before.
    pub fn note(&self, signal: i32) -> bool {
        self.signal.compare_exchange(0, signal as usize, Ordering::SeqCst, Ordering::SeqCst).is_ok()
    }

    /// Notes that the time is up, unless a signal came before.
    pub fn note_timeout(&self) {
        let _ = self.signal.compare_exchange(0, TIMEOUT, Ordering::SeqCst, Ordering::SeqCst);
    }

    /// True if the work ends by itself when it is interrupted.
    pub fn has_an_end(&self) -> bool {
        self.ends_itself.load(Ordering::SeqCst)
    }

    /// True if more signals change nothing.
    pub fn ignores_more(&self) -> bool {
        self.ignores_more.load(Ordering::SeqCst)
    }

    /// Says whether, from now on, the work ends by itself when it is interrupted, and saves what there is.
    pub fn ends_itself(&self, yes: bool) {
        self.ends_itself.store(yes, Ordering::SeqCst);
    }

    /// From now on, a second signal changes nothing: several who stop the work mean the same.
    pub fn ignore_more(&self) {
        self.ignores_more.store(true, Ordering::SeqCst);
    }

    /// True if the timeout stopped the work.
    pub fn timed_out(&self) -> bool {
        self.signal.load(Ordering::Relaxed) == TIMEOUT
    }

    /// True if it was stopped by somebody who does not watch: the timeout or SIGTERM, in contrast to Ctrl-C.
    pub fn is_terminated(&self) -> bool {
        [TIMEOUT, SIGTERM as usize].contains(&self.signal.load(Ordering::Relaxed))
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

    /// Returns 129, 130 or 143 after a signal, 124 after a timeout, and 0 otherwise.
    pub fn exit_status(&self) -> u8 {
        match self.signal.load(Ordering::Relaxed) {
            0 => 0,
            TIMEOUT => TIMED_OUT,
            signal => status(signal),
        }
    }
}

/// The exit status by which shells report a signal.
pub fn status(signal: usize) -> u8 {
    128 + signal as u8
}
