//! TIFF, read only: a format of scans, maps and film textures. [TIFF 6.0]

use super::PictureFormatEntry;
use super::faults::tiff::{colours, explain, unsupported};
use super::guard::guarded;
use super::icc;
use super::meaning::Meaning;
use super::orientation::Orientation;
use super::rgba8::Interleaved;
use crate::limits::{reserved, zeroed};
use crate::{Alpha, ColourSpace, Limits, Picture, PictureError};
use bilux_math::registry::Entry;
use std::io::Cursor;
use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult};
use tiff::tags::{SampleFormat, Tag};

/// The row of `tiff`.
pub(super) const ENTRY: PictureFormatEntry = PictureFormatEntry {
    entry: Entry {
        name: "tiff",
        summary: "integers of 1 to 32 bits, sRGB; floats of 16 to 64 bits, linear; with alpha; Deflate, LZW, PackBits \
                  or no compression; only the first image: read only",
        source: "TIFF 6.0",
        parameters: &[],
    },
    extensions: &["tif", "tiff"],
    for_display: true,
    holds_alpha: false,
    sniff: |bytes| [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"].into_iter().any(|mark| bytes.starts_with(mark)),
    read: |bytes, limits| guarded(FORMAT, || read(bytes, limits)),
    read_stored: Some(|bytes, limits| guarded(FORMAT, || Ok(read_stored(bytes, limits)?.0))),
    read_crop: None,
    read_interleaved: Some(|bytes, limits| guarded(FORMAT, || read_interleaved(bytes, limits))),
    write: None,
};

const FORMAT: &str = "TIFF";

/// Upper bound on the compression ratio: no memory is taken for pixels that a file is too short to hold.
const MAX_COMPRESSION_RATIO: u64 = 4096;

/// More channels than any picture has, including those that are ignored.
const MAX_CHANNELS: u16 = 64;

/// The value of `FillOrder` where bytes begin with their lowest bit. [TIFF 6.0]
const LOWEST_BIT_FIRST: u16 = 2;

/// Whether the colours are multiplied by alpha.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Opacity {
    None,
    Straight,
    Premultiplied,
}

/// Samples as they are stored, and their layout.
struct Decoded {
    width: usize,
    height: usize,
    samples: DecodingResult,
    /// Bits per sample in the file.
    bits: u8,
    /// The number of channels, and those that are used: one or three colours, followed by alpha.
    channels: usize,
    colours: usize,
    opacity: Opacity,
    /// Whether each channel is stored separately.
    in_planes: bool,
    /// The corner in which the first pixel is, from 1 to 8.
    orientation: u16,
    /// Meaning of the samples, unless they are floats.
    meaning: Meaning,
}

/// True when no text of the first directory claims to be longer than the file. The decoder allocates memory for the
/// claimed length, and prints a complaint on the terminal. [TIFF 6.0, section 2]
fn texts_fit(bytes: &[u8]) -> bool {
    const TEXT: u64 = 2;
    let number = |at: usize, size: usize| -> Option<u64> {
        let part = bytes.get(at..at.checked_add(size)?)?;
        let join = |all: u64, byte: &u8| all << 8 | u64::from(*byte);
        Some(if bytes.starts_with(b"II") {
            part.iter().rev().fold(0, join)
        } else {
            part.iter().fold(0, join)
        })
    };
    let is_big = number(2, 2) == Some(43);
    // Sizes of an offset, of the number of entries, and of an entry.
    let (offset, count, each) = if is_big { (8, 8, 20) } else { (4, 2, 12) };
    let start = number(offset, offset).and_then(|start| usize::try_from(start).ok());
    let Some(start) = start.filter(|start| *start < bytes.len()) else { return true };
    let entries = number(start, count).unwrap_or(0).min((bytes.len() / each) as u64) as usize;
    (0..entries).all(|entry| {
        let at = start + count + entry * each;
        number(at + 2, 2) != Some(TEXT) || number(at + 4, offset).is_none_or(|n| n <= bytes.len() as u64)
    })
}

