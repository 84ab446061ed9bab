//! Exact conversion of decimal numbers: text to the nearest f32, and f32 to the shortest text.

use std::io::Write;

/// The f32 nearest to a decimal number; `nan`, `inf` and C compilers' spellings of them count as numbers, and so do
/// decimal commas (1,5) and Fortran's exponents (1.5D+01).
///
/// If the digits and the power of ten are exact in an f64, one rounding gives the nearest f64 [Clinger 1990].
/// Rounding that to f32 gives the f32 nearest to the decimal, unless the f64 lies exactly midway between two f32s.
/// The standard library handles all other cases.
#[inline]
pub fn parse_f32(word: &[u8]) -> Option<f32> {
    match quick(word) {
        Some(value) => Some(value),
        None => thorough(word),
    }
}

/// The f64 nearest to a decimal number; for coordinates that are large compared with their differences.
pub fn parse_f64(word: &[u8]) -> Option<f64> {
    // A word that is not a number to `parse_f32` is not a number here either.
    parse_f32(word)?;
    let text = std::str::from_utf8(word).ok()?;
    text.parse().ok().or_else(|| localised(text)?.parse().ok()).or_else(|| parse_f32(word).map(f64::from))
}

/// A coordinate relative to that of an origin, with all of its digits.
#[inline]
pub fn parse_relative(word: &[u8], origin: f64) -> Option<f32> {
    if origin == 0.0 { parse_f32(word) } else { parse_f64(word).map(|number| (number - origin) as f32) }
}

const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

#[inline]
fn quick(word: &[u8]) -> Option<f32> {
    let (negative, mut rest) = match word {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, word),
    };
    // 19 digits cannot overflow.
    if rest.len() > 19 {
        return None;
    }
    let mut mantissa = 0;
    let mut digits = leading_digits(rest, &mut mantissa);
    rest = &rest[digits..];
    let mut power = 0;
    if let [b'.', tail @ ..] = rest {
        let places = leading_digits(tail, &mut mantissa);
        rest = &tail[places..];
        digits += places;
        power = -(places as i32);
    }
    match rest {
        [] => {}
        [b'e' | b'E', exponent @ ..] => power += small_integer(exponent)?,
        _ => return None,
    }
    if digits == 0 || digits > 18 || mantissa >= 1 << 53 {
        return None;
    }
    let scale = *POWERS.get(power.unsigned_abs() as usize)?;
    let value = if power < 0 { mantissa as f64 / scale } else { mantissa as f64 * scale };
    let between = value.to_bits() & ((1 << 29) - 1) == 1 << 28;
    let normal = value == 0.0 || (value >= f64::from(f32::MIN_POSITIVE) && value <= f64::from(f32::MAX));
    let narrow = value as f32;
    (normal && !between).then_some(if negative { -narrow } else { narrow })
}

/// Appends the digits at the beginning of a text to a number; returns how many they are.
#[inline(always)]
fn leading_digits(text: &[u8], number: &mut u64) -> usize {
    for (count, byte) in text.iter().enumerate() {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            return count;
        }
        *number = *number * 10 + u64::from(digit);
    }
    text.len()
}

/// An exponent of up to four digits.
fn small_integer(text: &[u8]) -> Option<i32> {
    let (sign, digits) = match text {
        [b'-', rest @ ..] => (-1, rest),
        [b'+', rest @ ..] => (1, rest),
        _ => (1, text),
    };
    let fits = !digits.is_empty() && digits.len() <= 4 && digits.iter().all(u8::is_ascii_digit);
    fits.then(|| sign * digits.iter().fold(0, |n, d| n * 10 + i32::from(d - b'0')))
}

/// A number with a decimal comma or with an exponent as Fortran writes it, in the usual form; `None` if it has neither.
fn localised(text: &str) -> Option<String> {
    let is_number = text
        .bytes()
        .all(|b| matches!(b, b'0'..=b'9' | b'+' | b'-' | b'.' | b',' | b'e' | b'E' | b'd' | b'D'));
    let commas = text.bytes().filter(|&b| b == b',').count();
    let has_exponent = text.contains(['d', 'D']);
    let is_plain = commas > 1 || (commas == 1 && text.contains('.')) || (commas == 0 && !has_exponent);
    // A comma at either end separates.
    let separates = text.starts_with(',') || text.ends_with(',');
    (is_number && !is_plain && !separates).then(|| text.replace(',', ".").replace(['d', 'D'], "e"))
}

