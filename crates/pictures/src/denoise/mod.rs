//! Denoising of pictures. To add a denoiser, add a file with its `ENTRY`, and a line in the table.
//!
//! Everything that a denoiser uses is stored in the picture's layers, so the picture may as well come from a file:
//! `albedo`, `normal` and `depth` of the visible surface, `variance` of each pixel, and `light` with its own
//! `light_variance`. `light` is the part of the picture that paths from the lights contributed, whose noise is of a
//! different kind. Each layer may be missing.

mod builtin;
mod noisy;
mod oidn;
mod task;

use crate::error::nearest;
use crate::{Picture, PictureError};
use bilux_math::Rgb;
pub use noisy::{Layer, Noisy, Source};
use std::thread::JoinHandle;
use std::time::Duration;
pub use task::{Denoiser, DenoiserEntry, Task};

/// Every available denoiser, best first.
pub static DENOISERS: &[DenoiserEntry] = &[oidn::ENTRY, builtin::ENTRY];

/// A chosen denoiser, with its expected time and advice.
pub struct DenoiserChoice {
    /// Name in [`DENOISERS`].
    pub name: &'static str,
    /// The denoiser.
    pub denoiser: Box<dyn Denoiser>,
    /// Approximate run time.
    pub time: Duration,
    /// Advice on getting a better denoiser, if there is one.
    pub advice: Option<String>,
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
