//! WebP, read only: textures come in it.

use super::PictureFormatEntry;
use super::faults::webp::explain;
use super::guard::guarded;
use super::rgba8::Interleaved;
use crate::limits::zeroed;
use crate::{Limits, PictureError};
use bilux_math::registry::Entry;
use image_webp::WebPDecoder;
use std::io::Cursor;

/// The row of `webp`.
pub(super) const ENTRY: PictureFormatEntry = PictureFormatEntry {
    entry: Entry { name: "webp", summary: "8 bits, sRGB: read only", source: "WebP", parameters: &[] },
    extensions: &["webp"],
    for_display: true,
    sniff: |bytes| bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP"),
    read: |bytes, limits| guarded(FORMAT, || decode(bytes, limits)?.picture(FORMAT)),
    read_rgba8: Some(|bytes, limits| guarded(FORMAT, || Ok(decode(bytes, limits)?.rgba8()))),
    write: None,
};

const FORMAT: &str = "WebP";

/// Decoded bytes, as many in the decoder's own planes, and four planes of ours.
const BYTES_PER_PIXEL: u64 = 4 + 8 + 4 * 4;

/// The first picture of one that moves.
fn decode(bytes: &[u8], limits: &Limits) -> Result<Interleaved, PictureError> {
    let mut decoder = WebPDecoder::new(Cursor::new(bytes)).map_err(|error| explain(&error, bytes))?;
    decoder.set_memory_limit(usize::try_from(limits.max_bytes).unwrap_or(usize::MAX));
    let (width, height) = decoder.dimensions();
    let pixels = limits.check(FORMAT, width.into(), height.into(), BYTES_PER_PIXEL)?;
    let size = pixels
        .checked_mul(if decoder.has_alpha() { 4 } else { 3 })
        .filter(|&size| decoder.output_buffer_size() == Some(size));
    let size =
        size.ok_or_else(|| PictureError::invalid(FORMAT, "its header says a size that its pixels have not"))?;
    let mut samples = zeroed::<u8>(FORMAT, size)?;
    decoder.read_image(&mut samples).map_err(|error| explain(&error, bytes))?;
    Ok(Interleaved { width: width as usize, height: height as usize, samples })
}
