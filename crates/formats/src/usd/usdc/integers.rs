//! Compressed runs: LZ4 in chunks, and integers as differences of one, two or four bytes.

use super::bytes::Bytes;
use crate::FormatError;
use crate::budget::Budget;

/// LZ4 cannot shrink anything further than this.
const MAX_PACKED: u64 = 256;

/// Unpacks bytes of a length that the file states, and charges for them.
pub(super) fn unpack(
    packed: &[u8],
    length: u64,
    bytes: &Bytes,
    budget: &mut Budget,
) -> Result<Vec<u8>, FormatError> {
    if length > (packed.len() as u64 + 1).saturating_mul(MAX_PACKED) {
        return Err(bytes.error("it states more items than its compressed bytes can hold"));
    }
    budget.take_bytes(length, bytes.name)?;
    let mut out = vec![0; length as usize];
    if length == 0 {
        return Ok(out);
    }
    let fault = || bytes.error("compressed bytes (LZ4) cannot be unpacked");
    let (&chunks, mut rest) = packed.split_first().ok_or_else(fault)?;
    let mut filled = 0;
    if chunks == 0 {
        filled = lz4_flex::block::decompress_into(rest, &mut out).map_err(|_| fault())?;
    }
    for _ in 0..chunks {
        let (size, after) = rest.split_first_chunk::<4>().ok_or_else(fault)?;
        let size = usize::try_from(i32::from_le_bytes(*size)).map_err(|_| fault())?;
        let chunk = after.get(..size).ok_or_else(fault)?;
        filled += lz4_flex::block::decompress_into(chunk, &mut out[filled..]).map_err(|_| fault())?;
        rest = &after[size..];
    }
    out.truncate(filled);
    Ok(out)
}

/// Reads a size and as many integers of 32 bits, packed; returns them with the bits of signed numbers.
pub(super) fn integers(
    bytes: &mut Bytes,
    count: usize,
    budget: &mut Budget,
) -> Result<Vec<i32>, FormatError> {
    let encoded = encoded(bytes, count, 4, budget)?;
    budget.take_bytes(4 * count as u64, bytes.name)?;
    let mut out = Vec::with_capacity(count);
    let decoded = decode::<4, 1, 2>(&encoded, count, |value| out.push(value as i32));
    budget.release(encoded.len() as u64);
    decoded.ok_or_else(|| bytes.error("packed integers end too early"))?;
    Ok(out)
}

/// The same for integers of 64 bits.
pub(super) fn long_integers(
    bytes: &mut Bytes,
    count: usize,
    budget: &mut Budget,
) -> Result<Vec<i64>, FormatError> {
    let encoded = encoded(bytes, count, 8, budget)?;
    budget.take_bytes(8 * count as u64, bytes.name)?;
    let mut out = Vec::with_capacity(count);
    let decoded = decode::<8, 2, 4>(&encoded, count, |value| out.push(value));
    budget.release(encoded.len() as u64);
    decoded.ok_or_else(|| bytes.error("packed integers end too early"))?;
    Ok(out)
}

fn encoded(bytes: &mut Bytes, count: usize, width: u64, budget: &mut Budget) -> Result<Vec<u8>, FormatError> {
    let size = bytes.u64()?;
    let packed = bytes.take(size)?;
    if count == 0 {
        return Ok(vec![0; width as usize]);
    }
    // Two bits of each say how long it is; the longest have all of their bytes.
    let count = count as u64;
    let least = count.div_ceil(4);
    if least > (packed.len() as u64 + 1).saturating_mul(MAX_PACKED) {
        return Err(bytes.error("it states more integers than its compressed bytes can hold"));
    }
    let most = (width + count.div_ceil(4)).saturating_add(count.saturating_mul(width));
    unpack(packed, most.min((packed.len() as u64 + 1) * MAX_PACKED), bytes, budget)
}

/// Integers of `WIDTH` bytes: the commonest difference, two bits for each that choose it or a difference of `SMALL`,
/// `MEDIUM` or all bytes, and then these differences.
fn decode<const WIDTH: usize, const SMALL: usize, const MEDIUM: usize>(
    encoded: &[u8],
    count: usize,
    mut push: impl FnMut(i64),
) -> Option<()> {
    let (common, rest) = encoded.split_at_checked(WIDTH)?;
    let (codes, mut rest) = rest.split_at_checked(count.div_ceil(4))?;
    let common = signed(common);
    let mut value = 0i64;
    for i in 0..count {
        let size = match codes[i / 4] >> (2 * (i % 4)) & 3 {
            0 => {
                value = value.wrapping_add(common);
                push(value);
                continue;
            }
            1 => SMALL,
            2 => MEDIUM,
            _ => WIDTH,
        };
        let (difference, after) = rest.split_at_checked(size)?;
        rest = after;
        value = value.wrapping_add(signed(difference));
        push(value);
    }
    Some(())
}

#[inline(always)]
fn signed(bytes: &[u8]) -> i64 {
    match *bytes {
        [a] => i64::from(a as i8),
        [a, b] => i64::from(i16::from_le_bytes([a, b])),
        [a, b, c, d] => i64::from(i32::from_le_bytes([a, b, c, d])),
        [a, b, c, d, e, f, g, h] => i64::from_le_bytes([a, b, c, d, e, f, g, h]),
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worked out by hand: differences 123, 124 - 123, then the common one, then -1000.
    #[test]
    fn integers_are_sums_of_differences() {
        let mut encoded = vec![1, 0, 0, 0];
        encoded.push(0b10_00_00_01);
        encoded.push(123);
        encoded.extend((-1000i16).to_le_bytes());
        let mut out = Vec::new();
        assert_eq!(decode::<4, 1, 2>(&encoded, 4, |value| out.push(value)), Some(()));
        assert_eq!(out, [123, 124, 125, -875]);
        assert_eq!(decode::<4, 1, 2>(&encoded[..7], 4, |_| ()), None);
    }
}
