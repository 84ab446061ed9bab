//! Choice by the user among the things of a file.

use crate::FormatError;
use bilux_scene::Span;
use bilux_scene::error::nearest_name;

/// The index of an item that the user selected by name or by number, from 0.
pub fn named_or_numbered(
    what: &str,
    wanted: &str,
    names: &[String],
    at: &Span,
) -> Result<usize, FormatError> {
    let numbered = || wanted.parse().ok().filter(|&i: &usize| i < names.len());
    names.iter().position(|name| name == wanted).or_else(numbered).ok_or_else(|| {
        let nearest =
            nearest_name(wanted, names).map_or_else(String::new, |name| format!(" (did you mean {name}?)"));
        let known = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
        FormatError::malformed(
            format!("there is no {what} '{wanted}' in this file{nearest}; there are: {known}"),
            at.clone(),
        )
    })
}
