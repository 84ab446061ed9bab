//! The cost of a render: the CPU seconds of all threads, and the peak memory.

use std::fs;
use std::time::Instant;

/// Measures from the start of a render.
pub(crate) struct Clock {
    begun: Instant,
    cpu: Option<f64>,
    threads: usize,
}

impl Clock {
    /// Starts the clock. `threads` is the number of threads that will render; 0 for all cores.
    pub(crate) fn start(threads: usize) -> Clock {
        // Resets the peak memory. Where that is not allowed, the result is the peak of the whole program.
        let _ = fs::write("/proc/self/clear_refs", "5");
        Clock { begun: Instant::now(), cpu: cpu_seconds(), threads }
    }

    /// Returns the CPU seconds since the start, to a hundredth (if the system does not report them: elapsed time times
    /// the number of threads), and the peak memory of the program, in MB of 10⁶ bytes.
    pub(crate) fn stop(self) -> (f64, Option<f64>) {
        let elapsed = self.begun.elapsed().as_secs_f64();
        let seconds = match (self.cpu, cpu_seconds()) {
            (Some(before), Some(after)) => after - before,
            _ => {
                let cores = || std::thread::available_parallelism().map_or(1, usize::from);
                elapsed * if self.threads == 0 { cores() } else { self.threads } as f64
            }
        };
        (seconds, peak_mb())
    }
}

/// The user and system time of all threads so far, from Linux, which counts in hundredths of a second.
fn cpu_seconds() -> Option<f64> {
    let text = fs::read_to_string("/proc/self/stat").ok()?;
    // The second field is the program's name, which may contain spaces.
    let mut fields = text.rsplit_once(')')?.1.split_whitespace().skip(11);
    let mut ticks = || fields.next()?.parse::<f64>().ok();
    Some((ticks()? + ticks()?) / 100.0)
}

fn peak_mb() -> Option<f64> {
    let text = fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(kib * 1024e-6)
}
