//! Errors of all parts of Bilux.

use crate::encoding::EncodingError;
use crate::limits::memory::Memory;
use bilux_formats::FormatError;
use bilux_pictures::PictureError;
use bilux_scene::SceneError;
use bilux_transport::{FilmError, RenderError};
use std::io;
use std::path::PathBuf;

/// Anything that can go wrong. Each message says what is wrong, where, and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An error in a scene file.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// An error in a scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// An error in a picture.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// An error during rendering.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// An error in a film, or in part of one.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// The picture would take more memory than is allowed.
    #[error(
        "this would take about {} MB of memory ({} MB for meshes, {} MB for textures, {} MB for acceleration \
         structures, {} MB for the picture), but only {} MB are allowed: {}, or allow more memory",
        mega(.needed.total()), mega(.needed.meshes), mega(.needed.textures + .needed.levels), mega(.needed.trees),
        mega(.needed.picture), .most / 1_000_000, smaller(.needed)
    )]
    TooLarge {
        /// An estimate of the memory that it would take.
        needed: Memory,
        /// The number of bytes allowed.
        most: u64,
    },
    /// A scene cannot be encoded or decoded.
    #[error(transparent)]
    Encoding(#[from] EncodingError),
    /// A checkpoint cannot be used.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// Settings that contradict each other.
    #[error("{0}")]
    Settings(String),
}

/// Why a checkpoint cannot be read, or does not fit.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The file cannot be read or written.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The step that failed.
        action: &'static str,
        /// Why it failed.
        source: io::Error,
    },
    /// The file is not a checkpoint, or damaged.
    #[error("{}: {what}: delete it, or begin anew without it", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The fault.
        what: String,
    },
    /// The checkpoint belongs to another picture.
    #[error(
        "{}: this is the checkpoint of another picture; what differs: {}; render as before, or begin anew without it",
        path.display(), differences.join(", ")
    )]
    OtherPicture {
        /// The file.
        path: PathBuf,
        /// The properties that differ.
        differences: Vec<String>,
    },
    /// The file is too large to be read.
    #[error("{}: this checkpoint has {size} bytes, but only {most} are allowed: allow more memory", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The size of the file in bytes.
        size: u64,
        /// The maximum.
        most: u64,
    },
}

/// A reader that was refused memory needs at most so many times what it had asked for by then, in the files that were
/// tried, if that is more than [`LEAST_FOR_READING`].
const TIMES_ASKED: u64 = 4;

/// Bytes that are always allowed where reading was refused memory: compressed textures and meshes take up to a hundred
/// times the size of their file, so what a reader asks for first says little about small files.
const LEAST_FOR_READING: u64 = 1 << 30;

/// A file that asks for so many bytes is broken, or means harm.
const BEYOND_BELIEF: u64 = 1 << 40;

impl Error {
    /// The memory to allow, in bytes, if an error says that less is allowed than is needed. Whole GiB, or below one GiB whole
    /// MiB. A render that was refused then has enough; reading a file, which is refused before all of it is known, most
    /// probably.
    pub fn memory_to_allow(&self) -> Option<u64> {
        let bytes = match self {
            Error::TooLarge { needed, .. } => needed.total(),
            Error::Format(FormatError::TooLarge { asked, .. }) if *asked < BEYOND_BELIEF => {
                (asked * TIMES_ASKED).max(LEAST_FOR_READING)
            }
            _ => return None,
        };
        let unit = if bytes >= 1 << 30 { 1 << 30 } else { 1 << 20 };
        Some(bytes.div_ceil(unit).saturating_mul(unit))
    }
}

/// Advice on what to make smaller: whatever takes the most memory.
fn smaller(needed: &Memory) -> &'static str {
    let Memory { meshes, textures, levels, grids, trees, picture } = *needed;
    if picture >= (meshes + trees).max(textures + levels).max(grids) {
        "make the picture smaller"
    } else if grids > (meshes + trees).max(textures + levels) {
        "make the grids coarser"
    } else if textures + levels > meshes + trees {
        "make the textures smaller"
    } else {
        "simplify the model, or leave parts of it out"
    }
}

fn mega(bytes: u64) -> u64 {
    bytes.div_ceil(1_000_000)
}
