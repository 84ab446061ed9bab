//! JPEG: a format for textures, and for pictures on the web. [JPEG]

use super::faults::jpeg::explain;
use super::guard::guarded;
use super::rgba8::Interleaved;
use super::{PictureFormatEntry, WriteOptions, check_sides, opaque_planes};
use crate::{Limits, Picture, PictureError};
use bilux_math::registry::Entry;
use jpeg_encoder::{ColorType, Encoder};
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// The row of `jpeg`.
pub(super) const ENTRY: PictureFormatEntry = PictureFormatEntry {
    entry: Entry {
        name: "jpeg",
        summary: "lossy, 8 bits, sRGB, without alpha: small files for the web",
        source: "JPEG",
        parameters: &[],
    },
    extensions: &["jpg", "jpeg", "jpe", "jfif"],
    for_display: true,
    holds_alpha: false,
    sniff: |bytes| bytes.starts_with(&[0xff, 0xd8, 0xff]),
    read: |bytes, limits| guarded(FORMAT, || decode(bytes, limits)?.picture(FORMAT)),
    read_rgba8: Some(|bytes, limits| guarded(FORMAT, || Ok(decode(bytes, limits)?.rgba8()))),
    write: Some(write),
};

const FORMAT: &str = "JPEG";

/// Decoded bytes, the coefficients of progressive files for up to four components, and three planes.
const BYTES_PER_PIXEL: u64 = 4 + 4 * 2 + 3 * 4;

/// The bytes of one or three channels.
fn decode(bytes: &[u8], limits: &Limits) -> Result<Interleaved, PictureError> {
    let options =
        DecoderOptions::default().set_max_width(usize::from(u16::MAX)).set_max_height(usize::from(u16::MAX));
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|error| explain(&error, bytes))?;
    let info = decoder.info().ok_or_else(|| PictureError::invalid(FORMAT, "it has no frame header"))?;
    let pixels = limits.check(FORMAT, info.width.into(), info.height.into(), BYTES_PER_PIXEL)?;
    // The decoder accepts whatever pixels there are; we report the missing ones instead.
    if !is_whole(bytes) {
        return Err(PictureError::truncated(FORMAT, "the pixels"));
    }
    let grey = decoder.input_colorspace() == Some(ColorSpace::Luma);
    let (channels, space) = if grey { (1, ColorSpace::Luma) } else { (3, ColorSpace::RGB) };
    decoder.set_options(options.jpeg_set_out_colorspace(space));
    let mut samples = decoder.decode().map_err(|error| explain(&error, bytes))?;
    if samples.len() < pixels.saturating_mul(channels) {
        return Err(PictureError::truncated(FORMAT, "the pixels"));
    }
    samples.truncate(pixels * channels);
    Ok(Interleaved { width: info.width.into(), height: info.height.into(), samples })
}

/// True when an end marker follows the first scan. Segments before it are skipped, since the thumbnail in one of them
/// may contain an end marker of its own.
fn is_whole(bytes: &[u8]) -> bool {
    let mut at = 2;
    while let Some([0xff, marker, high, low]) = bytes.get(at..at + 4) {
        at += match marker {
            0xff => 1,
            0x01 | 0xd0..=0xd9 => 2,
            _ => 2 + (usize::from(*high) << 8 | usize::from(*low)),
        };
        if *marker == 0xda {
            break;
        }
    }
    bytes.get(at..).is_some_and(|scan| scan.windows(2).any(|pair| pair == [0xff, 0xd9]))
}

/// Baseline JPEG, which every program reads. Chroma has full resolution from a quality of 90 on, and half below.
fn write(picture: &Picture, options: &WriteOptions) -> Result<Vec<u8>, PictureError> {
    let unwritable = |error: jpeg_encoder::EncodingError| PictureError::Unwritable {
        format: FORMAT,
        what: error.to_string(),
    };
    let [width, height] = check_sides(FORMAT, picture, usize::from(u16::MAX))?;
    let planes = opaque_planes(FORMAT, picture, options)?;
    let colours = if planes.names.len() == 1 { ColorType::Luma } else { ColorType::Rgb };
    let mut bytes = Vec::new();
    let encoder = Encoder::new(&mut bytes, options.quality.clamp(1, 100));
    encoder.encode(&planes.to_u8(&planes.names), width, height, colours).map_err(unwritable)?;
    Ok(bytes)
}
