//! PNG: chunks, each with its length, name and checksum. [PNG, 5.3]

use super::{letters, meaning, u32_at};
use crate::PictureError;
use png::DecodingError;
use std::io::ErrorKind;

const FORMAT: &str = "PNG";
const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

const PHRASES: &[super::Phrase] = &[
    ("corrupt deflate", "its compressed pixels cannot be decompressed"),
    ("enough data for image", "it has fewer pixels than its header says"),
    ("idat or fdat chunk is missing", "it has no pixels (no IDAT chunk)"),
    ("before ihdr", "it does not begin with its header (IHDR)"),
    ("palette entries", "its palette is too short"),
    ("missing palette", "its pixels are palette indices, but it has no palette (PLTE)"),
    ("palette", "its palette is wrong"),
    ("dimensions", "its header says that it has no pixels"),
    ("color/depth", "its header has a bit depth that its colour type does not allow"),
    ("bit depth", "its header has a bit depth that does not exist"),
    ("color type", "its header has a colour type that does not exist"),
    ("sbit", "its chunk sBIT is wrong"),
    ("compression method", "its compression is unknown"),
    ("filter", "its filter method is unknown"),
    ("interlace", "its interlace method is unknown"),
    ("signature", "it does not begin as a PNG does"),
    ("at most once", "one of its chunks occurs twice"),
    ("chunk", "its chunks are not in the order that PNG requires"),
    ("text", "one of its text entries is wrong"),
    ("frame", "one of its frames is wrong"),
];

/// Why the decoder rejects these bytes.
pub(in super::super) fn explain(error: &DecodingError, bytes: &[u8]) -> PictureError {
    if matches!(error, DecodingError::LimitsExceeded) {
        return PictureError::Unsupported {
            format: FORMAT,
            what: "a chunk that needs more memory than the limit".to_owned(),
            advice: "raise the memory limit if you trust the file",
        };
    }
    if let Some(found) = structure(bytes) {
        return found;
    }
    match error {
        DecodingError::IoError(error) if error.kind() == ErrorKind::UnexpectedEof => {
            PictureError::truncated(FORMAT, "the pixels")
        }
        other => {
            let what = meaning(&other.to_string(), PHRASES);
            let place = first(bytes, b"IDAT").filter(|_| what.contains("pixels"));
            let place = place.map_or_else(String::new, |at| format!(" (they begin at byte {at})"));
            PictureError::invalid(FORMAT, format!("{what}{place}"))
        }
    }
}

/// The offset of the first chunk with a name.
fn first(bytes: &[u8], name: &[u8; 4]) -> Option<usize> {
    Chunks { bytes, at: SIGNATURE.len() }.find(|chunk| chunk.name == name).map(|chunk| chunk.at)
}

struct Chunk<'a> {
    at: usize,
    name: &'a [u8],
    /// The name, the data and the checksum, as far as they are present.
    rest: &'a [u8],
    length: usize,
}

struct Chunks<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Iterator for Chunks<'a> {
    type Item = Chunk<'a>;

    fn next(&mut self) -> Option<Chunk<'a>> {
        let at = self.at;
        let length = u32_at(self.bytes, at, true)? as usize;
        let name = self.bytes.get(at + 4..at + 8)?;
        let end = at.checked_add(12)?.checked_add(length)?;
        self.at = end;
        let rest = self.bytes.get(at + 4..end.min(self.bytes.len()))?;
        Some(Chunk { at, name, rest, length })
    }
}

/// The first chunk that is malformed in itself.
fn structure(bytes: &[u8]) -> Option<PictureError> {
    let invalid = |what: String| Some(PictureError::invalid(FORMAT, what));
    if !bytes.starts_with(SIGNATURE) {
        return if SIGNATURE.starts_with(bytes) {
            Some(PictureError::truncated(FORMAT, "the header"))
        } else {
            invalid("its first 8 bytes are not those of a PNG; perhaps it was copied as text".to_owned())
        };
    }
    let mut chunks = Chunks { bytes, at: SIGNATURE.len() };
    let mut end = SIGNATURE.len();
    for chunk in chunks.by_ref() {
        let at = chunk.at;
        let Some(name) = letters(chunk.name) else {
            return invalid(format!("a chunk should begin at byte {at}, but there is none"));
        };
        let Some((data, checksum)) =
            chunk.rest.split_at_checked(chunk.length + 4).filter(|(_, c)| c.len() == 4)
        else {
            return Some(PictureError::truncated(
                FORMAT,
                format!("the chunk {name}, which begins at byte {at}"),
            ));
        };
        if u32_at(checksum, 0, true) != Some(crc(data)) {
            return invalid(format!("the checksum of the chunk {name} at byte {at} does not match its data"));
        }
        if at == SIGNATURE.len() && name != "IHDR" {
            return invalid(format!("its first chunk is {name} and not the header, IHDR"));
        }
        if name == "IEND" {
            return None;
        }
        end = at + 12 + chunk.length;
    }
    Some(PictureError::truncated(FORMAT, format!("its chunks: more should follow after byte {end}")))
}

/// The checksum of a chunk's name and data. [PNG, annex D]
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |sum, &byte| {
        (0..8).fold(
            sum ^ u32::from(byte),
            |sum, _| if sum & 1 == 1 { sum >> 1 ^ 0xedb8_8320 } else { sum >> 1 },
        )
    })
}
