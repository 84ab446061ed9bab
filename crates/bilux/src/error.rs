//! What can go wrong, from any part of Bilux.

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
    /// Settings that do not go together.
    #[error("{0}")]
    Settings(String),
}
