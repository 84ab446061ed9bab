//! WebP: chunks of a RIFF file. [WebP]

use super::{letters, meaning, u32_at};
use crate::PictureError;
use image_webp::DecodingError;

const FORMAT: &str = "WebP";

const PHRASES: &[super::Phrase] = &[
    ("riff", "it does not begin as a WebP does"),
    ("webp signature", "it does not begin as a WebP does"),
    ("chunk was missing", "it has no pixels"),
    ("chunk header", "a chunk is in a place where its kind is not allowed"),
    ("alpha chunk size", "its alpha and its colours differ in size"),
    ("alpha", "the header of its alpha is wrong"),
    ("too large", "it is larger than a WebP can be"),
    ("outside", "one of its frames is larger than the picture"),
    ("lossless", "the header of its pixels is wrong"),
    ("magic", "the header of its pixels is wrong"),
    ("init data", "the header of its pixels is too short"),
    ("color space", "the header of its pixels is wrong"),
    ("dimensions", "its parts have different sizes"),
    ("inconsistent", "its parts have different sizes"),
    ("huffman", "its compressed pixels cannot be decompressed"),
    ("bitstream", "its compressed pixels cannot be decompressed"),
    ("transform", "its compressed pixels cannot be decompressed"),
    ("prediction", "its compressed pixels cannot be decompressed"),
    ("color cache", "its compressed pixels cannot be decompressed"),
    ("compression", "its compression is unknown"),
    ("partition", "its compressed pixels cannot be decompressed"),
];

/// Why the decoder rejects these bytes.
pub(in super::super) fn explain(error: &DecodingError, bytes: &[u8]) -> PictureError {
    let mut at = 12;
    let mut pixels = None;
    while let (Some(name), Some(size)) = (bytes.get(at..at + 4), u32_at(bytes, at + 4, false)) {
        let Some(name) = letters(name) else { break };
        let end = at.saturating_add(8).saturating_add(size as usize);
        if end > bytes.len() {
            return PictureError::truncated(
                FORMAT,
                format!("the chunk {}, which begins at byte {at}", name.trim()),
            );
        }
        if matches!(name, "VP8 " | "VP8L") {
            pixels.get_or_insert(at);
        }
        // Chunks begin at even offsets.
        at = end + end % 2;
    }
    if matches!(error, DecodingError::IoError(_)) {
        return PictureError::truncated(FORMAT, "the header or the pixels");
    }
    let what = meaning(&error.to_string(), PHRASES);
    let place = pixels.filter(|_| what.contains("pixels"));
    let place = place.map_or_else(String::new, |at| format!(" (they begin at byte {at})"));
    PictureError::invalid(FORMAT, format!("{what}{place}"))
}
