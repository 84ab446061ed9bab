//! JPEG: segments, each of which starts with a marker. [JPEG]

use super::meaning;
use crate::PictureError;
use std::borrow::Cow;
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
    match (error, bits_per_sample(bytes)) {
        (DecodeErrors::ExhaustedData | DecodeErrors::IoErrors(_), _) => {
            PictureError::truncated(FORMAT, "the pixels")
        }
        (_, Some(bits)) if bits != 8 => PictureError::Unsupported {
            format: FORMAT,
            what: format!("a picture of {bits} bits per sample"),
            advice: "convert it to PNG or TIFF of 16 bits, for instance with djpeg of libjpeg-turbo 3 (djpeg -pnm in.jpg > \
                     out.ppm, which Bilux reads)",
        },
        (DecodeErrors::Unsupported(_), _) => PictureError::Unsupported {
            format: FORMAT,
            what: "arithmetic coding or lossless compression".to_owned(),
            advice: "save it as an ordinary JPEG, baseline or progressive",
        },
        (other, _) => PictureError::invalid(FORMAT, meaning(&other.to_string(), PHRASES)),
    }
}

/// The number of bits of a sample, as the frame header gives it.
fn bits_per_sample(bytes: &[u8]) -> Option<u8> {
    segments(bytes).find(|segment| is_frame(segment.marker))?.body.first().copied()
}

/// True for a file whose scans add detail to the same pixels.
pub(in super::super) fn is_progressive(bytes: &[u8]) -> bool {
    segments(bytes).any(|segment| matches!(segment.marker, 0xc2 | 0xc6 | 0xca | 0xce))
}

/// True for a file of a single scan that nothing interrupts, so that one block follows the other.
pub(in super::super) fn is_one_scan(bytes: &[u8]) -> bool {
    let restarts = segments(bytes).any(|segment| segment.marker == 0xdd);
    let frame = segments(bytes).find(|segment| is_frame(segment.marker));
    let scan = segments(bytes).find(|segment| segment.marker == SCAN);
    let components = frame.and_then(|frame| frame.body.get(5).copied());
    !restarts && components.is_some() && components == scan.and_then(|scan| scan.body.first().copied())
}

/// True when an end marker follows the first scan. Segments before it are skipped, since the thumbnail in one of them
/// may contain an end marker of its own.
pub(in super::super) fn is_whole(bytes: &[u8]) -> bool {
    let pixels = segments(bytes).last().map_or(2, |segment| segment.end);
    bytes.get(pixels..).is_some_and(|scan| scan.windows(2).any(|pair| pair == [0xff, 0xd9]))
}

/// The bytes without a contradiction: a file of JFIF has luma and chroma, whatever Adobe's segment says. [JFIF 1.02]
pub(in super::super) fn as_jfif(bytes: &[u8]) -> Cow<'_, [u8]> {
    let (mut is_jfif, mut transform, mut components) = (false, None, 0);
    for Segment { marker, body, end } in segments(bytes) {
        match marker {
            0xe0 => is_jfif |= body.starts_with(b"JFIF\0"),
            // The name, a version, twice two bytes of flags, and how colours are stored.
            0xee if body.starts_with(b"Adobe") && body.get(11) == Some(&0) => {
                transform = Some(end - body.len() + 11);
            }
            frame if is_frame(frame) => components = body.get(5).copied().unwrap_or(0),
            _ => {}
        }
    }
    match transform {
        Some(at) if is_jfif && components == 3 => {
            let mut bytes = bytes.to_vec();
            bytes[at] = 1;
            Cow::Owned(bytes)
        }
        _ => Cow::Borrowed(bytes),
    }
}

/// The marker of a scan's header.
const SCAN: u8 = 0xda;

/// True for the markers of frame headers.
fn is_frame(marker: u8) -> bool {
    matches!(marker, 0xc0..=0xcf) && !matches!(marker, 0xc4 | 0xc8 | 0xcc)
}

struct Segment<'b> {
    marker: u8,
    /// Bytes after the length.
    body: &'b [u8],
    /// The offset of what follows it.
    end: usize,
}

/// The segments up to the first scan.
fn segments(bytes: &[u8]) -> impl Iterator<Item = Segment<'_>> {
    let (mut at, mut is_done) = (2, false);
    std::iter::from_fn(move || {
        while let Some(&[0xff, marker]) = bytes.get(at..at + 2).filter(|_| !is_done) {
            if marker == 0xff || matches!(marker, 0x01 | 0xd0..=0xd9) {
                at += if marker == 0xff { 1 } else { 2 };
                continue;
            }
            let length = usize::from(*bytes.get(at + 2)?) << 8 | usize::from(*bytes.get(at + 3)?);
            let body = bytes.get(at + 4..at + 2 + length)?;
            (at, is_done) = (at + 2 + length, marker == SCAN);
            return Some(Segment { marker, body, end: at });
        }
        None
    })
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
