//! Errors between a scene and its picture.

use crate::film::window::Window;
use bilux_pictures::PictureError;
use bilux_scene::SceneError;
use std::ops::Range;

/// Why films cannot be made, merged or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FilmError {
    /// A side is zero or absurdly long.
    #[error(
        "a picture of {width} x {height} pixels: a side is 1 to {} pixels",
        crate::film::limits::MAX_SIDE
    )]
    Size {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// The crop is empty or extends beyond the film.
    #[error(
        "the crop {window} (x, y, width, height) must contain a pixel and lie within {width} x {height} pixels"
    )]
    Window {
        /// The crop.
        window: Window,
        /// Pixels across the film.
        width: u32,
        /// Pixels down the film.
        height: u32,
    },
    /// There is not enough memory.
    #[error("cannot allocate a film of {pixels} pixels; free some memory or make the picture smaller")]
    NoRoom {
        /// The requested number of pixels.
        pixels: u64,
    },
    /// The films have different sizes.
    #[error(
        "the films are of different sizes, {} x {} and {} x {} pixels; render all parts at one size, with --crop if \
         necessary",
        first[0], first[1], second[0], second[1]
    )]
    OtherSize {
        /// Width and height of the first film.
        first: [u32; 2],
        /// Width and height of the second film.
        second: [u32; 2],
    },
    /// The films show different scenes or settings.
    #[error(
        "the films come from different scenes or settings; parts of one picture may differ only in samples and crop"
    )]
    OtherPicture,
    /// Both films hold the same samples.
    #[error(
        "both films hold the samples {}..{} of the pixels {window} (x, y, width, height); each sample may be in only \
         one part",
        samples.start, samples.end
    )]
    Overlap {
        /// Pixels that both hold.
        window: Window,
        /// Samples that both hold.
        samples: Range<u32>,
    },
    /// A pixel has more samples than sums can hold.
    #[error("{samples} samples in one pixel; the maximum is {}", crate::film::limits::MAX_SAMPLES)]
    TooManySamples {
        /// Number of samples.
        samples: u64,
    },
    /// The picture is not a partial film.
    #[error("this is not a partial render: {what}; make one with --samples or --crop, written to an .exr")]
    NotAFilm {
        /// Fault: something missing or wrong.
        what: String,
    },
    /// A picture could not be made.
    #[error(transparent)]
    Picture(#[from] PictureError),
}

/// Why nothing can be rendered.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// A part of a picture cannot know when the whole is good enough.
    #[error(
        "a noise level or time limit needs the whole picture: leave out the crop and the range of samples"
    )]
    StopOfPart,
    /// A picture that is gathered from parts is whole.
    #[error("a picture from many parts has no crop and no layer 'interval': leave them out")]
    GatheringOfPart,
    /// An integrator without random numbers has no interval.
    #[error(
        "this integrator samples pixels in a fixed pattern, so there is no confidence interval: choose another \
             integrator, such as path"
    )]
    IntervalOfPattern,
    /// The integrator does not follow light in media that vary.
    #[error(
        "this scene has a medium that varies, such as smoke, which this integrator does not follow: choose another, such as auto, \
         path, bdpt or vcm"
    )]
    Media,
    /// The integrator does not find light that media emit.
    #[error(
        "this scene has a medium that emits light, which this integrator does not find: choose another, such as auto, path, bdpt or \
         vcm"
    )]
    Glow,
    /// The integrator does not find what a camera receives.
    #[error(
        "the camera is a meter of the light that arrives, which only path and auto measure: choose one of these"
    )]
    Receives,
    /// A checkpoint was made by a render that did not need something.
    #[error("the checkpoint does not hold {what}: render as before, or begin anew")]
    CheckpointLacks {
        /// Missing part.
        what: &'static str,
    },
    /// A checkpoint has more samples than are asked for.
    #[error(
        "the checkpoint already holds up to {samples} samples per pixel, which is more than is asked for: ask for more \
         samples or less noise, or begin anew"
    )]
    CheckpointBeyond {
        /// Samples per pixel in the checkpoint, where there are most.
        samples: u32,
    },
    /// A checkpoint belongs to another picture.
    #[error("the checkpoint is that of another picture: {what}")]
    OtherCheckpoint {
        /// Difference between the two pictures.
        what: String,
    },
    /// The film cannot be made.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// The range of samples is invalid.
    #[error(
        "samples {start}..{end} of {spp} per pixel: the range must contain a sample and end within {spp}, which must \
         be from 1 to {}",
        crate::film::limits::MAX_SAMPLES
    )]
    Samples {
        /// First sample.
        start: u32,
        /// One after the last.
        end: u32,
        /// Total number of samples.
        spp: u32,
    },
    /// The depth is beyond the maximum.
    #[error("a depth of {depth} scattering events; the maximum is {}", crate::film::limits::MAX_DEPTH)]
    Depth {
        /// The requested depth.
        depth: u32,
    },
    /// The pixel is not on the film.
    #[error(
        "pixel {x},{y} is outside the picture, which has {width} x {height} pixels: columns and rows count from 0"
    )]
    Pixel {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// A name is in no table, or a parameter is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The operating system cannot start the threads.
    #[error("cannot start {threads} threads: {reason}; ask for fewer")]
    Threads {
        /// The requested number of threads; 0 for one per core.
        threads: usize,
        /// The reason.
        reason: String,
    },
}
