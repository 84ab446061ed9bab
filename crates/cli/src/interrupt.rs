//! Ctrl-C, SIGTERM, the end of the terminal and `--timeout`: the first asks the work to stop and save what there is, and the
//! process ends within [`GRACE`] whatever it does; a second signal ends it at once. Where there is nothing to save, the first
//! does.
//!
//! A thread waits for signals, so that none of the work has to look for them: not reading, building trees or decoding,
//! nor a library in the midst of any of it.

use crate::ending::end;
#[cfg(target_os = "linux")]
use signal_hook::consts::SIGHUP;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread::Builder;
use std::time::Duration;

/// What has interrupted the work, if anything has.
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

/// Takes the place of a signal's number when the time is up.
const TIMEOUT: usize = usize::MAX;

/// The exit status after a timeout, the same as that of the command `timeout`.
const TIMED_OUT: u8 = 124;

/// How long saving may take after a signal or a timeout; the process is gone within 2 seconds.
pub const GRACE: Duration = Duration::from_millis(1800);

/// The one of this process.
static INTERRUPT: OnceLock<Interrupt> = OnceLock::new();

/// What interrupts the work of this process.
pub fn interrupt() -> &'static Interrupt {
    INTERRUPT.get_or_init(Interrupt::default)
}

/// The signals that end the work. `nohup` has that of a closed terminal ignored, which holds. A sandbox hides what says so.
pub fn signals() -> Vec<i32> {
    let mut all = vec![SIGINT, SIGTERM];
    #[cfg(target_os = "linux")]
    if !is_ignored(SIGHUP) {
        all.push(SIGHUP);
    }
    all
}

/// Whether the process was started with a signal ignored: in `/proc/self/status`, each has a bit of a hexadecimal number.
#[cfg(target_os = "linux")]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let bits = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let bits = bits.and_then(|bits| u64::from_str_radix(bits.trim(), 16).ok());
    bits.is_none_or(|bits| bits >> (signal - 1) & 1 == 1)
}

/// From now on, waits for these signals in a thread. This comes after `--sandbox` is in force, which the thread inherits.
pub fn listen(wanted: &[i32]) -> anyhow::Result<()> {
    // Files that grow beyond `ulimit -f` then give an error, and what is half written is removed.
    #[cfg(unix)]
    signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::default())?;
    let mut signals = Signals::new(wanted)?;
    thread("signals").spawn(move || {
        for signal in signals.forever() {
            interrupt().signalled(signal);
        }
    })?;
    Ok(())
}

/// A thread that waits most of the time, and needs little memory.
fn thread(name: &str) -> Builder {
    const STACK: usize = 256 << 10;
    Builder::new().name(name.to_owned()).stack_size(STACK)
}

impl Interrupt {
    /// What a signal does.
    fn signalled(&self, signal: i32) {
        let first = self.signal.compare_exchange(0, signal as usize, Ordering::SeqCst, Ordering::SeqCst);
        if first.is_err() && self.ignores_more.load(Ordering::SeqCst) {
            return;
        }
        if first.is_err() {
            end(status(signal as usize), "a second signal ended it at once, and nothing more was saved");
        }
        if !self.ends_itself.load(Ordering::SeqCst) {
            end(self.exit_status(), "a signal ended it before there was a picture to save");
        }
        let late = self.clone();
        let waits = thread("grace").spawn(move || {
            std::thread::sleep(GRACE);
            end(late.exit_status(), "a signal ended it, and what there is could not be saved in time");
        });
        if waits.is_err() {
            end(self.exit_status(), "a signal ended it, and there is no memory to save what there is");
        }
    }

    /// Stops the work after what is left of the timeout. What is rendered by then is saved; if nothing is, the program exits at
    /// once.
    pub fn end_after(&self, left: Duration, timeout: Duration) -> anyhow::Result<()> {
        let Interrupt { signal, ends_itself, .. } = self.clone();
        thread("timeout").spawn(move || {
            std::thread::sleep(left);
            let _ = signal.compare_exchange(0, TIMEOUT, Ordering::SeqCst, Ordering::SeqCst);
            let seconds = timeout.as_secs_f64();
            if ends_itself.load(Ordering::SeqCst) {
                std::thread::sleep(GRACE);
                let lost = "was up, and the picture could not be saved";
                end(TIMED_OUT, &format!("--timeout: the time of {seconds} s {lost}"));
            }
            let nothing = "was up before there was a picture to save";
            end(TIMED_OUT, &format!("--timeout: the time of {seconds} s {nothing}"));
        })?;
        Ok(())
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
fn status(signal: usize) -> u8 {
    128 + signal as u8
}
