//! JPEG: segments, each of which starts with a marker. [JPEG]

use super::meaning;
use crate::PictureError;
use zune_jpeg::errors::DecodeErrors;

const FORMAT: &str = "JPEG";

const PHRASES: &[super::Phrase] = &[
    ("huffman code", "its compressed pixels cannot be decompressed"),
    ("huffman", "one of its Huffman tables is wrong"),
    ("dqt", "one of its quantization tables is wrong"),
    ("quantization", "one of its quantization tables is wrong"),
    ("qt table", "one of its quantization tables is wrong"),
    ("sos", "the header of a scan is wrong"),
    ("scan", "the header of a scan is wrong"),
    ("sof", "its frame header is wrong"),
    ("component", "its frame header is wrong"),
    ("sampling", "its frame header has an impossible chroma subsampling"),
    ("zero", "its header says that it has no pixels"),
    ("width", "its header has an impossible width"),
    ("height", "its header has an impossible height"),
    ("start bytes", "it does not begin as a JPEG does"),
    ("marker", "it has a marker where none is allowed"),
    ("length", "one of its segments has a wrong length"),
    ("mcu", "its compressed pixels cannot be decompressed"),
    ("corrupt", "its compressed pixels cannot be decompressed"),
];

/// Why the decoder rejects these bytes.
pub(in super::super) fn explain(error: &DecodeErrors, bytes: &[u8]) -> PictureError {
    if let Some(part) = cut_segment(bytes) {
        return PictureError::truncated(FORMAT, part);
    }
    match error {
        DecodeErrors::ExhaustedData | DecodeErrors::IoErrors(_) => {
            PictureError::truncated(FORMAT, "the pixels")
        }
        DecodeErrors::Unsupported(_) => PictureError::Unsupported {
            format: FORMAT,
            what: "arithmetic coding or lossless compression".to_owned(),
            advice: "save it as an ordinary JPEG, baseline or progressive",
        },
        other => PictureError::invalid(FORMAT, meaning(&other.to_string(), PHRASES)),
    }
}

/// The segment in which the file ends, unless it ends within the pixels.
fn cut_segment(bytes: &[u8]) -> Option<String> {
    let mut at = 2;
    while let Some([0xff, marker]) = bytes.get(at..at + 2) {
        at += match marker {
            0xff => 1,
            0x01 | 0xd0..=0xd9 => 2,
            0xda => return None,
            _ => {
                let length = bytes.get(at + 2..at + 4).map(|l| usize::from(l[0]) << 8 | usize::from(l[1]));
                match length {
                    Some(length) if at + 2 + length <= bytes.len() => 2 + length,
                    _ => return Some(format!("the segment {marker:02X}, which begins at byte {at}")),
                }
            }
        };
    }
    (at >= bytes.len()).then(|| "its segments, before the pixels begin".to_owned())
}
