//! KTX2, read only: textures of glTF files, compressed by Basis Universal. [KTX 2.0]

use super::PictureFormatEntry;
use super::faults::ktx2::explain;
use super::guard::guarded;
use super::rgba8::Interleaved;
use crate::{Alpha, ColourSpace, Limits, Picture, PictureError};
use basisu::{DecodeFlags, TargetFormat, Transcoder};
use bilux_math::registry::Entry;

/// The row of `ktx2`.
pub(super) const ENTRY: PictureFormatEntry = PictureFormatEntry {
    entry: Entry {
        name: "ktx2",
        summary: "8 bits, sRGB or linear, uncompressed or with Basis Universal: read only",
        source: "KTX 2.0",
        parameters: &[],
    },
    extensions: &["ktx2"],
    for_display: true,
    holds_alpha: false,
    sniff: |bytes| bytes.starts_with(MAGIC),
    read: |bytes, limits| guarded(FORMAT, || read(bytes, limits)),
    read_stored: None,
    read_crop: None,
    read_interleaved: Some(|bytes, limits| guarded(FORMAT, || read_interleaved(bytes, limits))),
    write: None,
};

const FORMAT: &str = "KTX2";
const MAGIC: &[u8] = b"\xabKTX 20\xbb\r\n\x1a\n";

/// Basis Universal or plain pixels, an unpacked level, and our own four planes.
const BYTES_PER_PIXEL: u64 = 4 + 4 + 4 * 4;

/// Facts of a file that are known before anything is unpacked.
struct Header<'a> {
    width: usize,
    height: usize,
    is_srgb: bool,
    is_premultiplied: bool,
    pixels: Pixels<'a>,
    /// Directions of columns and rows, if the file states them: `r` or `l`, and `d` or `u`.
    orientation: Option<&'a [u8]>,
    /// The channels of the file that red, green, blue and alpha are, if it says so.
    swizzle: Option<&'a [u8]>,
}

/// Storage of pixels in the file.
enum Pixels<'a> {
    /// One to four bytes per pixel.
    Plain(&'a [u8]),
    /// Compressed by Basis Universal.
    Packed { has_alpha: bool },
}

/// Colour models of the format's descriptor. [KTX 2.0]
const ETC1S: u8 = 163;
const UASTC: u8 = 166;
/// The flag of colours that have been multiplied by alpha. [Khronos Data Format 1.3, 5.8]
const PREMULTIPLIED: u8 = 1;

fn u32_at(bytes: &[u8], at: usize) -> Result<u32, PictureError> {
    let four = bytes.get(at..).and_then(|rest| rest.first_chunk::<4>());
    four.map(|four| u32::from_le_bytes(*four)).ok_or_else(|| PictureError::truncated(FORMAT, "the header"))
}

fn u64_at(bytes: &[u8], at: usize) -> Result<u64, PictureError> {
    Ok(u64::from(u32_at(bytes, at)?) | u64::from(u32_at(bytes, at + 4)?) << 32)
}

/// True when a key table that starts at this byte of the file ends where its last key does, padded to a multiple of 4
/// bytes. Otherwise the decoder would read beyond it.
fn are_whole(keys: &[u8], start: usize) -> bool {
    let mut at = 0;
    while keys.len().saturating_sub(at) > 4 {
        let Ok(length) = u32_at(keys, at) else { return false };
        // A length that is too large ends the decoder's search.
        if length < 2 || length as usize > keys.len() - at - 4 {
            return true;
        }
        at = (start + at + 4 + length as usize).next_multiple_of(4) - start;
    }
    at <= keys.len()
}

/// The value of a key.
fn value<'a>(keys: &'a [u8], name: &[u8]) -> Option<&'a [u8]> {
    let mut rest = keys;
    loop {
        let length = u32_at(rest, 0).ok()? as usize;
        let pair = rest.get(4..4usize.checked_add(length)?)?;
        if let Some(value) = pair.strip_prefix(name).and_then(|value| value.strip_prefix(b"\0")) {
            return Some(value);
        }
        rest = rest.get((4 + length).next_multiple_of(4)..)?;
    }
}

/// The bytes at an offset and length that the file states.
fn part<'a>(bytes: &'a [u8], [offset, length]: [u64; 2], what: &str) -> Result<&'a [u8], PictureError> {
    let end = offset.checked_add(length).and_then(|end| usize::try_from(end).ok());
    let start = usize::try_from(offset).ok();
    let found = start.zip(end).and_then(|(start, end)| bytes.get(start..end));
    found.ok_or_else(|| PictureError::truncated(FORMAT, what))
}

