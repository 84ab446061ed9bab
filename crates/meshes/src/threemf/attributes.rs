//! The attributes of an element, and the types of their values.

use bilux_import::bytes::float::{parse_f32, parse_f64};
use bilux_math::DMat4;
use bilux_math::glam::DVec4;
use std::borrow::Cow;

/// Names and values in order. An error stands for text that is no attribute; it is the last.
#[derive(Clone)]
pub(super) struct Attributes<'x> {
    rest: &'x str,
}

/// Text that is no attribute.
#[derive(Clone, Copy, Debug)]
pub(super) struct NoAttribute;

impl<'x> Attributes<'x> {
    pub(super) fn of(raw: &'x str) -> Attributes<'x> {
        Attributes { rest: raw }
    }

    #[inline]
    fn split(&self) -> Option<(&'x str, &'x str, &'x str)> {
        let bytes = self.rest.as_bytes();
        let sign = bytes.iter().position(|&b| b == b'=')?;
        let name = self.rest[..sign].trim_ascii_end();
        let mut open = sign + 1;
        while bytes.get(open)?.is_ascii_whitespace() {
            open += 1;
        }
        let quote = *bytes.get(open).filter(|&&b| b == b'"' || b == b'\'')?;
        let length = bytes[open + 1..].iter().position(|&b| b == quote)?;
        let close = open + 1 + length;
        (!name.is_empty()).then(|| (name, &self.rest[open + 1..close], &self.rest[close + 1..]))
    }
}

impl<'x> Iterator for Attributes<'x> {
    type Item = Result<(&'x str, &'x str), NoAttribute>;

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        self.rest = self.rest.trim_ascii_start();
        if self.rest.is_empty() {
            return None;
        }
        let Some((name, value, rest)) = self.split() else {
            self.rest = "";
            return Some(Err(NoAttribute));
        };
        self.rest = rest;
        Some(Ok((name, value)))
    }
}

/// A number that is not negative.
#[inline]
pub(super) fn integer(text: &str) -> Option<u32> {
    digits(text.trim_ascii().as_bytes())
}

/// A number that is not negative, without blanks around it.
#[inline]
pub(super) fn digits(digits: &[u8]) -> Option<u32> {
    if digits.is_empty() || digits.len() > 10 {
        return None;
    }
    let mut number = 0u64;
    for digit in digits {
        number = number * 10 + u64::from(digit.checked_sub(b'0').filter(|&d| d < 10)?);
    }
    u32::try_from(number).ok().filter(|&number| number <= i32::MAX as u32)
}

/// A number.
#[inline]
pub(super) fn number(text: &str) -> Option<f32> {
    parse_f32(text.trim_ascii().as_bytes())
}

/// Text with its references replaced.
pub(super) fn unescaped(text: &str) -> Cow<'_, str> {
    quick_xml::escape::unescape(text).unwrap_or(Cow::Borrowed(text))
}

/// The transform of twelve numbers: row vectors are multiplied by the matrix from the left. [3MF Core 1.3, 3.3]
pub(super) fn matrix(text: &str) -> Option<DMat4> {
    let words =
        text.split_ascii_whitespace().map(|word| parse_f64(word.as_bytes()).filter(|x| x.is_finite()));
    let all: Vec<f64> = words.collect::<Option<_>>()?;
    let rows: &[f64; 12] = all.as_slice().try_into().ok()?;
    let image = |row: usize, w: f64| DVec4::new(rows[3 * row], rows[3 * row + 1], rows[3 * row + 2], w);
    Some(DMat4::from_cols(image(0, 0.0), image(1, 0.0), image(2, 0.0), image(3, 1.0)))
}
