//! From a noisy picture to a smooth one. To add a denoiser: a file with its `ENTRY`, and a line in the table.
//!
//! All that a denoiser goes by travels in the picture's layers, so that it may as well come from a file: `albedo`, `normal` and
//! `depth` of what is seen, `variance` of each pixel, and `light`, a part of the picture with `light_variance` of its own: what was brought by paths from the
//! lights, whose noise is of another kind. Each layer may be missing.

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

/// Every denoiser that there is, the best first.
pub const DENOISERS: &[DenoiserEntry] = &[oidn::ENTRY, builtin::ENTRY];

/// A row of [`DENOISERS`].
#[derive(Clone, Copy, Debug)]
pub struct DenoiserEntry {
    /// Name, summary, source and parameters.
    pub entry: Entry,
    /// About how long it takes, where the task leaves it the choice.
    pub time: fn(&Task) -> Duration,
    /// It is in a library of others, which is loaded, and looked for in folders of theirs.
    pub is_library: bool,
    /// Gets it ready; else says what is missing, and how to get it.
    pub find: fn(&Task) -> Result<Box<dyn Denoiser>, String>,
}

/// One that is ready.
pub trait Denoiser {
    /// What it is and where it was found, for people.
    fn describe(&self) -> String;

    /// The picture without its noise, row by row. The same for any number of threads.
    ///
    /// # Errors
    /// When the machine has no room, or what denoises fails.
    fn denoise(&self, source: &dyn Source) -> Result<Vec<Rgb>, PictureError>;
}

/// A denoiser that was chosen, and what there is to say about the choice.
pub struct Chosen {
    /// The denoiser.
    pub denoiser: Box<dyn Denoiser>,
    /// About how long it takes.
    pub time: Duration,
    /// How to get a better one, where there is one.
    pub advice: Option<String>,
}

/// What is to be denoised, and how long that may take.
#[derive(Clone, Copy, Debug, Default)]
pub struct Task {
    /// Pixels across and down, where that is known.
    pub size: (usize, usize),
    /// Threads; 0 for one each core.
    pub threads: usize,
    /// What the best denoiser may take at most, if that matters: it does as well as it can within that.
    pub time: Option<Duration>,
    /// No library of others may be loaded; what [`preload`] has loaded before may be used.
    pub sandboxed: bool,
}

impl Task {
    /// Pixels in all.
    pub fn pixels(&self) -> u64 {
        self.size.0 as u64 * self.size.1 as u64
    }

    /// Threads, at least 1.
    pub fn threads_at_work(&self) -> usize {
        let cores = || std::thread::available_parallelism().map_or(1, usize::from);
        if self.threads == 0 { cores() } else { self.threads }
    }
}

/// Libraries that are being loaded on a thread of their own.
pub struct Preload(JoinHandle<()>);

/// Begins to load what the best denoiser needs, for so many threads (0 for one each core), so that it is there when the picture is
/// rendered. Only what is asked for after this waits for it.
pub fn preload(threads: usize) -> Preload {
    Preload(std::thread::spawn(move || oidn::load(threads)))
}

impl Preload {
    /// Waits until all is loaded that can be: from then on [`Task::sandboxed`] holds nothing back.
    pub fn wait(self) {
        // That it failed is told when a denoiser is asked for.
        let _ = self.0.join();
    }
}

/// The denoiser of this name, or for `auto` the best that can be had, and has the time.
///
/// # Errors
/// When there is no such denoiser, or it is not to be had here.
pub fn denoiser(name: &str, task: &Task) -> Result<Chosen, PictureError> {
    let is_auto = name == "auto";
    // What was asked for by its name takes what it takes.
    let task = &Task { time: task.time.filter(|_| is_auto), ..*task };
    let mut advice = None;
    for (i, row) in DENOISERS.iter().enumerate().filter(|(_, row)| is_auto || name == row.entry.name) {
        let time = (row.time)(task);
        let faster = || DENOISERS[i + 1..].iter().any(|other| (other.time)(task) < time);
        let is_too_slow = is_auto && task.time.is_some_and(|limit| time > limit) && faster();
        match (row.find)(task) {
            Ok(_) if is_too_slow => {
                let (name, seconds) = (row.entry.name, time.as_secs_f64());
                let longer =
                    format!("'{name}' does better, but takes about {seconds:.1} s: --denoise={name}");
                advice = advice.or(Some(longer));
            }
            Ok(denoiser) => return Ok(Chosen { denoiser, time, advice }),
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

/// The picture with its colours denoised; layers and texts stay as they are. Pixels that are not finite stay so.
///
/// # Errors
/// When it has no colours, or as [`Denoiser::denoise`].
pub fn denoise(picture: &Picture, denoiser: &dyn Denoiser) -> Result<Picture, PictureError> {
    let picture = picture.clone().into_linear();
    let smooth = denoiser.denoise(&picture)?;
    Ok(repainted(picture, &smooth))
}

/// The picture in other colours, row by row. Pixels that are not finite stay so.
pub fn repainted(mut picture: Picture, colours: &[Rgb]) -> Picture {
    let finite: Vec<bool> = match picture.rgb_planes() {
        Some(planes) => {
            (0..picture.pixel_count()).map(|i| planes.iter().all(|plane| plane[i].is_finite())).collect()
        }
        None => Vec::new(),
    };
    for (component, channel) in [("R", 0), ("G", 1), ("B", 2), ("Y", 1)] {
        let samples = picture.channel_mut(component).unwrap_or_default();
        for (i, sample) in samples.iter_mut().enumerate().filter(|(i, _)| finite[*i]) {
            *sample = colours[i][channel];
        }
    }
    picture
}