impl<'a> Header<'a> {
    /// Checks everything for which a decoder will allocate memory.
    fn read(bytes: &'a [u8], limits: &Limits) -> Result<Header<'a>, PictureError> {
        let invalid = |what: String| Err(PictureError::invalid(FORMAT, what));
        let [kind, width, height, depth, layers, faces, levels, scheme] = {
            let at = [12, 20, 24, 28, 32, 36, 40, 44].map(|at| u32_at(bytes, at));
            let mut all = [0; 8];
            for (slot, number) in all.iter_mut().zip(at) {
                *slot = number?;
            }
            all
        };
        let pixels = limits.check(FORMAT, width.into(), height.into(), BYTES_PER_PIXEL)?;
        if depth > 1 || layers > 1 || faces != 1 {
            return invalid("it has layers, faces or depth, but only flat pictures can be read".to_owned());
        }
        if levels > 32 {
            return invalid(format!("it has {levels} mipmap levels, but at most 32 are possible"));
        }
        let descriptor =
            part(bytes, [u32_at(bytes, 48)?.into(), u32_at(bytes, 52)?.into()], "its description")?;
        let [model, transfer, flags] = [12, 14, 15].map(|at| descriptor.get(at).copied().unwrap_or(0));
        let keys = part(bytes, [u32_at(bytes, 56)?.into(), u32_at(bytes, 60)?.into()], "its keys")?;
        if !are_whole(keys, u32_at(bytes, 56)? as usize) {
            return Err(PictureError::truncated(FORMAT, "its keys"));
        }
        part(bytes, [u64_at(bytes, 64)?, u64_at(bytes, 72)?], "its tables")?;
        let mut first = &bytes[..0];
        for level in 0..levels.max(1) as usize {
            let at = 80 + 24 * level;
            let packed = part(bytes, [u64_at(bytes, at)?, u64_at(bytes, at + 8)?], "a level")?;
            // A level unpacks to one byte per pixel, in whole blocks of 4 x 4.
            let most = (u64::from(width) + 3) * (u64::from(height) + 3) * 4;
            if u64_at(bytes, at + 16)? > most {
                return invalid(format!("level {level} has more bytes than its pixels can have"));
            }
            if level == 0 {
                first = packed;
            }
        }
        let pixels = match (kind, model) {
            (0, ETC1S | UASTC) if scheme <= 2 => {
                // Where pixels have alpha, a second sample says so, or a channel of the only sample.
                let has_alpha = match model {
                    ETC1S => descriptor.len() > 44,
                    _ => matches!(descriptor.get(31).map(|channel| channel & 15), Some(3 | 5)),
                };
                Pixels::Packed { has_alpha }
            }
            _ if scheme == 0 && channels_of(kind).is_some() => {
                let channels = channels_of(kind).unwrap_or(1);
                let bytes = first.get(..pixels * channels);
                let bytes = bytes.ok_or_else(|| PictureError::truncated(FORMAT, "the pixels"))?;
                Pixels::Plain(bytes)
            }
            _ => {
                return invalid(format!(
                    "pixels of VkFormat {kind}, colour model {model}, scheme {scheme} cannot be read; Basis Universal \
                     (ETC1S and UASTC) and uncompressed pixels of 8 bits can"
                ));
            }
        };
        let (width, height) = (width as usize, height as usize);
        Ok(Header {
            width,
            height,
            is_srgb: transfer != 1,
            is_premultiplied: flags & PREMULTIPLIED != 0,
            pixels,
            orientation: value(keys, b"KTXorientation"),
            swizzle: value(keys, b"KTXswizzle").filter(|swizzle| !swizzle.starts_with(b"rgba")),
        })
    }

    fn unpacked(&self, bytes: &[u8]) -> Result<Interleaved, PictureError> {
        let samples = match self.pixels {
            Pixels::Plain(bytes) => bytes.to_vec(),
            Pixels::Packed { has_alpha } => {
                let transcoder = Transcoder::new(bytes).map_err(explain)?;
                let mut samples =
                    transcoder.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE).map_err(explain)?;
                if samples.len() != self.width * self.height * 4 {
                    return Err(PictureError::truncated(FORMAT, "the pixels"));
                }
                if !has_alpha {
                    samples.iter_mut().skip(3).step_by(4).for_each(|alpha| *alpha = 255);
                }
                samples
            }
        };
        let mut whole = Interleaved::new(self.width, self.height, samples);
        if let Some(swizzle) = self.swizzle {
            whole.samples = swizzled(&whole.samples, whole.channels(), swizzle);
        }
        if let Some([x, y, ..]) = self.orientation {
            whole.flip(*x == b'l', *y == b'u');
        }
        Ok(whole)
    }
}

