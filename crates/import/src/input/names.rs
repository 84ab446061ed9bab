//! Names that a file uses and nobody knows.

use crate::FormatError;
use bilux_scene::{SceneError, Span};

/// The error for an unknown name. Names come from untrusted files, so only a few, shortened ones are compared.
pub fn unknown<'n>(
    what: impl Into<String>,
    name: &str,
    known: impl IntoIterator<Item = &'n str>,
    at: &Span,
) -> FormatError {
    const MAX: usize = 100;
    let mut known: Vec<&str> = known.into_iter().filter(|known| known.len() <= MAX).collect();
    known.sort_unstable();
    known.truncate(MAX);
    SceneError::unknown(what, &shortened(name), known, at).into()
}

/// The beginning of a name.
pub fn shortened(name: &str) -> String {
    name.chars().take(60).collect()
}
