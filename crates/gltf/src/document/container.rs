//! GLB, the binary container: a header and chunks. The first chunk is JSON, and the second may be a buffer.

use bilux_import::FormatError;
use bilux_import::bytes::text::{whole_file, without_mark, without_padding};
use bilux_import::input::reading::Source;

/// The first bytes of every GLB file.
pub(crate) const MAGIC: &[u8] = b"glTF";
const JSON: u32 = u32::from_le_bytes(*b"JSON");
const BIN: u32 = u32::from_le_bytes(*b"BIN\0");

/// The parts of a file.
pub(crate) struct Container<'a> {
    pub(crate) json: &'a [u8],
    /// The buffer in a GLB file's binary chunk.
    pub(crate) binary: Option<&'a [u8]>,
    /// Warnings about the container.
    pub(crate) warnings: Vec<String>,
}

/// Splits a file into its parts; a file that is not GLB is all JSON.
pub(crate) fn open<'a>(source: &Source<'a>) -> Result<Container<'a>, FormatError> {
    let fail = |message: String| Err(FormatError::malformed(message, whole_file(source.name)));
    let bytes = source.bytes;
    let mut container = Container { json: without_padding(bytes), binary: None, warnings: Vec::new() };
    if !bytes.starts_with(MAGIC) {
        return Ok(container);
    }
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return fail("the GLB file ends within its header: it was cut off".to_owned());
    };
    if version != 2 {
        return fail(format!(
            "this is GLB version {version}, but only version 2 can be read: export it as glTF 2.0"
        ));
    }
    let length = length as usize;
    if length > bytes.len() {
        let missing = length - bytes.len();
        return fail(format!(
            "the GLB file says that it has {length} bytes, of which {missing} are missing: it was cut off"
        ));
    }
    if length < bytes.len() {
        let more = bytes.len() - length;
        container.warnings.push(format!("{more} bytes after the end of the GLB file are ignored"));
    }
    container.json = &[];
    let mut at = 12;
    for number in 0.. {
        if at >= length {
            break;
        }
        let (Some(size), Some(kind)) = (word(bytes, at), word(bytes, at + 4)) else {
            return fail(format!("chunk {number} at byte {at} ends within its header: the file was cut off"));
        };
        let end = (at + 8).checked_add(size as usize).filter(|&end| end <= length);
        let Some(chunk) = end.and_then(|end| bytes.get(at + 8..end)) else {
            return fail(format!(
                "chunk {number} at byte {at} should have {size} bytes, more than the file has left"
            ));
        };
        match (number, kind) {
            (0, JSON) => container.json = without_padding(without_mark(chunk)),
            (0, _) => {
                return fail("the first chunk of a GLB file must be JSON, but this one is not".to_owned());
            }
            (1, BIN) => container.binary = Some(chunk),
            (_, JSON | BIN) => {
                container
                    .warnings
                    .push(format!("chunk {number} at byte {at} is not allowed here and is ignored"));
            }
            _ => container
                .warnings
                .push(format!("chunk {number} at byte {at} is of an unknown kind, and is ignored")),
        }
        if chunk.len() % 4 != 0 {
            container
                .warnings
                .push(format!("chunk {number} at byte {at} has {size} bytes, which must be a multiple of 4"));
        }
        at += 8 + chunk.len();
    }
    if container.json.is_empty() {
        return fail("this GLB file contains no JSON".to_owned());
    }
    Ok(container)
}

/// A little-endian 32-bit number.
fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let four = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes([four[0], four[1], four[2], four[3]]))
}
