//! Ctrl-C, SIGTERM, the end of the terminal and `--timeout`: the first asks the work to stop and save what there is, and the
//! process ends within [`GRACE`] whatever it does; a second signal ends it at once. Where there is nothing to save, the first
//! does.
//!
//! A thread waits for signals, so that none of the work has to look for them: not reading, building trees or decoding,
//! nor a library in the midst of any of it.

use crate::process::ending::end;
use crate::process::interrupt::{Interrupt, TIMED_OUT, interrupt, status};
#[cfg(target_os = "linux")]
use signal_hook::consts::SIGHUP;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use std::sync::Arc;
use std::thread::Builder;
use std::time::Duration;

/// Time that saving may take after a signal or a timeout; the process is gone within 2 seconds.
pub const GRACE: Duration = Duration::from_millis(1800);

/// The signals that end the work. `nohup` has that of a closed terminal ignored, which holds. A sandbox hides what says so.
pub fn wanted() -> Vec<i32> {
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
            signalled(interrupt(), signal);
        }
    })?;
    Ok(())
}

/// Stops the work after what is left of the timeout. What is rendered by then is saved; if nothing is, the program exits at
/// once.
pub fn end_after(interrupt: &Interrupt, left: Duration, timeout: Duration) -> anyhow::Result<()> {
    let interrupt = interrupt.clone();
    thread("timeout").spawn(move || {
        std::thread::sleep(left);
        interrupt.note_timeout();
        let seconds = timeout.as_secs_f64();
        if interrupt.has_an_end() {
            std::thread::sleep(GRACE);
            let lost = "was up, and the picture could not be saved";
            end(TIMED_OUT, &format!("--timeout: the time of {seconds} s {lost}"));
        }
        let nothing = "was up before there was a picture to save";
        end(TIMED_OUT, &format!("--timeout: the time of {seconds} s {nothing}"));
    })?;
    Ok(())
}

/// Acts on a signal.
fn signalled(interrupt: &Interrupt, signal: i32) {
    let is_first = interrupt.note(signal);
    if !is_first && interrupt.ignores_more() {
        return;
    }
    if !is_first {
        end(status(signal as usize), "a second signal ended it at once, and nothing more was saved");
    }
    if !interrupt.has_an_end() {
        end(interrupt.exit_status(), "a signal ended it before there was a picture to save");
    }
    let late = interrupt.clone();
    let waits = thread("grace").spawn(move || {
        std::thread::sleep(GRACE);
        end(late.exit_status(), "a signal ended it, and what there is could not be saved in time");
    });
    if waits.is_err() {
        end(interrupt.exit_status(), "a signal ended it, and there is no memory to save what there is");
    }
}

/// A thread that waits most of the time, and needs little memory.
fn thread(name: &str) -> Builder {
    const STACK: usize = 256 << 10;
    Builder::new().name(name.to_owned()).stack_size(STACK)
}
