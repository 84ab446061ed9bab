//! Denoisers, and the task that one is given.

use super::noisy::Source;
use crate::PictureError;
use bilux_math::Rgb;
use bilux_math::registry::Entry;
use std::time::Duration;

/// A row of [`DENOISERS`](super::DENOISERS).
#[derive(Clone, Copy, Debug)]
pub struct DenoiserEntry {
    /// Name, summary, source and parameters.
    pub entry: Entry,
    /// Approximate run time, where the task leaves the choice to the denoiser.
    pub time: fn(&Task) -> Duration,
    /// True for an external library, which is searched for in folders outside the project and loaded at run time.
    pub is_library: bool,
    /// Prepares the denoiser, or says what is missing and how to get it.
    pub find: fn(&Task) -> Result<Box<dyn Denoiser>, String>,
}

/// A denoiser that is ready to run.
pub trait Denoiser: Send + Sync {
    /// Name and location of the denoiser, for the user.
    fn describe(&self) -> String;

    /// The denoised picture, row by row. The result is the same for any number of threads.
    ///
    /// # Errors
    /// Returns an error when the machine has no memory left, or the denoiser fails.
    fn denoise(&self, source: &dyn Source) -> Result<Vec<Rgb>, PictureError>;
}

/// The denoising task, and how long it may take.
#[derive(Clone, Copy, Debug, Default)]
pub struct Task {
    /// Width and height in pixels, where known.
    pub size: (usize, usize),
    /// Number of threads; 0 means one per core.
    pub threads: usize,
    /// Maximum time for the best denoiser, if there is a limit: it does as well as it can within that time.
    pub time: Option<Duration>,
    /// No external library may be loaded; one that [`preload`](super::preload) has loaded before may be used.
    pub sandboxed: bool,
}

impl Task {
    /// Total number of pixels.
    pub fn pixels(&self) -> u64 {
        self.size.0 as u64 * self.size.1 as u64
    }

    /// Number of threads, at least 1.
    pub fn thread_count(&self) -> usize {
        let cores = || std::thread::available_parallelism().map_or(1, usize::from);
        if self.threads == 0 { cores() } else { self.threads }
    }
}
