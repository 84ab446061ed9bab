//! Denoising of pictures. To add a denoiser, add a file with its `ENTRY`, and a line in the table.
//!
//! Everything that a denoiser uses is stored in the picture's layers, so the picture may as well come from a file:
//! `albedo`, `normal` and `depth` of the visible surface, `variance` of each pixel, and `light` with its own
//! `light_variance`. `light` is the part of the picture that paths from the lights contributed, whose noise is of a
//! different kind. Each layer may be missing.

mod builtin;
mod noisy;
mod oidn;

use crate::error::nearest;
use crate::{Picture, PictureError};
use bilux_math::Rgb;
use bilux_math::registry::Entry;
pub use noisy::{Layer, Noisy, Source};
use std::thread::JoinHandle;
use std::time::Duration;

/// Every available denoiser, best first.
pub const DENOISERS: &[DenoiserEntry] = &[oidn::ENTRY, builtin::ENTRY];

/// A row of [`DENOISERS`].
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
    /// Its name and location, for the user.
    fn describe(&self) -> String;

    /// The denoised picture, row by row. The result is the same for any number of threads.
    ///
    /// # Errors
    /// Returns an error when the machine has no memory left, or the denoiser fails.
    fn denoise(&self, source: &dyn Source) -> Result<Vec<Rgb>, PictureError>;
}

/// A chosen denoiser, with its expected time and advice.
pub struct DenoiserChoice {
    /// Its name in [`DENOISERS`].
    pub name: &'static str,
    /// The denoiser.
    pub denoiser: Box<dyn Denoiser>,
    /// Approximate run time.
    pub time: Duration,
    /// How to get a better denoiser, if there is one.
    pub advice: Option<String>,
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
    /// No external library may be loaded; one that [`preload`] has loaded before may be used.
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

/// Libraries that are being loaded on a separate thread.
pub struct Preload(Option<JoinHandle<()>>);

/// Starts to load what the best denoiser needs, for a number of threads (0 means one per core), so that it is there
/// when the picture has been rendered. Only later requests wait for it.
pub fn preload(threads: usize) -> Preload {
    // Without a thread they are loaded when they are needed.
    Preload(std::thread::Builder::new().spawn(move || oidn::load(threads)).ok())
}

impl Preload {
    /// Waits until everything that can be loaded is loaded: from then on [`Task::sandboxed`] no longer restricts the
    /// choice.
    pub fn wait(self) {
        // A failure is reported when a denoiser is requested.
        let _ = self.0.map(JoinHandle::join);
    }
}

/// The denoiser of this name, or for `auto` the best one that is available and fast enough.
///
/// # Errors
/// Returns an error when there is no such denoiser, or it is not available here.
pub fn denoiser(name: &str, task: &Task) -> Result<DenoiserChoice, PictureError> {
    let is_auto = name == "auto";
    // A denoiser that was requested by name may take as long as it needs.
    let task = &Task { time: task.time.filter(|_| is_auto), ..*task };
    let mut advice = None;
    for (i, row) in DENOISERS.iter().enumerate().filter(|(_, row)| is_auto || name == row.entry.name) {
        let time = (row.time)(task);
        let faster = || DENOISERS[i + 1..].iter().any(|other| (other.time)(task) < time);
        let is_too_slow = is_auto && task.time.is_some_and(|limit| time > limit) && faster();
        match (row.find)(task) {
            Ok(_) if is_too_slow => {
                let (name, seconds) = (row.entry.name, time.as_secs_f64());
                let longer = format!(
                    "'{name}' gives a cleaner picture, but takes about {seconds:.1} s: --denoise={name}"
                );
                advice = advice.or(Some(longer));
            }
            Ok(denoiser) => return Ok(DenoiserChoice { name: row.entry.name, denoiser, time, advice }),
            Err(missing) if is_auto => advice = advice.or(Some(missing).filter(|_| !task.sandboxed)),
            Err(missing) => return Err(PictureError::NoDenoiser { what: missing }),
        }
    }
    let names = || DENOISERS.iter().map(|row| row.entry.name).chain(["auto"]);
    Err(PictureError::UnknownName {
        kind: "denoiser",
        name: name.to_owned(),
        suggestion: nearest(name, names()),
        known: names().collect::<Vec<_>>().join(", "),
    })
}

/// The picture with its colours denoised; layers and texts stay as they are, and so do pixels that are not finite.
///
/// # Errors
/// Returns an error when the picture has no colours, or as [`Denoiser::denoise`].
pub fn denoise(picture: &Picture, denoiser: &dyn Denoiser) -> Result<Picture, PictureError> {
    let picture = picture.clone().into_linear();
    let smooth = denoiser.denoise(&picture)?;
    Ok(repainted(picture, &smooth))
}

/// The picture with other colours, row by row. Pixels that are not finite stay as they are, and so do those whose alpha is 0.
pub fn repainted(mut picture: Picture, colours: &[Rgb]) -> Picture {
    let is_changed: Vec<bool> = match picture.rgb_planes() {
        Some(planes) => {
            let alpha = picture.channel("A");
            let is_there = |i: usize| alpha.is_none_or(|alpha| alpha[i] != 0.0);
            let is_finite = |i: usize| planes.iter().all(|plane| plane[i].is_finite());
            (0..picture.pixel_count()).map(|i| is_there(i) && is_finite(i)).collect()
        }
        None => Vec::new(),
    };
    for (component, channel) in [("R", 0), ("G", 1), ("B", 2), ("Y", 1)] {
        let samples = picture.channel_mut(component).unwrap_or_default();
        for (i, sample) in samples.iter_mut().enumerate().filter(|(i, _)| is_changed[*i]) {
            *sample = colours[i][channel];
        }
    }
    picture
}
