//! JPEG: a format for textures, and for pictures on the web. [JPEG]

use super::faults::jpeg::{as_jfif, explain, is_one_scan, is_progressive, is_whole};
use super::guard::guarded;
use super::icc;
use super::meaning::Meaning;
use super::orientation::Orientation;
use super::rgba8::Interleaved;
use super::{BitDepth, PictureFormatEntry, Source, WriteOptions, check_sides};
use crate::limits::reserved;
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

const FORMAT: &str = "JPEG";

/// Decoded bytes, the coefficients of progressive files for up to four components, and three planes; the bytes once more
/// while a picture is turned.
const BYTES_PER_PIXEL: u64 = 4 + 4 * 2 + 3 * 4;

fn read(bytes: &[u8], limits: &Limits) -> Result<Picture, PictureError> {
    let (stored, meaning) = decode(bytes, limits)?;
    let mut picture = stored.picture(FORMAT)?;
    meaning.apply(&mut picture);
    Ok(picture)
}

/// The bytes of one or three channels, as they are shown, and what they mean. Of a file that was cut short, what is there.
fn decode(bytes: &[u8], limits: &Limits) -> Result<(Interleaved, Meaning), PictureError> {
    let bytes = &*as_jfif(bytes);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options());
    decoder.decode_headers().map_err(|error| explain(&error, bytes))?;
    let info = decoder.info().ok_or_else(|| PictureError::invalid(FORMAT, "it has no frame header"))?;
    let pixels = limits.check(FORMAT, info.width.into(), info.height.into(), BYTES_PER_PIXEL)?;
    let grey = decoder.input_colorspace() == Some(ColorSpace::Luma);
    let (channels, space) = if grey { (1, ColorSpace::Luma) } else { (3, ColorSpace::RGB) };
    let warnings = if is_whole(bytes) { Vec::new() } else { vec![loss(bytes, space, info.height.into())?] };
    decoder.set_options(options().jpeg_set_out_colorspace(space));
    let mut samples = decoder.decode().map_err(|error| explain(&error, bytes))?;
    if samples.len() < pixels.saturating_mul(channels) {
        return Err(PictureError::truncated(FORMAT, "the pixels"));
    }
    samples.truncate(pixels * channels);
    let orientation = decoder.exif().map_or(Orientation::of(1), |data| Orientation::of_exif(data));
    let (width, height) = (info.width.into(), info.height.into());
    let stored = Interleaved { warnings, ..Interleaved::new(width, height, samples) };
    let meaning = icc::meaning_or_srgb(decoder.icc_profile().as_deref());
    Ok((orientation.apply(FORMAT, stored)?, meaning))
}

fn options() -> DecoderOptions {
    DecoderOptions::default().set_max_width(usize::from(u16::MAX)).set_max_height(usize::from(u16::MAX))
}

/// Loss of a file without an end marker, in words: the rows that would be others if other bytes followed.
///
/// # Errors
/// If it lacks all of its pixels.
fn loss(bytes: &[u8], space: ColorSpace, height: usize) -> Result<String, PictureError> {
    if is_progressive(bytes) {
        // Any number of scans may be missing.
        return Ok(
            "JPEG: the file has no end marker: if it was cut short, its picture lacks detail".to_owned()
        );
    }
    let continued = |with: u8, strictly: bool| {
        let mut whole: Vec<u8> = reserved(FORMAT, bytes.len() + CONTINUED + 2)?;
        whole.extend_from_slice(bytes);
        whole.extend([with; CONTINUED]);
        whole.extend([0xff, 0xd9]);
        let options = options().jpeg_set_out_colorspace(space).set_strict_mode(strictly);
        let decoded = JpegDecoder::new_with_options(ZCursor::new(&whole[..]), options).decode();
        decoded.map_err(|error| explain(&error, bytes))
    };
    let one = continued(0, false)?;
    let mut first = one.len();
    let mut is_complete = true;
    for with in [0x55, 0xaa, 0xe7, 0x1c] {
        let other = continued(with, false)?;
        first = first.min(one.iter().zip(&other).position(|(a, b)| a != b).unwrap_or(one.len()));
        // A code that does not exist ends the picture early, whatever follows it.
        is_complete &= continued(with, true).is_ok();
    }
    if first == one.len() && is_complete && is_one_scan(bytes) {
        return Ok("JPEG: the file has no end marker, but all of its pixels are there".to_owned());
    }
    if first == one.len() {
        return Ok("JPEG: the file has no end marker: if it was cut short, rows or details are missing: copy it or save it \
                   again"
            .to_owned());
    }
    let right = first / (one.len() / height.max(1)).max(1);
    if right == 0 {
        return Err(PictureError::truncated(FORMAT, "the pixels"));
    }
    Ok(format!(
        "JPEG: the file was cut short, and the last {} of its {height} rows are missing or wrong: copy it or save it again",
        height - right.min(height)
    ))
}

/// Number of bytes that are tried in place of missing ones: enough for a difference in the first block.
const CONTINUED: usize = 64;

/// Baseline JPEG, which every program reads. Chroma has full resolution from a quality of 90 on, and half below.
fn write(picture: Source, options: &WriteOptions) -> Result<Vec<u8>, PictureError> {
    let unwritable = |error: jpeg_encoder::EncodingError| PictureError::Unwritable {
        format: FORMAT,
        what: error.to_string(),
    };
    let [width, height] = check_sides(FORMAT, picture, usize::from(u16::MAX))?;
    let shown = picture.opaque(FORMAT, &WriteOptions { bit_depth: BitDepth::Eight, ..*options })?;
    let colours = if shown.names.len() == 1 { ColorType::Luma } else { ColorType::Rgb };
    let mut bytes = Vec::new();
    let encoder = Encoder::new(&mut bytes, options.quality.clamp(1, 100));
    encoder.encode(&shown.samples, width, height, colours).map_err(unwritable)?;
    Ok(bytes)
}
