//! What a render takes: CPU seconds of all threads, and the most memory.

use std::fs;
use std::time::Instant;

/// Runs from when a render begins.
pub(super) struct Clock {
    begun: Instant,
    cpu: Option<f64>,
    threads: usize,
}

impl Clock {
    /// `threads` are those that will be at work; 0 for all cores.
    pub(super) fn start(threads: usize) -> Clock {
        // Forgets the peak so far. Where that is not allowed, what is told is the peak of the whole program.
        let _ = fs::write("/proc/self/clear_refs", "5");
        Clock { begun: Instant::now(), cpu: cpu_seconds(), threads }
    }

    /// CPU seconds since, in hundredths (where the system does not tell: time by the clock on each thread), and the most
    /// memory that the program had, in MB of 10⁶ bytes.
    pub(super) fn stop(self) -> (f64, Option<f64>) {
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

/// User and system time of all threads so far, from Linux, which counts in hundredths.
fn cpu_seconds() -> Option<f64> {
    let text = fs::read_to_string("/proc/self/stat").ok()?;
    // The second field is the program's name, and may hold blanks.
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
