//! What can go wrong in any part of Bilux.

use crate::checkpoint::CheckpointError;
use crate::encoding::EncodingError;
use crate::memory::Memory;
use bilux_formats::FormatError;
use bilux_pictures::PictureError;
use bilux_scene::SceneError;
use bilux_transport::{FilmError, RenderError};

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

/// What to make smaller: whatever takes the most memory.
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
