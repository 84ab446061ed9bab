//! Compressed runs: LZ4 in chunks, and integers as differences of one, two or four bytes.

use super::bytes::Bytes;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;

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
    let decoded = decode::<4, 1, 2>(&encoded, count, |values| out.extend(values.iter().map(|&x| x as i32)));
    budget.release(encoded.len() as u64);
    decoded.ok_or_else(|| bytes.error("packed integers end too early"))?;
    Ok(out)
}

/// Reads a size and as many integers of 64 bits, packed.
pub(super) fn long_integers(
    bytes: &mut Bytes,
    count: usize,
    budget: &mut Budget,
) -> Result<Vec<i64>, FormatError> {
    let encoded = encoded(bytes, count, 8, budget)?;
    budget.take_bytes(8 * count as u64, bytes.name)?;
    let mut out = Vec::with_capacity(count);
    let decoded = decode::<8, 2, 4>(&encoded, count, |values| out.extend_from_slice(values));
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
/// `MEDIUM` or all bytes, and then these differences. Passes on up to four at a time.
fn decode<const WIDTH: usize, const SMALL: usize, const MEDIUM: usize>(
    encoded: &[u8],
    count: usize,
    mut push: impl FnMut(&[i64]),
) -> Option<()> {
    let (common, rest) = encoded.split_at_checked(WIDTH)?;
    let (codes, mut rest) = rest.split_at_checked(count.div_ceil(4))?;
    let common = difference(common, WIDTH);
    let sizes = [0, SMALL, MEDIUM, WIDTH];
    let mut value = 0i64;
    let mut four = [0; 4];
    for (i, &codes) in codes.iter().enumerate() {
        let length = (count - 4 * i).min(4);
        for (k, slot) in four[..length].iter_mut().enumerate() {
            let code = usize::from(codes >> (2 * k) & 3);
            let size = sizes[code];
            let own = difference(rest, size);
            rest = rest.get(size..)?;
            value = value.wrapping_add(if code == 0 { common } else { own });
            *slot = value;
        }
        push(&four[..length]);
    }
    Some(())
}

/// The signed number in the first bytes.
#[inline(always)]
fn difference(bytes: &[u8], size: usize) -> i64 {
    let word = match bytes.first_chunk() {
        Some(word) => u64::from_le_bytes(*word),
        // Near the end there are fewer than eight.
        None => bytes.iter().rev().fold(0, |word, &byte| word << 8 | u64::from(byte)),
    };
    let above = (64 - 8 * size as u32).min(63);
    ((word << above) as i64) >> above
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
        assert_eq!(decode::<4, 1, 2>(&encoded, 4, |values| out.extend_from_slice(values)), Some(()));
        assert_eq!(out, [123, 124, 125, -875]);
        assert_eq!(decode::<4, 1, 2>(&encoded[..7], 4, |_| ()), None);
    }

    #[test]
    fn integers_of_eight_bytes_may_have_all_of_them() {
        let mut encoded = (-3i64).to_le_bytes().to_vec();
        encoded.extend([0b11_10_01_00, 0b01]);
        encoded.extend([(-2i16).to_le_bytes().as_slice(), &70_000i32.to_le_bytes()].concat());
        encoded.extend([i64::MIN.to_le_bytes().as_slice(), &1i16.to_le_bytes()].concat());
        let mut out = Vec::new();
        assert_eq!(decode::<8, 2, 4>(&encoded, 5, |values| out.extend_from_slice(values)), Some(()));
        let last = 69_995i64.wrapping_add(i64::MIN);
        assert_eq!(out, [-3, -5, 69_995, last, last + 1]);
    }
}
