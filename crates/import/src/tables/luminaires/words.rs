//! Words and lines of files of luminaires, with their places.

use crate::FormatError;
use crate::bytes::text::{Places, quoted, whole_file};
use crate::input::reading::Source;

/// Reads a file from its beginning: lines, or numbers wherever lines end.
pub(super) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Place where the last line or word began.
    began: usize,
    source: Source<'a>,
}

impl<'a> Words<'a> {
    pub(super) fn new(source: &Source<'a>) -> Words<'a> {
        Words { bytes: source.bytes, at: 0, began: 0, source: *source }
    }

    /// The bytes that are left.
    pub(super) fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// The next line without its end, which may be that of any system; `None` at the end of the file.
    pub(super) fn line(&mut self) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.at..];
        if rest.is_empty() {
            return None;
        }
        self.began = self.at;
        let end = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r')).unwrap_or(rest.len());
        let is_pair = rest[end..].starts_with(b"\r\n");
        self.at += (end + 1 + usize::from(is_pair)).min(rest.len());
        Some(rest[..end].trim_ascii())
    }

    /// The next word, on this line or a later one; empty at the end of the file. Commas are blanks.
    fn word(&mut self) -> &'a [u8] {
        let is_blank = |byte: &u8| byte.is_ascii_whitespace() || matches!(byte, b',' | b'\0' | b'\x1a');
        let rest = &self.bytes[self.at..];
        let begin = rest.iter().position(|byte| !is_blank(byte)).unwrap_or(rest.len());
        let length = rest[begin..].iter().position(is_blank).unwrap_or(rest.len() - begin);
        self.began = self.at + begin;
        self.at = self.began + length;
        &rest[begin..begin + length]
    }

    /// The next number.
    pub(super) fn number(&mut self, what: &str) -> Result<f64, FormatError> {
        let word = self.word();
        if word.is_empty() {
            return Err(self.wrong(format!("the file ends before {what}: it is cut off")));
        }
        number_of(word).ok_or_else(|| self.wrong(format!("{} is no number: here is {what}", quoted(word))))
    }

    /// The next number, which is whole and within bounds.
    pub(super) fn count(&mut self, what: &str, [least, most]: [usize; 2]) -> Result<usize, FormatError> {
        let number = self.number(what)?;
        self.whole(number, what, [least, most])
    }

    /// The next numbers. Each takes two bytes of the file at least, so that a count cannot ask for more memory than the file justifies.
    pub(super) fn numbers(&mut self, count: usize, what: &str) -> Result<Vec<f64>, FormatError> {
        if count > self.left().div_ceil(2) {
            let message = format!("the file ends before {what}, of which there are {count}: it is cut off");
            return Err(self.wrong(message));
        }
        let what = format!("one of the {count} {what}");
        (0..count).map(|_| self.number(&what)).collect()
    }

    /// The number of the next line.
    pub(super) fn number_of_line(&mut self, what: &str) -> Result<f64, FormatError> {
        let line = self.line().ok_or_else(|| {
            self.began = self.at;
            self.wrong(format!("the file ends before {what}: it is cut off"))
        })?;
        number_of(line).ok_or_else(|| self.wrong(format!("{} is no number: here is {what}", quoted(line))))
    }

    /// The whole number of the next line, within bounds.
    pub(super) fn count_of_line(
        &mut self,
        what: &str,
        [least, most]: [usize; 2],
    ) -> Result<usize, FormatError> {
        let number = self.number_of_line(what)?;
        self.whole(number, what, [least, most])
    }

    fn whole(&self, number: f64, what: &str, [least, most]: [usize; 2]) -> Result<usize, FormatError> {
        if number.fract() == 0.0 && (least as f64..=most as f64).contains(&number) {
            return Ok(number as usize);
        }
        Err(self.wrong(format!("{number} for {what}, which is a whole number from {least} to {most}")))
    }

    /// An error at the last line or word.
    pub(super) fn wrong(&self, message: impl Into<String>) -> FormatError {
        FormatError::malformed(message, Places::new(self.source.name, self.bytes).at(self.began))
    }

    /// An error of the whole file.
    pub(super) fn wrong_file(&self, message: impl Into<String>) -> FormatError {
        FormatError::malformed(message, whole_file(self.source.name))
    }
}

/// A finite number; some programs write a comma for the point.
fn number_of(word: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(word).ok()?.trim();
    let number = text.parse().or_else(|_| text.replacen(',', ".", 1).parse());
    number.ok().filter(|x: &f64| x.is_finite())
}

/// Text of a file in UTF-8, or else in Latin-1, without what cannot be shown.
pub(super) fn text_of(bytes: &[u8]) -> String {
    const LONGEST: usize = 200;
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|byte| char::from(*byte)).collect(),
    };
    text.trim().chars().filter(|c| !c.is_control()).take(LONGEST).collect()
}
