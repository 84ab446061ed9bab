//! Ctrl-C and SIGTERM: the first asks the work to end and save what there is, the second ends it at once.

use signal_hook::consts::{SIGINT, SIGTERM};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Which signal has come, if one has.
#[derive(Clone)]
pub struct Interrupt {
    signal: Arc<AtomicUsize>,
}

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
        Ok(Interrupt { signal })
    }

    /// True when the work should end.
    pub fn is_requested(&self) -> bool {
        self.signal.load(Ordering::Relaxed) != 0
    }

    /// 130 or 143 after a signal, 0 without.
    pub fn exit_status(&self) -> u8 {
        match self.signal.load(Ordering::Relaxed) {
            0 => 0,
            signal => status(signal) as u8,
        }
    }
}

/// The exit status by which shells know a signal.
fn status(signal: usize) -> i32 {
    128 + signal as i32
}
