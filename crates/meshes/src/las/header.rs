//! The public header block of a LAS file. [LAS 1.4 R15, 2.4]

use bilux_import::FormatError;
use bilux_import::bytes::text::whole_file;
use bilux_import::input::reading::Source;
use bilux_math::DVec3;

pub(super) const SIGNATURE: &[u8] = b"LASF";

/// Bytes of the header of versions 1.0 to 1.2, the shortest one.
const SHORTEST: usize = 227;
/// The offset of the 64-bit point count in version 1.4.
const LONG_COUNT: usize = 247;

/// The first point format that has flags in a byte of their own; before, they are in the byte of the class. [LAS 1.4 R15, tables 8 and 16]
const FIRST_WITH_FLAGS: u8 = 6;

/// For each point format, the minimum size of a record and the offset of its colour. [LAS 1.4 R15, 2.6]
const FORMATS: [(usize, Option<usize>); 11] = [
    (20, None),
    (28, None),
    (26, Some(20)),
    (34, Some(28)),
    (57, None),
    (63, Some(28)),
    (30, None),
    (36, Some(30)),
    (38, Some(30)),
    (59, None),
    (67, Some(30)),
];

/// The parts of a header that the reader uses.
#[derive(Debug)]
pub(super) struct Header {
    /// The offset of the points.
    pub(super) points: usize,
    pub(super) count: u64,
    /// True if the points are compressed (LAZ).
    pub(super) is_compressed: bool,
    /// The size of a point record in bytes.
    pub(super) record: usize,
    /// The offset of the colour in a record.
    pub(super) colour: Option<usize>,
    /// The bit of byte 15 of a record that says that the point is withheld, which means deleted.
    pub(super) withheld: u8,
    pub(super) scale: DVec3,
    pub(super) offset: DVec3,
}

pub(super) fn read_header(source: &Source) -> Result<Header, FormatError> {
    let bytes = source.bytes;
    let fail = |message: String| Err(FormatError::malformed(message, whole_file(source.name)));
    if !bytes.starts_with(SIGNATURE) {
        return fail("a LAS file begins with the letters LASF: is this another format?".to_owned());
    }
    if bytes.len() < SHORTEST {
        let message = format!(
            "a LAS file has a header of at least {SHORTEST} bytes, but this file has {}: it was cut off",
            bytes.len()
        );
        return fail(message);
    }
    let (major, minor) = (bytes[24], bytes[25]);
    if major != 1 || minor > 4 {
        return fail(format!("this is LAS {major}.{minor}, but only 1.0 to 1.4 can be read"));
    }
    // The highest bits mark compressed records.
    let (format, is_compressed) = (bytes[104] & 0x3f, bytes[104] & 0xc0 != 0);
    let Some(&(least, colour)) = FORMATS.get(usize::from(format)) else {
        return fail(format!("its points have format {format}, but only 0 to 10 exist"));
    };
    let record = usize::from(u16_at(bytes, 105));
    if record < least {
        let message =
            format!("a point of format {format} has at least {least} bytes, but the header says {record}");
        return fail(message);
    }
    let legacy = u64::from(u32_at(bytes, 107));
    let long = if minor >= 4 { bytes.get(LONG_COUNT..).and_then(<[u8]>::first_chunk) } else { None };
    let count = long.map(|bytes| u64::from_le_bytes(*bytes)).filter(|&count| count > 0).unwrap_or(legacy);
    let vector = |at: usize| DVec3::new(f64_at(bytes, at), f64_at(bytes, at + 8), f64_at(bytes, at + 16));
    let (scale, offset) = (vector(131), vector(155));
    if !(scale.is_finite() && offset.is_finite()) || scale.cmpeq(DVec3::ZERO).any() {
        return fail("the scale of its coordinates is 0 or not a number: its header is damaged".to_owned());
    }
    let points = u32_at(bytes, 96) as usize;
    let room = bytes.len().saturating_sub(points) / record;
    if count > room as u64 && !is_compressed {
        let message = format!(
            "the header says {count} points of {record} bytes from byte {points} on, but there are bytes for only {room}: \
             the file was cut off"
        );
        return fail(message);
    }
    if count == 0 {
        return fail("it contains no points".to_owned());
    }
    if count >= u64::from(u32::MAX) {
        return fail("there are more than 4 billion points: split the file".to_owned());
    }
    let withheld = if format < FIRST_WITH_FLAGS { 0x80 } else { 4 };
    Ok(Header { points, count, is_compressed, record, colour, withheld, scale, offset })
}

/// The number at an offset; 0 beyond the end.
pub(super) fn u16_at(bytes: &[u8], at: usize) -> u16 {
    bytes.get(at..).and_then(<[u8]>::first_chunk).map_or(0, |b| u16::from_le_bytes(*b))
}

pub(super) fn u32_at(bytes: &[u8], at: usize) -> u32 {
    bytes.get(at..).and_then(<[u8]>::first_chunk).map_or(0, |b| u32::from_le_bytes(*b))
}

fn f64_at(bytes: &[u8], at: usize) -> f64 {
    bytes.get(at..).and_then(<[u8]>::first_chunk).map_or(0.0, |b| f64::from_le_bytes(*b))
}
