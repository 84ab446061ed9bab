//! Errors of scene files.

use bilux_pictures::{PictureError, reason};
use bilux_scene::{SceneError, Span, Warning};
use std::path::{Path, PathBuf};

/// Why a scene file cannot be read or written. Every message states what is wrong, where, and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FormatError {
    /// A file cannot be opened, read or written.
    #[error("{}: cannot {action}: {}", .path.display(), reason(.source))]
    Io {
        /// The file.
        path: PathBuf,
        /// The attempted action, such as `open it`.
        action: &'static str,
        /// The operating system's error.
        source: std::io::Error,
    },
    /// The file violates its format.
    #[error("{at}: {message}")]
    Malformed {
        /// Fault, and what to do about it.
        message: String,
        /// Place of the fault.
        at: Span,
    },
    /// A file that another file refers to does not exist.
    #[error("{at}: there is no file '{name}' in {}; put it there, or correct its name", named(.folder))]
    MissingFile {
        /// The name as written.
        name: String,
        /// The folder that was searched.
        folder: PathBuf,
        /// Place of the reference.
        at: Span,
    },
    /// A file that another file refers to lies outside the scene's folder.
    #[error(
        "{at}: '{name}' lies outside the scene's folder, and only files in that folder are opened: copy it there, or \
         allow files outside"
    )]
    Outside {
        /// The name as written.
        name: String,
        /// Place of the reference.
        at: Span,
    },
    /// Reading needs more memory than is allowed.
    #[error(
        "{file}: reading this takes more than the {limit} bytes that are allowed: raise the memory limit if you trust it"
    )]
    TooLarge {
        /// The file.
        file: String,
        /// Number of bytes allowed.
        limit: u64,
        /// Number of bytes that reading had asked for by then; it may need more.
        asked: u64,
    },
    /// No format has this name.
    #[error(
        "{name}: this is not a scene format that can be {wanted}{}; known are {}{}",
        .nearest.as_ref().map(|n| format!(" (did you mean '{n}'?)")).unwrap_or_default(),
        .known.join(", "),
        if *.wanted == "read" { ": export the scene to one of these, such as .glb" } else { "" }
    )]
    UnknownFormat {
        /// The extension, the name or the file.
        name: String,
        /// `read` or `written`.
        wanted: &'static str,
        /// The closest known name, if one is similar.
        nearest: Option<String>,
        /// All known names.
        known: Vec<String>,
    },
    /// The file to write is one that the scene was read from.
    #[error("{}: the scene was read from this file, so it is not overwritten: write to another file", .path.display())]
    IsInput {
        /// The file.
        path: PathBuf,
    },
    /// The file is a picture, not a scene.
    #[error(
        "{name}: this is a picture ({format}), not a scene: name a scene file; a picture can be its surroundings (--env) \
         or a texture in it"
    )]
    IsPicture {
        /// The file.
        name: String,
        /// Picture format of the file.
        format: &'static str,
    },
    /// The file is a picture, in a format that Bilux does not read.
    #[error(
        "{name}: this is {what}, not a scene: name a scene file; to use it as surroundings (--env) or a texture, {advice}"
    )]
    IsForeignPicture {
        /// The file.
        name: String,
        /// Kind of the picture.
        what: &'static str,
        /// Advice on what to do with it.
        advice: &'static str,
    },
    /// The file is in a format of other programs.
    #[error("{name}: this is {what}, which is not a scene that can be read: {advice}")]
    IsForeign {
        /// The file.
        name: String,
        /// Kind of the file.
        what: &'static str,
        /// Advice on what to do with it.
        advice: &'static str,
    },
    /// A name or a value in a scene file is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A texture cannot be written.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A warning, which strict reading turns into an error.
    #[error("{0} (with strict reading, warnings are errors)")]
    Strict(Warning),
}

impl FormatError {
    /// The message without its leading location, for warnings, which have their own.
    pub fn without_place(&self) -> String {
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

    pub fn malformed(message: impl Into<String>, at: Span) -> FormatError {
        FormatError::Malformed { message: message.into(), at }
    }
}

/// A folder as messages name it.
fn named(folder: &Path) -> String {
    let is_current = folder.as_os_str().is_empty() || folder == Path::new(".");
    if is_current { "the current folder".to_owned() } else { folder.display().to_string() }
}
