//! Indices of an OBJ file: they count from 1, or backwards from -1.

use bilux_import::meshes::indexed_faces::NONE;

/// An index from 0, or the distance to count back.
#[derive(Debug, PartialEq)]
pub(super) enum Index {
    Forward(u32),
    Backward(i64),
}

/// Parses an index, which counts from 1 or backwards from -1; whether it exists is checked later.
#[inline]
pub(super) fn index(text: &[u8]) -> Option<Index> {
    let (negative, digits) = match text {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, text),
    };
    if digits.is_empty() || digits.len() > 10 {
        return None;
    }
    let mut number = 0i64;
    for &digit in digits {
        if !digit.is_ascii_digit() {
            return None;
        }
        number = number * 10 + i64::from(digit - b'0');
    }
    if number == 0 {
        return None;
    }
    if negative {
        return Some(Index::Backward(number));
    }
    u32::try_from(number - 1).ok().filter(|&i| i != NONE).map(Index::Forward)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_count_from_one_or_backwards() {
        assert_eq!(index(b"1"), Some(Index::Forward(0)));
        assert_eq!(index(b"+7"), Some(Index::Forward(6)));
        assert_eq!(index(b"-1"), Some(Index::Backward(1)));
        assert_eq!(index(b"-8"), Some(Index::Backward(8)));
        for bad in ["0", "-0", "", "-", "1.5", "4294967296", "99999999999"] {
            assert_eq!(index(bad.as_bytes()), None, "{bad}");
        }
    }
}