/// Four channels, each of which is one of the file's, or 0 or 1. A file without green, blue or alpha has 0, 0 and 1. [KTX 2.0, 5.7]
fn swizzled(samples: &[u8], channels: usize, swizzle: &[u8]) -> Vec<u8> {
    let stored =
        |pixel: &[u8], channel: usize| pixel.get(channel).copied().unwrap_or([0, 0, 0, 255][channel]);
    let letter = |channel: usize| swizzle.get(channel).copied().unwrap_or(b"rgba"[channel]);
    let one = |pixel: &[u8], channel: usize| match letter(channel) {
        b'r' => stored(pixel, 0),
        b'g' => stored(pixel, 1),
        b'b' => stored(pixel, 2),
        b'a' => stored(pixel, 3),
        b'1' => 255,
        _ => 0,
    };
    samples
        .chunks_exact(channels.max(1))
        .flat_map(|pixel| [0, 1, 2, 3].map(|channel| one(pixel, channel)))
        .collect()
}

/// Bytes per pixel of the supported plain formats: R8, R8G8B8 and R8G8B8A8, linear and sRGB. [KTX 2.0]
fn channels_of(kind: u32) -> Option<usize> {
    match kind {
        9 | 15 => Some(1),
        23 | 29 => Some(3),
        37 | 43 => Some(4),
        _ => None,
    }
}

/// See [`super::read_interleaved`]; `None` if the file says that its colours are linear, or multiplied by alpha.
fn read_interleaved(bytes: &[u8], limits: &Limits) -> Result<Option<Interleaved>, PictureError> {
    let header = Header::read(bytes, limits)?;
    let is_plain = header.is_srgb && !header.is_premultiplied;
    is_plain.then(|| header.unpacked(bytes)).transpose()
}

fn read(bytes: &[u8], limits: &Limits) -> Result<Picture, PictureError> {
    let header = Header::read(bytes, limits)?;
    let mut picture = header.unpacked(bytes)?.picture(FORMAT)?;
    if !header.is_srgb {
        picture.colour_space = ColourSpace::LinearRec709;
    }
    if header.is_premultiplied {
        picture.alpha = Alpha::Premultiplied;
    }
    Ok(picture)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// The picture from which another program made the seeds: ramps, and squares of 4 by 4 in blue.
    fn truth(x: usize, y: usize) -> [f32; 3] {
        let blue = if (x / 4 + y / 4) % 2 == 1 { 200.0 } else { 40.0 };
        [x as f32 / 19.0, y as f32 / 11.0, blue / 255.0]
    }

    fn seed(name: &str) -> Vec<u8> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/picture_ktx2");
        std::fs::read(folder.join(name)).unwrap()
    }

    #[test]
    fn files_packed_by_other_programs_decode_to_the_original() {
        for (name, most) in [
            ("uastc.ktx2", 0.02),
            ("uastc_zstd.ktx2", 0.02),
            ("uastc_alpha.ktx2", 0.05),
            ("uastc_linear.ktx2", 0.02),
            ("etc1s.ktx2", 0.12),
            ("etc1s_alpha.ktx2", 0.12),
            ("etc1s_mips.ktx2", 0.12),
        ] {
            let bytes = seed(name);
            let picture = read(&bytes, &Limits::default()).unwrap();
            assert_eq!((picture.width(), picture.height()), (20, 12), "{name}");
            let mut squares = 0.0;
            for (y, x) in (0..12).flat_map(|y| (0..20).map(move |x| (y, x))) {
                let alpha = if name.contains("alpha") && x >= 10 { 80.0 / 255.0 } else { 1.0 };
                assert!((picture.alpha_at(x, y) - alpha).abs() < 0.1, "{name}: {x}, {y}");
                let got = picture.rgb(x, y).to_array();
                let off = |c: usize| got[c] - truth(x, y)[c];
                squares += (0..3).map(|c| off(c) * off(c)).sum::<f32>();
            }
            let error = (squares / (3.0 * 240.0)).sqrt();
            assert!(error < most, "{name}: {error}");
            let at_once = read_interleaved(&bytes, &Limits::default()).unwrap();
            assert_eq!(at_once.is_none(), name.contains("linear"), "{name}");
        }
    }

    #[test]
    fn a_stated_size_takes_no_memory() {
        let limits = Limits::new(1 << 20);
        for name in ["broken_wide.ktx2", "broken_level_of_a_terabyte.ktx2", "broken_tables_far_away.ktx2"] {
            let error = Header::read(&seed(name), &limits).err().unwrap().to_string();
            assert!(error.starts_with("KTX2"), "{name}: {error}");
        }
    }
}
