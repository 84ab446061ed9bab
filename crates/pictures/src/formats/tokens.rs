//! Words and numbers in the text headers of PNM and PFM.

use crate::PictureError;

/// Iterates over the words of a header; `#` begins a comment that lasts to the end of its line.
pub(super) struct Tokens<'a> {
    format: &'static str,
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Tokens<'a> {
    pub(super) fn new(format: &'static str, bytes: &'a [u8]) -> Tokens<'a> {
        Tokens { format, bytes, at: 0 }
    }

    /// The next word, or an error that names what should have been there.
    pub(super) fn word(&mut self, what: &'static str) -> Result<&'a str, PictureError> {
        self.skip_blank();
        let start = self.at;
        while self.bytes.get(self.at).is_some_and(|byte| !byte.is_ascii_whitespace() && *byte != b'#') {
            self.at += 1;
            if self.at - start > LONGEST_WORD {
                return Err(PictureError::invalid(
                    self.format,
                    format!("the {what} at byte {start} is too long"),
                ));
            }
        }
        if start == self.at {
            return Err(PictureError::truncated(self.format, format!("the {what}")));
        }
        let word = std::str::from_utf8(&self.bytes[start..self.at]);
        word.map_err(|_| {
            PictureError::invalid(self.format, format!("the {what} at byte {start} is not text"))
        })
    }

    /// The next word as an integer.
    pub(super) fn integer(&mut self, what: &'static str) -> Result<u64, PictureError> {
        let word = self.word(what)?;
        let at = self.at - word.len();
        let wrong = || {
            PictureError::invalid(
                self.format,
                format!("the {what} at byte {at} is '{word}', not a whole number"),
            )
        };
        word.parse().map_err(|_| wrong())
    }

    /// The next 0 or 1, which need no whitespace between them (P1).
    pub(super) fn bit(&mut self) -> Result<bool, PictureError> {
        self.skip_blank();
        let bit = match self.bytes.get(self.at) {
            Some(b'0') => false,
            Some(b'1') => true,
            Some(_) => {
                return Err(PictureError::invalid(
                    self.format,
                    format!("the bit at byte {} is neither 0 nor 1", self.at),
                ));
            }
            None => return Err(PictureError::truncated(self.format, "the pixels")),
        };
        self.at += 1;
        Ok(bit)
    }

    /// The bytes after the single whitespace character that ends a binary file's header.
    pub(super) fn binary(mut self) -> Result<&'a [u8], PictureError> {
        match self.bytes.get(self.at) {
            Some(byte) if byte.is_ascii_whitespace() => {
                self.at += 1;
                Ok(&self.bytes[self.at..])
            }
            Some(_) => Err(PictureError::invalid(
                self.format,
                format!("a space should separate the header from the pixels at byte {}", self.at),
            )),
            None => Err(PictureError::truncated(self.format, "the header")),
        }
    }

    fn skip_blank(&mut self) {
        while let Some(byte) = self.bytes.get(self.at) {
            match byte {
                b'#' => {
                    let rest = &self.bytes[self.at..];
                    self.at += rest.iter().position(|b| *b == b'\n' || *b == b'\r').unwrap_or(rest.len());
                }
                byte if byte.is_ascii_whitespace() => self.at += 1,
                _ => break,
            }
        }
    }
}

/// No valid header number is longer.
const LONGEST_WORD: usize = 64;