fn decode(bytes: &[u8], limits: &Limits) -> Result<Decoded, PictureError> {
    if !texts_fit(bytes) {
        return Err(PictureError::truncated(FORMAT, "a text"));
    }
    // The maximum size of the unpacked bytes also bounds what a stated length may request.
    let most = u64::try_from(bytes.len()).unwrap_or(u64::MAX).saturating_mul(MAX_COMPRESSION_RATIO);
    let memory = usize::try_from(limits.max_bytes.min(most)).unwrap_or(usize::MAX);
    let mut own = tiff::decoder::Limits::default();
    own.decoding_buffer_size = memory;
    own.intermediate_buffer_size = memory;
    own.ifd_value_size = own.ifd_value_size.min(memory);
    let mut decoder =
        Decoder::new(Cursor::new(bytes)).map_err(|error| explain(error, bytes))?.with_limits(own);
    let (width, height) = decoder.dimensions().map_err(|error| explain(error, bytes))?;
    let kind = decoder.colortype().map_err(|error| explain(error, bytes))?;
    let bits = kind.bit_depth();
    let order = decoder.find_tag_unsigned::<u16>(Tag::FillOrder).map_err(|error| explain(error, bytes))?;
    if bits < 8 && order == Some(LOWEST_BIT_FIRST) {
        let what = "the first pixel of its bytes is in the lowest bit (FillOrder 2), which cannot be read";
        return Err(PictureError::invalid(FORMAT, what));
    }
    let extra = decoder
        .find_tag_unsigned_vec::<u16>(Tag::ExtraSamples)
        .map_err(|error| explain(error, bytes))?
        .unwrap_or_default();
    let opacity = match extra.first() {
        Some(1) => Opacity::Premultiplied,
        Some(2) => Opacity::Straight,
        _ => Opacity::None,
    };
    let (channels, colours, opacity) = match kind {
        ColorType::Gray(_) => (1, 1, Opacity::None),
        ColorType::Multiband { num_samples, .. } => (num_samples, 1, opacity),
        ColorType::RGB(_) => (3, 3, Opacity::None),
        ColorType::RGBA(_) if opacity == Opacity::None => (4, 3, Opacity::Straight),
        ColorType::RGBA(_) => (4, 3, opacity),
        other => return Err(unsupported(colours(other).to_owned())),
    };
    if channels > MAX_CHANNELS || usize::from(channels) < colours + usize::from(opacity != Opacity::None) {
        return Err(PictureError::invalid(
            FORMAT,
            format!("it has {channels} channels, which is not possible"),
        ));
    }
    let each = u64::from(channels) * u64::from(bits.div_ceil(8));
    // Samples as they are stored, once more while they are unpacked, and our own four planes.
    limits.check(FORMAT, width.into(), height.into(), 2 * each + 4 * 4)?;
    // A tile is unpacked whole, even if only little of it is visible.
    let (across, down) = decoder.chunk_dimensions();
    limits.check(FORMAT, across.into(), down.min(height).into(), each)?;
    let pixel_bits = u64::from(channels) * u64::from(bits);
    let stored = (u64::from(width) * u64::from(height)).saturating_mul(pixel_bits) / 8;
    if stored > most {
        return Err(PictureError::truncated(FORMAT, "the pixels"));
    }
    let orientation = decoder
        .find_tag_unsigned::<u16>(Tag::Orientation)
        .map_err(|error| explain(error, bytes))?
        .unwrap_or(1);
    // A damaged profile says nothing.
    let profile = decoder.find_tag(Tag::IccProfile).ok().flatten().and_then(|value| value.into_u8_vec().ok());
    let meaning = icc::meaning_or_srgb(profile.as_deref());
    let mut samples = DecodingResult::U8(Vec::new());
    let layout = decoder.read_image_to_buffer(&mut samples).map_err(|error| explain(error, bytes))?;
    if layout.sample_format == SampleFormat::Int {
        return Err(unsupported("a picture with signed integers".to_owned()));
    }
    let (width, height, channels) = (width as usize, height as usize, usize::from(channels));
    let in_planes = layout.planes > 1;
    let mut decoded =
        Decoded { width, height, samples, bits, channels, colours, opacity, in_planes, orientation, meaning };
    decoded.unpack_bits()?;
    Ok(decoded)
}

impl Decoded {
    /// Expands samples of fewer than 8 bits to bytes of 0 to 255.
    fn unpack_bits(&mut self) -> Result<(), PictureError> {
        let DecodingResult::U8(packed) = &self.samples else { return Ok(()) };
        let bits = usize::from(self.bits);
        if bits >= 8 {
            return Ok(());
        }
        // Every row starts at a byte boundary.
        let across = if self.in_planes { self.width } else { self.width * self.channels };
        let row = (across * bits).div_ceil(8);
        let most = (1u32 << bits) - 1;
        let mut bytes: Vec<u8> = reserved(FORMAT, self.width * self.height * self.channels)?;
        for row in packed.chunks_exact(row) {
            bytes.extend((0..across).map(|i| {
                // Bit by bit: the bits of a three-bit sample may straddle two bytes.
                let bit = |at: usize| u32::from(row[at / 8] >> (7 - at % 8) & 1);
                let sample = (i * bits..(i + 1) * bits).fold(0, |sample, at| sample << 1 | bit(at));
                (sample * 255 / most) as u8
            }));
        }
        self.samples = DecodingResult::U8(bytes);
        Ok(())
    }

    /// The index of a sample, from its channel and its pixel.
    fn place(&self, channel: usize, pixel: usize) -> usize {
        if self.in_planes {
            channel * self.width * self.height + pixel
        } else {
            pixel * self.channels + channel
        }
    }

