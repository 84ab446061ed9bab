//! The values of a node, one after the other.

use super::arrays::{Elements, PackedArray};
use super::records::Encoding;
use bilux_import::bytes::float::parse_f64;

/// A value of a node.
#[derive(Clone, Copy, Debug)]
pub(in crate::fbx) enum Value<'a> {
    Integer(i64),
    Number(f64),
    /// A text without its quotes, or bytes.
    Text(&'a [u8]),
    /// A word without quotes, such as `Y`.
    Word(&'a [u8]),
    Array(PackedArray<'a>),
    /// The number of elements of an array that follows as a node.
    Length,
}

impl<'a> Value<'a> {
    /// The value as a number; a word may be one in the spelling of some library.
    pub(in crate::fbx) fn number(self) -> Option<f64> {
        match self {
            Value::Integer(integer) => Some(integer as f64),
            Value::Number(number) => Some(number),
            Value::Word(word) => parse_f64(word).or_else(|| not_finite(word)),
            _ => None,
        }
    }

    pub(in crate::fbx) fn integer(self) -> Option<i64> {
        match self {
            Value::Integer(integer) => Some(integer),
            // The conversion saturates.
            Value::Number(number) if number.is_finite() => Some(number as i64),
            _ => None,
        }
    }

    pub(in crate::fbx) fn text(self) -> Option<&'a [u8]> {
        match self {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }
}

/// A number from what C libraries print for numbers that are none: `1.#QNAN`, `-1.#IND`, `nan(ind)`, `1.#INF`.
fn not_finite(word: &[u8]) -> Option<f64> {
    let text = String::from_utf8_lossy(word).to_lowercase();
    let has = |part: &str| text.contains(part);
    match () {
        () if has("nan") || has("ind") => Some(f64::NAN),
        () if has("inf") => Some(if text.starts_with('-') { f64::NEG_INFINITY } else { f64::INFINITY }),
        () => None,
    }
}

/// Decodes values one by one; ends at what is broken.
#[derive(Clone, Copy, Debug)]
pub(in crate::fbx) struct Values<'a> {
    rest: &'a [u8],
    encoding: Encoding,
}

impl<'a> Values<'a> {
    pub(super) fn new(bytes: &'a [u8], encoding: Encoding) -> Values<'a> {
        Values { rest: bytes, encoding }
    }

    /// At least as many as there are.
    pub(super) fn most(&self) -> usize {
        match self.encoding {
            Encoding::Text => 1 + self.rest.iter().filter(|&&byte| byte == b',').count(),
            // The smallest is a byte and its type.
            Encoding::Binary { .. } => match self.rest.first() {
                Some(b'D' | b'L') => self.rest.len() / 9 + 1,
                Some(b'I' | b'F') => self.rest.len() / 5 + 1,
                _ => self.rest.len() / 2,
            },
        }
    }

    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let taken = self.rest.get(..count)?;
        self.rest = &self.rest[count..];
        Some(taken)
    }

    fn bytes<const N: usize>(&mut self, is_big_endian: bool) -> Option<[u8; N]> {
        let mut bytes: [u8; N] = self.take(N)?.try_into().ok()?;
        if is_big_endian {
            bytes.reverse();
        }
        Some(bytes)
    }

    fn next_binary(&mut self, big: bool) -> Option<Value<'a>> {
        let [kind] = self.bytes(false)?;
        Some(match kind {
            b'C' | b'B' | b'Z' => Value::Integer(i64::from(i8::from_le_bytes(self.bytes(big)?))),
            b'Y' => Value::Integer(i64::from(i16::from_le_bytes(self.bytes(big)?))),
            b'I' => Value::Integer(i64::from(i32::from_le_bytes(self.bytes(big)?))),
            b'L' => Value::Integer(i64::from_le_bytes(self.bytes(big)?)),
            b'F' => Value::Number(f64::from(f32::from_le_bytes(self.bytes(big)?))),
            b'D' => Value::Number(f64::from_le_bytes(self.bytes(big)?)),
            b'S' | b'R' => {
                let length = u32::from_le_bytes(self.bytes(big)?);
                Value::Text(self.take(length as usize)?)
            }
            kind => {
                let elements = Elements::named(kind)?;
                let [count, packing, size] =
                    [self.bytes(big)?, self.bytes(big)?, self.bytes(big)?].map(u32::from_le_bytes);
                let is_packed = packing != 0;
                let length = if is_packed { size as usize } else { count as usize * elements.size() };
                // A list that is shorter than it says is an error where it is used.
                let bytes = self.take(length.min(self.rest.len()))?;
                Value::Array(PackedArray { elements, count, is_packed, is_big_endian: big, bytes })
            }
        })
    }

    fn next_text(&mut self) -> Option<Value<'a>> {
        loop {
            match *self.rest.first()? {
                b';' => {
                    let end = self.rest.iter().position(|&byte| byte == b'\n');
                    self.take(end.unwrap_or(self.rest.len()))?;
                }
                b',' => self.rest = &self.rest[1..],
                byte if byte.is_ascii_whitespace() => self.rest = &self.rest[1..],
                b'"' => {
                    let inside = &self.rest[1..];
                    let end = inside.iter().position(|&byte| byte == b'"').unwrap_or(inside.len());
                    self.rest = inside.get(end + 1..).unwrap_or_default();
                    return Some(Value::Text(&inside[..end]));
                }
                _ => break,
            }
        }
        let is_end = |byte: &u8| matches!(byte, b',' | b';' | b'"') || byte.is_ascii_whitespace();
        let length = self.rest.iter().position(is_end).unwrap_or(self.rest.len());
        let word = self.take(length)?;
        if word.starts_with(b"*") {
            return Some(Value::Length);
        }
        if let Some(integer) = integer(word) {
            return Some(Value::Integer(integer));
        }
        let number = std::str::from_utf8(word).ok().filter(|_| !word[0].is_ascii_alphabetic());
        Some(number.and_then(|text| text.parse().ok()).map_or(Value::Word(word), Value::Number))
    }
}

/// A whole number, if these bytes are one.
fn integer(word: &[u8]) -> Option<i64> {
    let (is_negative, digits) = match word {
        [b'-', digits @ ..] => (true, digits),
        digits => (false, digits),
    };
    if digits.is_empty() || digits.len() > 18 {
        return std::str::from_utf8(word).ok()?.parse().ok();
    }
    let mut sum = 0i64;
    for byte in digits {
        if !byte.is_ascii_digit() {
            return None;
        }
        sum = sum * 10 + i64::from(byte - b'0');
    }
    // There is no negative zero among integers.
    (!is_negative || sum != 0).then_some(if is_negative { -sum } else { sum })
}

impl<'a> Iterator for Values<'a> {
    type Item = Value<'a>;

    #[inline]
    fn next(&mut self) -> Option<Value<'a>> {
        match self.encoding {
            Encoding::Text => self.next_text(),
            Encoding::Binary { is_big_endian } => self.next_binary(is_big_endian),
        }
    }
}
