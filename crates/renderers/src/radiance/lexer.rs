//! Splits a file into words with their places. `#` begins a comment where a statement may begin, and before a number.

use bilux_import::FormatError;
use bilux_import::bytes::text::Places;
use bilux_scene::Span;
use std::sync::Arc;

/// The words of a file.
pub(super) struct Lexer<'a> {
    bytes: &'a [u8],
    pos: usize,
    places: Places<'a>,
}

/// A word without the quotes around it, and where it begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Word<'a> {
    pub(super) text: &'a [u8],
    pub(super) at: usize,
}

/// Some programs end a text with zeros, or with the mark that CP/M did.
const fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\n' | b'\r' | 0x0b | 0x0c | 0 | 0x1a)
}

impl<'a> Lexer<'a> {
    pub(super) fn new(file: &Arc<str>, bytes: &'a [u8]) -> Lexer<'a> {
        Lexer { bytes, pos: 0, places: Places::new(file, bytes) }
    }

    /// The place of an offset.
    pub(super) fn place(&self, offset: usize) -> Span {
        self.places.at(offset)
    }

    /// An error at an offset.
    pub(super) fn error(&self, message: impl Into<String>, offset: usize) -> FormatError {
        FormatError::malformed(message, self.place(offset))
    }

    /// An upper bound on the words that are left.
    pub(super) fn most_words(&self) -> usize {
        (self.bytes.len() - self.pos).div_ceil(2)
    }

    /// The first byte of the next word, which is not a comment.
    pub(super) fn peek(&mut self) -> Option<u8> {
        self.skip_blanks();
        while self.bytes.get(self.pos) == Some(&b'#') {
            self.rest_of_line();
            self.skip_blanks();
        }
        self.bytes.get(self.pos).copied()
    }

    /// The next word, which may be in quotes of either kind; `None` at the end of the file.
    pub(super) fn word(&mut self) -> Option<Word<'a>> {
        self.skip_blanks();
        let at = self.pos;
        let rest = &self.bytes[at..];
        let first = *rest.first()?;
        let (text, length) = if matches!(first, b'"' | b'\'') {
            let length = rest[1..].iter().position(|&b| b == first).unwrap_or(rest.len() - 1);
            (&rest[1..=length], (length + 2).min(rest.len()))
        } else {
            let length = rest.iter().position(|&b| is_blank(b)).unwrap_or(rest.len());
            (&rest[..length], length)
        };
        self.pos += length;
        Some(Word { text, at })
    }

    /// Next word after comments, as [`Lexer::word`] gives it.
    pub(super) fn word_after_comments(&mut self) -> Option<Word<'a>> {
        self.peek()?;
        self.word()
    }

    /// A line from here, joined with those after it while they end in a backslash.
    pub(super) fn line(&mut self) -> (Vec<u8>, usize) {
        let at = self.pos;
        let mut line = Vec::new();
        loop {
            let part = self.rest_of_line();
            match part.strip_suffix(b"\\") {
                Some(part) if self.pos < self.bytes.len() => {
                    line.extend_from_slice(part);
                    line.push(b' ');
                }
                _ => {
                    line.extend_from_slice(part);
                    return (line, at);
                }
            }
        }
    }

    /// The rest of the line, without its end.
    fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.pos..];
        let length = rest.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(rest.len());
        let is_pair = rest[length..].starts_with(b"\r\n");
        self.pos = (self.pos + length + if is_pair { 2 } else { 1 }).min(self.bytes.len());
        &rest[..length]
    }

    fn skip_blanks(&mut self) {
        while self.bytes.get(self.pos).is_some_and(|&b| is_blank(b)) {
            self.pos += 1;
        }
    }
}
