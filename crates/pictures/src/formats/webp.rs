//! WebP: reads lossy and lossless files; writes lossless ones. [WebP]

use super::faults::webp::explain;
use super::guard::guarded;
use super::icc;
use super::meaning::Meaning;
use super::orientation::Orientation;
use super::rgba8::Interleaved;
use super::{BitDepth, PictureFormatEntry, Source, WriteOptions, check_sides};
use crate::limits::zeroed;
use crate::{Limits, Picture, PictureError};
use bilux_math::registry::Entry;
use image_webp::{ColorType, WebPDecoder, WebPEncoder};
use std::io::Cursor;

/// The row of `webp`.
pub(super) const ENTRY: PictureFormatEntry = PictureFormatEntry {
    entry: Entry {
        name: "webp",
        summary: "8 bits, sRGB, with alpha, written losslessly: smaller than PNG, for the web",
        source: "WebP",
        parameters: &[],
    },
    extensions: &["webp"],
    for_display: true,
    holds_alpha: true,
    sniff: |bytes| bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP"),
    read: |bytes, limits| guarded(FORMAT, || read(bytes, limits)),
    read_stored: Some(|bytes, limits| guarded(FORMAT, || decode(bytes, limits)?.0.picture(FORMAT))),
    read_crop: None,
    read_interleaved: Some(|bytes, limits| {
        guarded(FORMAT, || {
            let (stored, meaning) = decode(bytes, limits)?;
            Ok(meaning.is_srgb().then_some(stored))
        })
    }),
    write: Some(write),
};

const FORMAT: &str = "WebP";

/// Decoded bytes, as many in the decoder's own planes, and our own four planes; the bytes once more while a picture is
/// turned.
const BYTES_PER_PIXEL: u64 = 4 + 8 + 4 * 4;

fn read(bytes: &[u8], limits: &Limits) -> Result<Picture, PictureError> {
    let (stored, meaning) = decode(bytes, limits)?;
    let mut picture = stored.picture(FORMAT)?;
    meaning.apply(&mut picture);
    Ok(picture)
}

/// Reads the first frame of an animation, and what its samples mean.
fn decode(bytes: &[u8], limits: &Limits) -> Result<(Interleaved, Meaning), PictureError> {
    let mut decoder = WebPDecoder::new(Cursor::new(bytes)).map_err(|error| explain(&error, bytes))?;
    decoder.set_memory_limit(usize::try_from(limits.max_bytes).unwrap_or(usize::MAX));
    let (width, height) = decoder.dimensions();
    let pixels = limits.check(FORMAT, width.into(), height.into(), BYTES_PER_PIXEL)?;
    let size = pixels
        .checked_mul(if decoder.has_alpha() { 4 } else { 3 })
        .filter(|&size| decoder.output_buffer_size() == Some(size));
    let size =
        size.ok_or_else(|| PictureError::invalid(FORMAT, "its header and its pixels differ in size"))?;
    let mut samples = zeroed::<u8>(FORMAT, size)?;
    decoder.read_image(&mut samples).map_err(|error| explain(&error, bytes))?;
    // Damage in the metadata does not affect the picture.
    let exif = decoder.exif_metadata().ok().flatten().unwrap_or_default();
    let profile = decoder.icc_profile().ok().flatten();
    let stored = Interleaved::new(width as usize, height as usize, samples);
    Ok((Orientation::of_exif(&exif).apply(FORMAT, stored)?, icc::meaning_or_srgb(profile.as_deref())))
}

/// Longer sides do not fit in 14 bits.
const LONGEST_SIDE: usize = 1 << 14;

/// Lossless, which is all that the encoder supports.
fn write(picture: Source, options: &WriteOptions) -> Result<Vec<u8>, PictureError> {
    let unwritable = |error: image_webp::EncodingError| PictureError::Unwritable {
        format: FORMAT,
        what: error.to_string(),
    };
    let [width, height] = check_sides(FORMAT, picture, LONGEST_SIDE)?;
    let shown = picture.for_display(FORMAT, &WriteOptions { bit_depth: BitDepth::Eight, ..*options })?;
    let colours = match shown.names.len() {
        1 => ColorType::L8,
        2 => ColorType::La8,
        3 => ColorType::Rgb8,
        _ => ColorType::Rgba8,
    };
    let mut bytes = Vec::new();
    WebPEncoder::new(&mut bytes)
        .encode(&shown.samples, width.into(), height.into(), colours)
        .map_err(unwritable)?;
    Ok(bytes)
}
