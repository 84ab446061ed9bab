//! Decodes vertex attributes: each byte is stored as its difference from that of the previous element.

use super::bytes::{Broken, Bytes};

const HEADER: u8 = 0xa0;
/// The number of differences in a group.
const GROUP: usize = 16;
/// The maximum number of elements of a block.
const LARGEST_BLOCK: usize = 256;
/// The maximum number of bytes of a block.
const BLOCK_BYTES: usize = 8192;
/// The minimum number of bytes of the tail.
const MIN_TAIL: usize = 32;

/// Decodes all elements of `stride` bytes.
pub(super) fn unpack(packed: &[u8], stride: usize, elements: &mut [u8]) -> Result<(), Broken> {
    let tail = stride.max(MIN_TAIL);
    let (&header, rest) = packed.split_first().ok_or(Broken)?;
    let end = rest.len().checked_sub(tail).ok_or(Broken)?;
    if header != HEADER {
        return Err(Broken);
    }
    // The tail ends with the element that precedes the first one.
    let mut last = rest[rest.len() - stride..].to_vec();
    let mut bytes = Bytes(&rest[..end]);
    let block = (BLOCK_BYTES / stride / GROUP * GROUP).min(LARGEST_BLOCK);
    for elements in elements.chunks_mut(block * stride) {
        for (k, last) in last.iter_mut().enumerate() {
            column(&mut bytes, elements, k, stride, last)?;
        }
    }
    if bytes.0.is_empty() { Ok(()) } else { Err(Broken) }
}

/// Decodes one byte of every element of a block.
fn column(
    bytes: &mut Bytes,
    elements: &mut [u8],
    k: usize,
    stride: usize,
    last: &mut u8,
) -> Result<(), Broken> {
    let count = elements.len() / stride;
    let groups = count.div_ceil(GROUP);
    let widths = bytes.take(groups.div_ceil(4))?;
    for group in 0..groups {
        let differences = differences(bytes, widths[group / 4] >> (group % 4 * 2) & 3)?;
        let here = group * GROUP..count.min((group + 1) * GROUP);
        for (i, difference) in here.zip(differences) {
            *last = last.wrapping_add(difference >> 1 ^ (difference & 1).wrapping_neg());
            elements[i * stride + k] = *last;
        }
    }
    Ok(())
}

/// Sixteen differences of 0, 2, 4 or 8 bits. In 2 and 4 bits, the maximum value means that a full byte follows the
/// group.
fn differences(bytes: &mut Bytes, width: u8) -> Result<[u8; GROUP], Broken> {
    let mut all = [0; GROUP];
    match width {
        0 => {}
        3 => all.copy_from_slice(bytes.take(GROUP)?),
        width => {
            let bits = usize::from(width) * 2;
            let (packed, mask) = (bytes.take(bits * GROUP / 8)?, (1u8 << bits) - 1);
            for (i, difference) in all.iter_mut().enumerate() {
                let at = i * bits;
                // The first difference is in the highest bits.
                let short = packed[at / 8] >> (8 - bits - at % 8) & mask;
                *difference = if short == mask { bytes.byte()? } else { short };
            }
        }
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_of_every_width_are_added_up() {
        // Four bytes per element, three elements. The bytes of an element use 0, 2, 4 and 8 bits.
        let mut packed = vec![HEADER, 0];
        // 1, -1, and +100 as a full byte.
        packed.extend([1, 0b10_01_11_00, 0, 0, 0, 200]);
        packed.extend([2, 0x4f, 0xe0, 0, 0, 0, 0, 0, 0, 255]);
        packed.extend([3, 2, 4, 6, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
        packed.extend([0; 28]);
        packed.extend([10, 20, 30, 40]);
        let mut elements = [0; 12];
        assert!(unpack(&packed, 4, &mut elements).is_ok());
        assert_eq!(elements, [10, 21, 32, 41, 10, 20, 160, 43, 10, 120, 167, 46]);
        for cut in 0..packed.len() {
            assert!(unpack(&packed[..cut], 4, &mut elements).is_err());
        }
    }
}
