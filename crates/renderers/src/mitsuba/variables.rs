//! Variables such as `$spp`: their defaults, and the values that the user gives.

use bilux_import::FormatError;
use bilux_import::input::names::{shortened, unknown};
use bilux_scene::Span;
use std::collections::BTreeMap;

/// The most bytes that the values of variables may add to an attribute.
const MAX_TEXT: usize = 1 << 16;

/// The variables so far.
pub(super) struct Variables {
    values: BTreeMap<String, String>,
    /// Variables that the user gives, and whether the file uses them.
    given: BTreeMap<String, bool>,
}

impl Variables {
    /// With the values that the user gives.
    pub(super) fn new(given: &[(String, String)]) -> Variables {
        let values = given.iter().cloned().collect();
        Variables { values, given: given.iter().map(|(name, _)| (name.clone(), false)).collect() }
    }

    /// Gives a value to a variable that has none.
    pub(super) fn default(&mut self, name: &str, value: String) {
        if let Some(is_used) = self.given.get_mut(name) {
            *is_used = true;
        }
        self.values.entry(name.to_owned()).or_insert(value);
    }

    /// A text with values in place of variables, the longest name that fits first.
    pub(super) fn replaced(&mut self, text: &str, at: &dyn Fn() -> Span) -> Result<String, FormatError> {
        if !text.contains('$') {
            return Ok(text.to_owned());
        }
        let (mut rest, mut whole) = (text, String::new());
        while let Some((before, after)) = rest.split_once('$') {
            whole.push_str(before);
            let fits = self.values.iter().filter(|(name, _)| after.starts_with(name.as_str()));
            let Some((name, value)) = fits.max_by_key(|(name, _)| name.len()) else {
                let end = after.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(after.len());
                let names = self.values.keys().map(String::as_str);
                return Err(unknown("variable", &after[..end], names, &at()));
            };
            whole.push_str(value);
            if whole.len() > text.len() + MAX_TEXT {
                return Err(FormatError::malformed("the values of variables are too long here", at()));
            }
            if let Some(is_used) = self.given.get_mut(name) {
                *is_used = true;
            }
            rest = &after[name.len()..];
        }
        whole.push_str(rest);
        Ok(whole)
    }

    /// An error if the user gives a variable that the file does not have.
    pub(super) fn check_used(&self, at: &Span) -> Result<(), FormatError> {
        let Some((name, _)) = self.given.iter().find(|(_, is_used)| !**is_used) else { return Ok(()) };
        let known = self.values.keys().filter(|known| *known != name).map(String::as_str);
        let known: Vec<&str> = known.collect();
        if known.is_empty() {
            let message = format!("there is no variable '{}': this scene has none", shortened(name));
            return Err(FormatError::malformed(message, at.clone()));
        }
        Err(unknown("variable", name, known, at))
    }
}
