//! Progress: a bar on a terminal, a line every few seconds elsewhere.

use crate::arguments::{Common, ProgressStyle};
use crate::process::interrupt::Interrupt;
use crate::process::output;
use bilux::transport::Progress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle as BarStyle};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Shows the samples done, rays per second and the time left.
pub struct Report {
    interrupt: Interrupt,
    bar: Option<ProgressBar>,
    style: ProgressStyle,
    label: String,
    total: AtomicU64,
    samples: AtomicU64,
    rays: AtomicU64,
    begun: Instant,
    last_line: Mutex<Instant>,
}

/// The time between two lines where there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(5);

impl Report {
    /// Makes a report on the work that `label` names.
    pub fn new(label: &str, common: &Common, interrupt: Interrupt) -> Report {
        let terminal = output::is_capable_terminal();
        let style = match common.progress {
            _ if common.quiet => ProgressStyle::None,
            ProgressStyle::Auto if terminal => ProgressStyle::Bar,
            ProgressStyle::Auto => ProgressStyle::Lines,
            chosen => chosen,
        };
        let bar = (style == ProgressStyle::Bar).then(|| {
            let template = "{prefix} [{bar:32}] {percent:>3}%  {msg}  {eta} left";
            let bar = ProgressBar::with_draw_target(Some(1), ProgressDrawTarget::stderr_with_hz(10));
            bar.set_style(BarStyle::with_template(template).unwrap_or_else(|_| BarStyle::default_bar()));
            bar.set_prefix(label.to_owned());
            bar
        });
        let now = Instant::now();
        Report {
            interrupt,
            bar,
            style,
            label: label.to_owned(),
            total: AtomicU64::new(1),
            samples: AtomicU64::new(0),
            rays: AtomicU64::new(0),
            begun: now,
            last_line: Mutex::new(now),
        }
    }

    /// Removes the bar and returns the elapsed seconds.
    pub fn finish(&self) -> f64 {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        if self.style == ProgressStyle::Openjd {
            for_scheduler(of_all(100.0));
        }
        self.begun.elapsed().as_secs_f64()
    }

    /// The bar, if there is one.
    pub fn bar(&self) -> Option<ProgressBar> {
        self.bar.clone()
    }

    fn rate(&self) -> f64 {
        self.rays.load(Ordering::Relaxed) as f64 / self.begun.elapsed().as_secs_f64().max(1e-9)
    }

    fn line(&self, samples: u64) {
        let Ok(mut last) = self.last_line.try_lock() else { return };
        if last.elapsed() < LINE_EVERY {
            return;
        }
        *last = Instant::now();
        let (percent, left) =
            remaining(samples, self.total.load(Ordering::Relaxed), self.begun.elapsed().as_secs_f64());
        if self.style == ProgressStyle::Openjd {
            return for_scheduler(of_all(percent));
        }
        let left = left.map_or_else(String::new, |left| format!(", {left:.0} s left"));
        output::eprint(format_args!("{}: {percent:.0}%, {:.2} Mrays/s{left}", self.label, self.rate() / 1e6));
    }
}

impl Progress for Report {
    fn begin(&self, samples: u64) {
        self.total.store(samples, Ordering::Relaxed);
        if let Some(bar) = &self.bar {
            bar.set_length(samples);
        }
    }

    fn advance(&self, samples: u64, rays: u64) {
        let samples = self.samples.fetch_add(samples, Ordering::Relaxed) + samples;
        self.rays.fetch_add(rays, Ordering::Relaxed);
        if let Some(bar) = &self.bar {
            bar.set_position(samples.min(self.total.load(Ordering::Relaxed)));
            bar.set_message(format!("{:.2} Mrays/s", self.rate() / 1e6));
        } else if matches!(self.style, ProgressStyle::Lines | ProgressStyle::Openjd) {
            self.line(samples);
        }
    }

    fn is_cancelled(&self) -> bool {
        self.interrupt.is_requested()
    }
}

/// Of several pictures, how many are done, and how many there are.
static SERIES: [AtomicU32; 2] = [AtomicU32::new(0), AtomicU32::new(1)];

/// From now on, progress is that of a series of pictures, of which so many are done.
pub fn of_series(done: u32, all: u32) {
    SERIES[0].store(done, Ordering::Relaxed);
    SERIES[1].store(all.max(1), Ordering::Relaxed);
}

/// The percent of all pictures, by that of one.
fn of_all(percent: f64) -> f64 {
    let [done, all] = [0, 1].map(|i| f64::from(SERIES[i].load(Ordering::Relaxed)));
    (100.0 * done + percent) / all
}

/// A message of an action to its scheduler, which reads both streams.
fn for_scheduler(percent: f64) {
    output::eprint(format_args!("openjd_progress: {percent:.1}"));
}

/// Too small a share of the work to tell how long the rest takes.
const TOO_LITTLE: f64 = 0.01;

/// Percent done and seconds left, if these can be told. Where noise ends a render, the total is an estimate: much too high at first, and
/// it may turn out to be too low.
fn remaining(samples: u64, total: u64, seconds: f64) -> (f64, Option<f64>) {
    let share = (samples as f64 / total.max(1) as f64).min(1.0);
    (share * 100.0, (share >= TOO_LITTLE).then(|| seconds * (1.0 - share) / share))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_of_a_series_share_its_progress() {
        of_series(2, 4);
        assert_eq!([of_all(0.0), of_all(40.0), of_all(100.0)], [50.0, 60.0, 75.0]);
        of_series(0, 1);
        assert_eq!(of_all(40.0), 40.0);
    }

    #[test]
    fn an_estimate_that_was_too_low_is_never_exceeded() {
        assert_eq!(remaining(25, 100, 5.0), (25.0, Some(15.0)));
        assert_eq!(remaining(102, 100, 5.0), (100.0, Some(0.0)));
        assert!(remaining(102, 100, 5.0).1.is_some_and(f64::is_sign_positive), "no -0 s are left");
        assert_eq!(remaining(0, 0, 5.0), (0.0, None));
        assert_eq!(remaining(1, 1_000_000, 2.0).1, None, "nobody knows yet");
    }
}
