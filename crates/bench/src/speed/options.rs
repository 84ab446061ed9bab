//! Options of `bench speed`.

use bilux::formats::ReadOptions;
use std::path::PathBuf;

/// Rows to measure, and the programs and the effort for them.
#[derive(Clone, Debug)]
pub struct Options {
    /// Names from [`MEASUREMENTS`](super::MEASUREMENTS); if empty, all of them.
    pub rows: Vec<String>,
    /// The model of the rows about models; they are skipped without one.
    pub model: Option<PathBuf>,
    /// Options for reading the model.
    pub read: ReadOptions,
    /// The Python that can import Mitsuba.
    pub python: PathBuf,
    /// Embree's library.
    pub embree: PathBuf,
    /// The program `bilux` itself, which measures memory in a process of its own.
    pub program: PathBuf,
    /// The number of repeats; the median is reported.
    pub repeats: u32,
    /// The CPU seconds per picture where integrators are compared at equal time.
    pub seconds: f64,
    /// The share of the usual samples, seconds and rays, above 0 and at most 1: less is quicker, and less accurate.
    pub share: f64,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            rows: Vec::new(),
            model: None,
            read: ReadOptions::default(),
            python: "python3".into(),
            embree: "libembree4.so.4".into(),
            program: "bilux".into(),
            repeats: 3,
            seconds: 1.0,
            share: 1.0,
        }
    }
}

impl Options {
    /// A share of what is usual, at least 1.
    pub(super) fn part_of(&self, usual: u32) -> u32 {
        ((f64::from(usual) * self.share).round() as u32).max(1)
    }
}
