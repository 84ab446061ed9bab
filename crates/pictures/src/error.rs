//! Errors of pictures.

use std::path::{Path, PathBuf};

/// Why a picture cannot be read, written, created or compared.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// Something is wrong with this file.
    #[error("{}: {source}", path.display())]
    InFile {
        /// The file.
        path: PathBuf,
        /// The error in the file.
        source: Box<PictureError>,
    },
    /// The operating system reported an error.
    #[error("cannot {action}: {}", reason(source))]
    Io {
        /// The attempted action, a verb with its object.
        action: &'static str,
        /// Why it failed.
        source: std::io::Error,
    },
    /// No picture format has this name or extension.
    #[error(
        "{} that can be {verb}{}; known are: {known}",
        format_in_question(name),
        did_you_mean(suggestion)
    )]
    UnknownFormat {
        /// The requested name.
        name: String,
        /// `read` or `written`.
        verb: &'static str,
        /// The closest existing name.
        suggestion: Option<&'static str>,
        /// All existing names.
        known: String,
    },
    /// A table has no row of this name.
    #[error("there is no {kind} '{name}'{}; known are: {known}", did_you_mean(suggestion))]
    UnknownName {
        /// The kind of table.
        kind: &'static str,
        /// The requested name.
        name: String,
        /// The closest existing name.
        suggestion: Option<&'static str>,
        /// All existing names.
        known: String,
    },
    /// The bytes do not look like any known picture format.
    #[error("this is not a picture in a known format; known are: {known}")]
    Unrecognised {
        /// All existing names.
        known: String,
    },
    /// The file is in a format that other programs read.
    #[error("this is {what}{}: {advice}; picture formats that can be read are: {known}", if *is_picture { "" } else { ", not a picture" })]
    Foreign {
        /// Kind of the file, such as `a GIF picture`.
        what: &'static str,
        /// Whether it is a picture.
        is_picture: bool,
        /// Advice on using the file.
        advice: &'static str,
        /// The names of the formats that can be read.
        known: String,
    },
    /// The picture has no such layer, or no main picture.
    #[error("{}", no_layer(name.as_deref(), known))]
    NoLayer {
        /// The requested layer; `None` for the main picture.
        name: Option<String>,
        /// The layers with colours.
        known: Vec<String>,
    },
    /// The file violates the rules of its format.
    #[error("{format}: {what}: the file is damaged or was written wrongly; save it again")]
    Invalid {
        /// The format.
        format: &'static str,
        /// Which rule, and the values in question.
        what: String,
    },
    /// The file ends too early.
    #[error("{format}: the file ends in the middle of {part}: it was cut short; copy it or save it again")]
    Truncated {
        /// The format.
        format: &'static str,
        /// The part that was being read.
        part: String,
    },
    /// The file is valid, but uses a feature that is not supported.
    #[error("{format}: {what} is not supported; {advice}")]
    Unsupported {
        /// The format.
        format: &'static str,
        /// The feature that the file uses.
        what: String,
        /// Advice on an alternative.
        advice: &'static str,
    },
    /// The picture would take more memory than the limit allows.
    #[error(
        "{format}: {width} x {height} pixels need {}, and the limit is {limit}: raise the memory limit if you trust the file",
        bytes_in_words(*needed)
    )]
    TooLarge {
        /// The format.
        format: &'static str,
        /// Width in pixels.
        width: u64,
        /// Height in pixels.
        height: u64,
        /// Bytes that decoding would take; `u64::MAX` if even that overflows.
        needed: u64,
        /// The limit in bytes.
        limit: u64,
    },
    /// The file has more bytes than the limit allows.
    #[error("the file has more than the limit of {limit} bytes: raise the memory limit if you trust it")]
    FileTooLarge {
        /// The limit in bytes.
        limit: u64,
    },
    /// The machine has no memory left.
    #[error("{format}: cannot allocate {bytes} bytes; free some memory or make the picture smaller")]
    OutOfMemory {
        /// The format or operation.
        format: &'static str,
        /// Number of bytes requested.
        bytes: u64,
    },
    /// The picture cannot be stored in this format.
    #[error("{format} cannot hold this picture: {what}")]
    Unwritable {
        /// The format.
        format: &'static str,
        /// The feature that the format cannot hold, or that it needs and the picture lacks, and advice.
        what: String,
    },
    /// The requested denoiser is not available, or does not work.
    #[error("cannot denoise: {what}")]
    NoDenoiser {
        /// The missing part, and how to get it; or the failure.
        what: String,
    },
    /// A picture was assembled incorrectly.
    #[error("{0}")]
    Malformed(String),
    /// Two pictures that should have the same size do not.
    #[error("the pictures differ in size: {} x {} and {} x {} pixels; render or crop them to one size", a.0, a.1, b.0, b.1)]
    SizesDiffer {
        /// Width and height of the first.
        a: (usize, usize),
        /// Width and height of the second.
        b: (usize, usize),
    },
}

impl PictureError {
    /// Bytes that a limit must allow for this picture to be read, and those that it allows; `None` for other errors.
    pub fn bytes_needed(&self) -> Option<[u64; 2]> {
        match self {
            PictureError::InFile { source, .. } => source.bytes_needed(),
            PictureError::TooLarge { needed, limit, .. } => Some([*needed, *limit]),
            _ => None,
        }
    }

    pub(crate) fn invalid(format: &'static str, what: impl Into<String>) -> PictureError {
        PictureError::Invalid { format, what: what.into() }
    }

    pub(crate) fn truncated(format: &'static str, part: impl Into<String>) -> PictureError {
        PictureError::Truncated { format, part: part.into() }
    }

    /// This error with the file that caused it.
    pub fn in_file(self, path: &Path) -> PictureError {
        match self {
            PictureError::InFile { .. } => self,
            source => PictureError::InFile { path: path.to_owned(), source: Box::new(source) },
        }
    }
}

/// The reason given by the operating system, without its number.
pub fn reason(error: &std::io::Error) -> String {
    let text = error.to_string();
    match text.find(" (os error") {
        Some(end) => text[..end].to_owned(),
        None => text,
    }
}

fn bytes_in_words(bytes: u64) -> String {
    if bytes == u64::MAX { "more bytes than any machine has".to_owned() } else { format!("{bytes} bytes") }
}

fn no_layer(name: Option<&str>, known: &[String]) -> String {
    let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
    match name {
        Some(name) => format!(
            "there is no layer '{name}' with colours in this picture; its layers with colours are: {known}"
        ),
        None => format!(
            "the picture has no channels R, G and B, or Y, outside of its layers: choose one of its layers with colours \
             (--layer NAME, or 'layer' of a texture): {known}"
        ),
    }
}

/// A name without an extension does not name a format.
fn format_in_question(name: &str) -> String {
    match name {
        "" => "the name has no extension of a picture format".to_owned(),
        name => format!("'{name}' is not a picture format"),
    }
}

fn did_you_mean(suggestion: &Option<&'static str>) -> String {
    suggestion.map(|name| format!(" (did you mean '{name}'?)")).unwrap_or_default()
}

/// The name closest to `given`, unless all are too different.
pub(crate) fn nearest(given: &str, names: impl Iterator<Item = &'static str>) -> Option<&'static str> {
    let given = given.to_lowercase();
    names
        .map(|name| (strsim::damerau_levenshtein(&given, name), name))
        .filter(|&(distance, name)| distance <= (name.len().max(given.len()) / 2).clamp(1, 3))
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, name)| name)
}
