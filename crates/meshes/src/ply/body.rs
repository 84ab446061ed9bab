//! Reads the numbers of the body in order, in any encoding.

use super::header::{Element, Encoding, Scalar};
use bilux_import::FormatError;
use bilux_import::bytes::float::{parse_f32, parse_f64};
use bilux_import::bytes::text::{Cursor, Places, quoted};
use bilux_import::input::reading::Source;

/// Iterates over the numbers of the body.
pub(super) struct Body<'a> {
    encoding: Encoding,
    /// For a text body.
    cursor: Cursor<'a>,
    /// For a binary body.
    bytes: &'a [u8],
    pos: usize,
    places: &'a Places<'a>,
}

impl<'a> Body<'a> {
    pub(super) fn new(
        source: &Source<'a>,
        places: &'a Places<'a>,
        encoding: Encoding,
        start: usize,
    ) -> Body<'a> {
        let mut cursor = Cursor::new(source.bytes);
        cursor.seek(start);
        Body { encoding, cursor, bytes: source.bytes, pos: start, places }
    }

    /// The offset of the next number.
    pub(super) fn offset(&self) -> usize {
        if self.encoding == Encoding::Ascii { self.cursor.offset() } else { self.pos }
    }

    /// An error if an element claims more rows than the file can hold.
    pub(super) fn check_claim(&self, element: &Element) -> Result<(), FormatError> {
        let least = element.least_bytes(self.encoding);
        let left = (self.bytes.len() - self.offset()) as u64 + 1;
        match element.count.checked_mul(least) {
            Some(needed) if needed <= left => Ok(()),
            _ => {
                let message = format!(
                    "the header says {} of the element '{}', of {least} bytes or more each, but only {} bytes are left: \
                     the file was cut off, or its header is wrong",
                    element.count,
                    element.name,
                    left - 1
                );
                Err(FormatError::malformed(message, self.places.at(element.offset)))
            }
        }
    }

    /// Reads the next number.
    #[inline]
    pub(super) fn number(&mut self, scalar: Scalar) -> Result<f32, FormatError> {
        if self.encoding == Encoding::Ascii {
            let word = self.word()?;
            return parse_f32(word).ok_or_else(|| self.bad_word(word, "number"));
        }
        let big = self.encoding == Encoding::Big;
        macro_rules! take {
            ($type:ty) => {{
                let bytes = self.take::<{ size_of::<$type>() }>()?;
                (if big { <$type>::from_be_bytes(bytes) } else { <$type>::from_le_bytes(bytes) }) as f32
            }};
        }
        Ok(match scalar {
            Scalar::I8 => take!(i8),
            Scalar::U8 => take!(u8),
            Scalar::I16 => take!(i16),
            Scalar::U16 => take!(u16),
            Scalar::I32 => take!(i32),
            Scalar::U32 => take!(u32),
            Scalar::F32 => take!(f32),
            Scalar::F64 => take!(f64),
        })
    }

    /// Reads the next number with all of its digits.
    pub(super) fn wide_number(&mut self, scalar: Scalar) -> Result<f64, FormatError> {
        match (self.encoding, scalar) {
            (Encoding::Ascii, _) => {
                let word = self.word()?;
                parse_f64(word).ok_or_else(|| self.bad_word(word, "number"))
            }
            (Encoding::Little, Scalar::F64) => Ok(f64::from_le_bytes(self.take()?)),
            (Encoding::Big, Scalar::F64) => Ok(f64::from_be_bytes(self.take()?)),
            _ => self.number(scalar).map(f64::from),
        }
    }

    /// Reads the next number as an index or a count; negative ones such as -1 are kept.
    #[inline]
    pub(super) fn integer(&mut self, scalar: Scalar) -> Result<i64, FormatError> {
        if self.encoding == Encoding::Ascii {
            let word = self.word()?;
            let value = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok());
            // Some exporters write indices as 12.0.
            let whole = || parse_f32(word).filter(|x| x.fract() == 0.0 && x.abs() < 1e7).map(|x| x as i64);
            return value.or_else(whole).ok_or_else(|| self.bad_word(word, "whole number"));
        }
        let big = self.encoding == Encoding::Big;
        macro_rules! take {
            ($type:ty) => {{
                let bytes = self.take::<{ size_of::<$type>() }>()?;
                i64::from(if big { <$type>::from_be_bytes(bytes) } else { <$type>::from_le_bytes(bytes) })
            }};
        }
        Ok(match scalar {
            Scalar::I8 => take!(i8),
            Scalar::U8 => take!(u8),
            Scalar::I16 => take!(i16),
            Scalar::U16 => take!(u16),
            Scalar::I32 => take!(i32),
            Scalar::U32 => take!(u32),
            Scalar::F32 | Scalar::F64 => self.number(scalar)? as i64,
        })
    }

    /// True for a little-endian binary body.
    pub(super) fn is_little(&self) -> bool {
        self.encoding == Encoding::Little
    }

    /// The unread bytes of a binary body.
    pub(super) fn rest(&self) -> &'a [u8] {
        &self.bytes[self.pos..]
    }

    /// Advances by this many bytes, which must exist.
    pub(super) fn pass(&mut self, bytes: usize) {
        self.pos += bytes;
    }

    /// Skips numbers.
    pub(super) fn skip(&mut self, scalar: Scalar, count: i64) -> Result<(), FormatError> {
        if self.encoding == Encoding::Ascii {
            return (0..count).try_for_each(|_| self.word().map(|_| ()));
        }
        let end = u64::try_from(count).ok().and_then(|n| n.checked_mul(scalar.size() as u64));
        let end =
            end.and_then(|n| n.checked_add(self.pos as u64)).filter(|&end| end <= self.bytes.len() as u64);
        self.pos = end.ok_or_else(|| self.cut_off())? as usize;
        Ok(())
    }

    /// Ends a row; true if a text row had more words than the header declares.
    pub(super) fn end_row(&mut self) -> bool {
        if self.encoding != Encoding::Ascii {
            return false;
        }
        let more = !self.cursor.peek_word().is_empty();
        self.cursor.rest_of_line();
        self.cursor.end_line();
        more
    }

    #[inline]
    fn take<const N: usize>(&mut self) -> Result<[u8; N], FormatError> {
        match self.bytes[self.pos..].first_chunk::<N>() {
            Some(chunk) => {
                self.pos += N;
                Ok(*chunk)
            }
            None => Err(self.cut_off()),
        }
    }

    /// The next word, on this line or a later one.
    #[inline]
    fn word(&mut self) -> Result<&'a [u8], FormatError> {
        loop {
            let word = self.cursor.word();
            // No number: writers put comments there, as the header has them.
            if word == b"comment" || word == b"obj_info" {
                self.cursor.rest_of_line();
            } else if !word.is_empty() {
                return Ok(word);
            }
            if self.cursor.is_done() {
                return Err(self.cut_off());
            }
            self.cursor.end_line();
        }
    }

    #[cold]
    fn cut_off(&self) -> FormatError {
        let message = "the file ends before everything that its header promises: it was cut off, or its header is \
                       wrong";
        let at = if self.encoding == Encoding::Ascii {
            self.places.at(self.bytes.len())
        } else {
            self.places.whole()
        };
        FormatError::malformed(message, at)
    }

    #[cold]
    fn bad_word(&self, word: &[u8], wanted: &str) -> FormatError {
        let at = self.places.at(self.cursor.offset() - word.len());
        FormatError::malformed(format!("{} is not a {wanted}, which is expected here", quoted(word)), at)
    }
}