    /// The picture's size, and which pixel of the file each of its pixels is.
    fn turned(&self) -> ([usize; 2], impl Fn(usize) -> usize) {
        Orientation::of(self.orientation).turned([self.width, self.height])
    }

    /// The channels that are used.
    fn taken(&self) -> usize {
        self.colours + usize::from(self.opacity != Opacity::None)
    }

    /// A plane of numbers.
    fn plane(&self, channel: usize) -> Result<Vec<f32>, PictureError> {
        let pixels = self.width * self.height;
        let mut plane = zeroed(FORMAT, pixels)?;
        let (_, turned) = self.turned();
        let at = |pixel: usize| self.place(channel, turned(pixel));
        let mut fill = |sample: &dyn Fn(usize) -> Option<f32>| {
            plane.iter_mut().enumerate().try_for_each(|(pixel, number)| {
                *number = sample(at(pixel))?;
                Some(())
            })
        };
        let filled = match &self.samples {
            DecodingResult::U8(all) => fill(&|i| all.get(i).map(|&s| f32::from(s) / 255.0)),
            DecodingResult::U16(all) => fill(&|i| all.get(i).map(|&s| f32::from(s) / 65535.0)),
            DecodingResult::U32(all) => {
                fill(&|i| all.get(i).map(|&s| (f64::from(s) / f64::from(u32::MAX)) as f32))
            }
            DecodingResult::F16(all) => fill(&|i| all.get(i).map(|s| s.to_f32())),
            DecodingResult::F32(all) => fill(&|i| all.get(i).copied()),
            DecodingResult::F64(all) => fill(&|i| all.get(i).map(|&s| s as f32)),
            _ => return Err(unsupported("a picture with 64-bit integers".to_owned())),
        };
        filled.map(|()| plane).ok_or_else(|| PictureError::truncated(FORMAT, "the pixels"))
    }

    fn is_light(&self) -> bool {
        matches!(self.samples, DecodingResult::F16(_) | DecodingResult::F32(_) | DecodingResult::F64(_))
    }
}

/// See [`super::read_interleaved`]; `None` for samples of more bits, or with premultiplied alpha.
fn read_interleaved(bytes: &[u8], limits: &Limits) -> Result<Option<Interleaved>, PictureError> {
    let decoded = decode(bytes, limits)?;
    let DecodingResult::U8(all) = &decoded.samples else { return Ok(None) };
    if decoded.opacity == Opacity::Premultiplied || !decoded.meaning.is_srgb() {
        return Ok(None);
    }
    let ([width, height], turned) = decoded.turned();
    let mut samples = reserved(FORMAT, width * height * decoded.taken())?;
    for pixel in (0..width * height).map(turned) {
        let part = (0..decoded.taken()).map(|channel| all.get(decoded.place(channel, pixel)).copied());
        samples.extend(part.map(|sample| sample.unwrap_or(0)));
    }
    Ok(Some(Interleaved::new(width, height, samples)))
}

fn read(bytes: &[u8], limits: &Limits) -> Result<Picture, PictureError> {
    let (mut picture, meaning) = read_stored(bytes, limits)?;
    // Floats are light already.
    if picture.colour_space != ColourSpace::LinearRec709 {
        meaning.apply(&mut picture);
    }
    Ok(picture)
}

fn read_stored(bytes: &[u8], limits: &Limits) -> Result<(Picture, Meaning), PictureError> {
    let decoded = decode(bytes, limits)?;
    let ([width, height], _) = decoded.turned();
    let mut picture = Picture::new(width, height)?;
    let names: &[&str] = if decoded.colours == 1 { &["Y"] } else { &["R", "G", "B"] };
    let mut planes =
        (0..decoded.taken()).map(|channel| decoded.plane(channel)).collect::<Result<Vec<_>, _>>()?;
    let is_light = decoded.is_light();
    picture.colour_space = if is_light { ColourSpace::LinearRec709 } else { ColourSpace::Srgb };
    let is_multiplied = decoded.opacity == Opacity::Premultiplied;
    picture.alpha = if is_light && is_multiplied { Alpha::Premultiplied } else { Alpha::Straight };
    let alpha = if decoded.opacity == Opacity::None { None } else { planes.pop() };
    if let Some(alpha) = alpha.as_ref().filter(|_| is_multiplied && !is_light) {
        // Encoded colours are multiplied as they are.
        for (colour, alpha) in planes.iter_mut().flat_map(|plane| plane.iter_mut().zip(alpha)) {
            *colour = if *alpha > 0.0 { (*colour / alpha).min(1.0) } else { *colour };
        }
    }
    for (name, plane) in names.iter().zip(planes) {
        picture.push_channel(*name, plane)?;
    }
    if let Some(alpha) = alpha {
        picture.push_channel("A", alpha)?;
    }
    Ok((picture, decoded.meaning))
}
