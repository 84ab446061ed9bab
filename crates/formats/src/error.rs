//! What can be wrong with a scene file.

use bilux_pictures::{PictureError, reason};
use bilux_scene::{SceneError, Span, Warning};
use std::path::PathBuf;

/// Why a scene file cannot be read or written. Every message says what, where and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FormatError {
    /// A file cannot be opened, read or written.
    #[error("{}: cannot {action}: {}", .path.display(), reason(.source))]
    Io {
        /// Which file.
        path: PathBuf,
        /// What was tried, such as `open it`.
        action: &'static str,
        /// What the machine says.
        source: std::io::Error,
    },
    /// The file is not what its format says.
    #[error("{at}: {message}")]
    Malformed {
        /// What is wrong and what to do.
        message: String,
        /// Where.
        at: Span,
    },
    /// A file that another one names is not there.
    #[error("{at}: there is no file '{name}' in {}; put it there, or correct its name", .folder.display())]
    MissingFile {
        /// The name as written.
        name: String,
        /// Where it was looked for.
        folder: PathBuf,
        /// Where it is named.
        at: Span,
    },
    /// A file that another one names is not in the scene's folder.
    #[error(
        "{at}: '{name}' lies outside the scene's folder, and only files in it are opened: copy it there, or \
         allow files outside"
    )]
    Outside {
        /// The name as written.
        name: String,
        /// Where it is named.
        at: Span,
    },
    /// More memory is needed than is allowed.
    #[error(
        "{file}: reading this takes more than the {limit} bytes that are allowed: raise the memory limit if you trust it"
    )]
    TooLarge {
        /// Which file.
        file: String,
        /// How many bytes are allowed.
        limit: u64,
    },
    /// No format goes by this name.
    #[error(
        "{name}: this is not a scene format that can be {wanted}{}; known are {}",
        .nearest.as_ref().map(|n| format!(" (did you mean '{n}'?)")).unwrap_or_default(),
        .known.join(", ")
    )]
    UnknownFormat {
        /// The extension, name or file.
        name: String,
        /// `read` or `written`.
        wanted: &'static str,
        /// The nearest known name, when one is near.
        nearest: Option<String>,
        /// All that are known.
        known: Vec<String>,
    },
    /// A picture stands where a scene should.
    #[error(
        "{name}: this is a picture ({format}), not a scene: name a scene file; a picture can be its surroundings (--env) \
         or a texture in it"
    )]
    IsPicture {
        /// The file.
        name: String,
        /// Which format of pictures it has.
        format: &'static str,
    },
    /// A name or a value in a scene file is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A texture cannot be written.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// Something odd, where strictness was asked for.
    #[error("{0} (with strict reading, warnings are errors)")]
    Strict(Warning),
}

impl FormatError {
    /// The message without the place in front, for warnings, which have their own.
    pub(crate) fn without_place(&self) -> String {
        let text = self.to_string();
        match self {
            FormatError::Malformed { at, .. }
            | FormatError::MissingFile { at, .. }
            | FormatError::Outside { at, .. } => {
                text.strip_prefix(&format!("{at}: ")).map(str::to_owned).unwrap_or(text)
            }
            _ => text,
        }
    }

    pub(crate) fn malformed(message: impl Into<String>, at: Span) -> FormatError {
        FormatError::Malformed { message: message.into(), at }
    }
}
