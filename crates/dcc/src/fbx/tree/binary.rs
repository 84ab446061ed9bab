//! Binary files: records with their own end, the number and the size of their values, and their name.

use super::records::{Builder, MAX_DEPTH};
use bilux_import::FormatError;
use bilux_import::bytes::text::{Places, quoted};

/// The first bytes of every binary file.
pub(in crate::fbx) const MAGIC: &[u8] = b"Kaydara FBX Binary";

/// Bytes before the first record: the magic ones, a mark, the order of bytes, and the version.
const HEADER: usize = 27;

/// From this version on, records count in 64 bits.
const WIDE: u32 = 7500;

/// The first bytes of a file.
pub(super) struct Header {
    pub(super) version: u32,
    pub(super) is_big_endian: bool,
}

impl Header {
    pub(super) fn read(bytes: &[u8], places: &Places) -> Result<Header, FormatError> {
        let Some(header) = bytes.get(..HEADER) else { return Err(cut_off(places, bytes.len())) };
        // Before the mark there is a zero.
        if header[20] == b' ' {
            let message = "the zeros in this file were replaced by spaces, by a program that took it for text: it is damaged, copy it \
                           again in binary mode";
            return Err(FormatError::malformed(message, places.whole()));
        }
        let version = [header[23], header[24], header[25], header[26]];
        let is_big_endian = header[22] == 1;
        let version = if is_big_endian { u32::from_be_bytes(version) } else { u32::from_le_bytes(version) };
        Ok(Header { version, is_big_endian })
    }
}

/// The beginning of a record.
struct Start<'a> {
    /// End of the record; 0 marks the end of a list.
    end: u64,
    values: u64,
    name: &'a [u8],
    /// Offset of the record's values.
    after: usize,
}

impl<'a> Start<'a> {
    /// `None` if the file ends before.
    fn read(bytes: &'a [u8], at: usize, header: &Header) -> Option<Start<'a>> {
        let width = if header.version >= WIDE { 8 } else { 4 };
        let number = |index: usize| -> Option<u64> {
            let field = bytes.get(at + index * width..)?.get(..width)?;
            let digit = |sum: u64, byte: &u8| sum << 8 | u64::from(*byte);
            Some(match header.is_big_endian {
                true => field.iter().fold(0, digit),
                false => field.iter().rev().fold(0, digit),
            })
        };
        let length = at + 3 * width;
        let name = bytes.get(length + 1..)?.get(..usize::from(*bytes.get(length)?))?;
        Some(Start { end: number(0)?, values: number(2)?, name, after: length + 1 + name.len() })
    }
}

/// Reads all records up to the mark that ends them.
pub(super) fn parse<'a>(
    bytes: &'a [u8],
    header: &Header,
    places: &Places,
    builder: &mut Builder<'a, '_>,
) -> Result<(), FormatError> {
    // The records that are not complete, with their ends.
    let mut open: Vec<(u32, usize)> = Vec::new();
    let mut at = HEADER;
    loop {
        let end = open.last().map_or(bytes.len(), |(_, end)| *end);
        if at >= end {
            // Without the mark of its end: either it has none, or the file was cut off there.
            let Some((record, _)) = open.pop() else { return Ok(()) };
            builder.close(record);
            continue;
        }
        let Some(start) = Start::read(bytes, at, header) else { return Err(cut_off(places, bytes.len())) };
        if start.end == 0 {
            let Some((record, end)) = open.pop() else { return Ok(()) };
            builder.close(record);
            at = end;
            continue;
        }
        if start.end > bytes.len() as u64 {
            return Err(cut_off(places, bytes.len()));
        }
        let values = (end.saturating_sub(start.after) as u64).checked_sub(start.values);
        let record_end = start.end as usize;
        let values_end = start.after + start.values as usize * usize::from(values.is_some());
        if values.is_none() || record_end > end || record_end < values_end || record_end <= at {
            let name = quoted(start.name);
            let message = format!("byte {at}: the sizes of the record {name} contradict each other");
            return Err(FormatError::malformed(message, places.whole()));
        }
        let record = builder.push(start.name, &bytes[start.after..values_end], at)?;
        at = values_end;
        if at < record_end {
            if open.len() >= MAX_DEPTH {
                let message = format!("records are nested more than {MAX_DEPTH} levels deep");
                return Err(FormatError::malformed(message, places.whole()));
            }
            open.push((record, record_end));
        }
    }
}

fn cut_off(places: &Places, length: usize) -> FormatError {
    let message = format!("the file ends after {length} bytes, in the middle of a record: it was cut off");
    FormatError::malformed(message, places.whole())
}
