//! The values of an element's attributes, by type.

use super::attributes::{integer, matrix, number, unescaped};
use super::xml::Element;
use bilux_import::FormatError;
use bilux_import::bytes::text::quoted;
use bilux_math::DMat4;
use std::borrow::Cow;

impl<'x> Element<'x> {
    /// A number that counts from 0.
    pub(super) fn index(&self, name: &str) -> Result<Option<u32>, FormatError> {
        let Some(text) = self.get(name) else { return Ok(None) };
        integer(text).map(Some).ok_or_else(|| self.wrong(name, text, "a whole number from 0 on"))
    }

    /// A number that counts from 0, of an attribute that has to be there.
    pub(super) fn need_index(&self, name: &str) -> Result<u32, FormatError> {
        self.need(name)?;
        self.index(name).map(Option::unwrap_or_default)
    }

    pub(super) fn number(&self, name: &str) -> Result<Option<f32>, FormatError> {
        let Some(text) = self.get(name) else { return Ok(None) };
        number(text).filter(|x| x.is_finite()).map(Some).ok_or_else(|| self.wrong(name, text, "a number"))
    }

    pub(super) fn need_number(&self, name: &str) -> Result<f32, FormatError> {
        self.need(name)?;
        self.number(name).map(Option::unwrap_or_default)
    }

    /// A list of numbers that count from 0.
    pub(super) fn indices(&self, name: &str) -> Result<Vec<u32>, FormatError> {
        let text = self.need(name)?;
        let words = text.split_ascii_whitespace().map(integer);
        words.collect::<Option<_>>().ok_or_else(|| self.wrong(name, text, "a list of whole numbers"))
    }

    /// A list of numbers.
    pub(super) fn numbers(&self, name: &str) -> Result<Vec<f32>, FormatError> {
        let text = self.need(name)?;
        let words = text.split_ascii_whitespace().map(|word| number(word).filter(|x| x.is_finite()));
        words.collect::<Option<_>>().ok_or_else(|| self.wrong(name, text, "a list of numbers"))
    }

    /// Text with its references replaced; empty if there is none.
    pub(super) fn words(&self, name: &str) -> Cow<'x, str> {
        unescaped(self.get(name).unwrap_or_default())
    }

    /// A transform: the three columns of twelve numbers, of which the rows are images of the axes and of the origin.
    pub(super) fn transform(&self) -> Result<DMat4, FormatError> {
        let Some(text) = self.get("transform") else { return Ok(DMat4::IDENTITY) };
        matrix(text).ok_or_else(|| self.wrong("transform", text, "twelve numbers"))
    }

    /// The error for the value of an attribute.
    pub(super) fn wrong(&self, name: &str, text: &str, wanted: &str) -> FormatError {
        self.error(format!("'{}' has {name}={}, but needs {wanted}", self.name, quoted(text.as_bytes())))
    }
}