#[cold]
fn thorough(word: &[u8]) -> Option<f32> {
    let text = std::str::from_utf8(word).ok()?;
    text.parse().ok().or_else(|| localised(text)?.parse().ok()).or_else(|| {
        // The spellings of C runtimes: 1.#QNAN, -1.#IND00, nan(ind).
        let bare = text.trim_start_matches(['+', '-']).to_ascii_lowercase();
        let is_nan = bare.starts_with("nan(") || bare.starts_with("1.#qnan") || bare.starts_with("1.#ind");
        match bare.starts_with("1.#inf") {
            true => Some(if text.starts_with('-') { f32::NEG_INFINITY } else { f32::INFINITY }),
            false => is_nan.then_some(f32::NAN),
        }
    })
}

/// Appends the shortest text that parses back to the same f32.
pub fn push_f32(out: &mut Vec<u8>, value: f32) {
    let start = out.len();
    // Writing to a Vec cannot fail.
    let _ = write!(out, "{value:?}");
    if out[start..].ends_with(b".0") {
        out.truncate(out.len() - 2);
    }
}

/// Appends numbers separated by spaces.
pub fn push_f32s(out: &mut Vec<u8>, values: &[f32]) {
    for (i, &value) in values.iter().enumerate() {
        if i > 0 {
            out.push(b' ');
        }
        push_f32(out, value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn reads_every_way_of_writing_a_number() {
        let cases: [(&str, f32); 16] = [
            ("1,5", 1.5),
            ("-0,25e1", -2.5),
            ("1.5D+01", 15.0),
            ("2d-1", 0.2),
            ("1", 1.0),
            ("+1.5", 1.5),
            ("-0", -0.0),
            (".5", 0.5),
            ("5.", 5.0),
            ("1e-3", 0.001),
            (".8e-001", 0.08),
            ("-.7e+02", -70.0),
            ("1E10", 1e10),
            ("0.000000000000000000000000000000000000000001", 1e-42),
            ("123456789012345678901234567890", 1.234_567_9e29),
            ("1e999", f32::INFINITY),
        ];
        for (text, value) in cases {
            assert_eq!(parse_f32(text.as_bytes()).map(f32::to_bits), Some(value.to_bits()), "{text}");
        }
        for text in ["nan", "-NaN", "nan(ind)", "1.#QNAN", "-1.#IND00"] {
            assert!(parse_f32(text.as_bytes()).is_some_and(f32::is_nan), "{text}");
        }
        assert_eq!(parse_f32(b"-1.#INF"), Some(f32::NEG_INFINITY));
        for text in [
            "", "-", ".", "e5", "1e", "1e+", "1.2.3", "1,5,2", "1,5.2", "1,", ",5", "d5", "0x10", "1f", "one",
        ] {
            assert_eq!(parse_f32(text.as_bytes()), None, "{text}");
        }
    }

    proptest! {
        #[test]
        fn equals_the_standard_library(mantissa in 0u64..1_000_000_000_000, places in 0usize..18, e in -50i32..50) {
            let digits = format!("{mantissa:018}");
            for text in [
                format!("{}.{}", &digits[..18 - places], &digits[18 - places..]),
                format!("-{mantissa}e{e}"),
            ] {
                let expected: f32 = text.parse().unwrap();
                prop_assert_eq!(parse_f32(text.as_bytes()).unwrap().to_bits(), expected.to_bits(), "{}", text);
            }
        }

        #[test]
        fn decimals_between_floats_round_as_in_the_standard_library(bits in 0u32..0x7f00_0000) {
            let low = f32::from_bits(bits);
            let middle = (f64::from(low) + f64::from(low.next_up())) * 0.5;
            for value in [middle, middle.next_up(), middle.next_down()] {
                for text in [format!("{value}"), format!("{value:e}"), format!("{value:.16e}")] {
                    let expected: f32 = text.parse().unwrap();
                    prop_assert_eq!(parse_f32(text.as_bytes()).unwrap().to_bits(), expected.to_bits());
                }
            }
        }

        #[test]
        fn printed_numbers_read_back_to_the_bit(bits: u32) {
            let value = f32::from_bits(bits);
            let mut text = Vec::new();
            push_f32(&mut text, value);
            let back = parse_f32(&text).unwrap();
            prop_assert!(back.to_bits() == bits || (back.is_nan() && value.is_nan()));
        }
    }
}
