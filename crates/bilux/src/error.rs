//! What can go wrong, from any part of Bilux.

use crate::memory::Memory;
use bilux_formats::FormatError;
use bilux_pictures::PictureError;
use bilux_scene::SceneError;
use bilux_transport::{FilmError, RenderError};

/// Anything that can go wrong. Each message says what, where and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A scene file.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// A scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A picture.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The rendering itself.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// A film, or a part of one.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// A picture that would take more memory than it may.
    #[error(
        "this would take about {} MB of memory ({} MB for meshes, {} MB for textures, {} MB for the trees that find hits, \
         {} MB for the picture), and {} MB are allowed: {}, or allow more memory",
        mega(.needed.total()), mega(.needed.meshes), mega(.needed.textures + .needed.levels), mega(.needed.trees),
        mega(.needed.picture), .most / 1_000_000, smaller(.needed)
    )]
    TooLarge {
        /// What it would take.
        needed: Memory,
        /// How many bytes are allowed.
        most: u64,
    },
    /// Settings that do not go together.
    #[error("{0}")]
    Settings(String),
}

/// What to make smaller: that which takes the most.
fn smaller(needed: &Memory) -> &'static str {
    let Memory { meshes, textures, levels, trees, picture } = *needed;
    if picture >= (meshes + trees).max(textures + levels) {
        "make the picture smaller"
    } else if textures + levels > meshes + trees {
        "make the textures smaller"
    } else {
        "simplify the model, or leave parts of it out"
    }
}

fn mega(bytes: u64) -> u64 {
    bytes.div_ceil(1_000_000)
}
