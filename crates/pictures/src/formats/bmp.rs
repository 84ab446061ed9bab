//! BMP, read only: a texture format of older models. [BMP]

use super::PictureFormatEntry;
use super::guard::guarded;
use super::rgba8::Interleaved;
use crate::limits::zeroed;
use crate::{Limits, PictureError};
use bilux_math::registry::Entry;

/// The row of `bmp`.
pub(super) const ENTRY: PictureFormatEntry = PictureFormatEntry {
    entry: Entry {
        name: "bmp",
        summary: "8 bits, sRGB, with palettes, run-length encoding or alpha: read only",
        source: "BMP",
        parameters: &[],
    },
    extensions: &["bmp", "dib"],
    for_display: true,
    holds_alpha: false,
    sniff: |bytes| bytes.starts_with(b"BM"),
    read: |bytes, limits| guarded(FORMAT, || decode(bytes, limits)?.picture(FORMAT)),
    read_stored: None,
    read_crop: None,
    read_interleaved: Some(|bytes, limits| guarded(FORMAT, || decode(bytes, limits).map(Some))),
    write: None,
};

const FORMAT: &str = "BMP";

/// Samples, indices, and our own four planes.
const BYTES_PER_PIXEL: u64 = 4 + 1 + 4 * 4;

/// The contents of the headers.
struct Header {
    width: usize,
    height: usize,
    from_top: bool,
    /// Bits per pixel in the file.
    depth: u16,
    packing: Packing,
    palette: Vec<[u8; 3]>,
    /// Offset of the pixels.
    pixels: usize,
}

/// Packing of pixels.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Packing {
    /// Indices of `depth` bits each.
    Indices,
    /// Run-length encoded indices.
    Runs,
    /// Bits of red, green, blue and alpha.
    Masks([Mask; 4]),
}

/// Contiguous bits.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Mask {
    shift: u32,
    most: u32,
}

impl Mask {
    fn new(bits: u32) -> Result<Mask, PictureError> {
        let shift = bits.trailing_zeros() % 32;
        let most = bits >> shift;
        if most & most.wrapping_add(1) != 0 {
            let what = format!("the bits {bits:#010x} of a colour channel are not contiguous");
            return Err(PictureError::invalid(FORMAT, what));
        }
        Ok(Mask { shift, most })
    }

    /// The value scaled to 0..=255.
    fn of(self, pixel: u32) -> u8 {
        let most = u64::from(self.most);
        let part = u64::from(pixel >> self.shift) & most;
        (part * 255 + most / 2).checked_div(most).unwrap_or(0) as u8
    }
}

fn u16_at(bytes: &[u8], at: usize) -> Result<u16, PictureError> {
    let two = bytes.get(at..).and_then(|rest| rest.first_chunk::<2>());
    two.map(|two| u16::from_le_bytes(*two)).ok_or_else(|| PictureError::truncated(FORMAT, "the header"))
}

fn u32_at(bytes: &[u8], at: usize) -> Result<u32, PictureError> {
    Ok(u32::from(u16_at(bytes, at)?) | u32::from(u16_at(bytes, at + 2)?) << 16)
}

/// Size in bytes of the file header, which precedes the picture's header.
const FILE_HEADER: usize = 14;

impl Header {
    fn read(bytes: &[u8]) -> Result<Header, PictureError> {
        let invalid = |what: String| Err(PictureError::invalid(FORMAT, what));
        if !bytes.starts_with(b"BM") {
            return invalid("it does not begin with BM".to_owned());
        }
        let size = u32_at(bytes, FILE_HEADER)? as usize;
        // The first version has 16-bit numbers, and palette entries of three bytes.
        let is_first = size == 12;
        if !is_first && !(16..=124).contains(&size) {
            return invalid(format!(
                "its header says that it has {size} bytes, but must have 12, or 16 to 124"
            ));
        }
        let (width, height, depth) = if is_first {
            (u16_at(bytes, 18)?.into(), u16_at(bytes, 20)?.into(), u16_at(bytes, 24)?)
        } else {
            (u32_at(bytes, 18)?.cast_signed(), u32_at(bytes, 22)?.cast_signed(), u16_at(bytes, 28)?)
        };
        if width < 0 {
            return invalid(format!("the header says that it is {width} pixels wide"));
        }
        let compression = if size >= 20 { u32_at(bytes, 30)? } else { 0 };
        let packing = packing(bytes, compression, depth)?;
        let behind = match (size, compression) {
            (40, 3) => 12,
            (40, 6) => 16,
            _ => 0,
        };
        let mut header = Header {
            width: width.unsigned_abs() as usize,
            height: height.unsigned_abs() as usize,
            from_top: height < 0,
            depth,
            packing,
            palette: Vec::new(),
            pixels: u32_at(bytes, 10)? as usize,
        };
        if !matches!(packing, Packing::Masks(_)) {
            let stated = if size >= 36 { u32_at(bytes, 46)? as usize } else { 0 };
            let count = if stated == 0 { 1 << depth } else { stated.min(1 << depth) };
            let stored = bytes.get(FILE_HEADER + size + behind..header.pixels).unwrap_or_default();
            let each = if is_first { 3 } else { 4 };
            let colours = stored.chunks_exact(each).take(count).map(|entry| [entry[2], entry[1], entry[0]]);
            header.palette = colours.collect();
        }
        Ok(header)
    }
}

/// Packing of the pixels, with the bits of each channel.
fn packing(bytes: &[u8], compression: u32, depth: u16) -> Result<Packing, PictureError> {
    let masks = |bits: [u32; 4]| {
        let [r, g, b, a] = bits.map(Mask::new);
        Ok(Packing::Masks([r?, g?, b?, a?]))
    };
    match (compression, depth) {
        (0, 1 | 2 | 4 | 8) => Ok(Packing::Indices),
        (1, 8) | (2, 4) => Ok(Packing::Runs),
        (0, 16) => masks([0x7c00, 0x03e0, 0x001f, 0]),
        (0, 24 | 32) => masks([0x00ff_0000, 0x0000_ff00, 0x0000_00ff, 0]),
        (3 | 6, 16 | 32) => {
            // Headers of 40 bytes are followed by the masks; longer headers contain them at the same offset.
            let has_alpha = compression == 6 || u32_at(bytes, FILE_HEADER)? >= 56;
            let at = |i: usize| u32_at(bytes, FILE_HEADER + 40 + 4 * i);
            masks([at(0)?, at(1)?, at(2)?, if has_alpha { at(3)? } else { 0 }])
        }
        (4 | 5, _) => Err(PictureError::Unsupported {
            format: FORMAT,
            what: "a JPEG or PNG within it".to_owned(),
            advice: "save it uncompressed, or as PNG",
        }),
        _ => {
            let what = format!("compression {compression} does not have pixels of {depth} bits");
            Err(PictureError::invalid(FORMAT, what))
        }
    }
}

fn decode(bytes: &[u8], limits: &Limits) -> Result<Interleaved, PictureError> {
    let cut = || PictureError::truncated(FORMAT, "the pixels");
    let header = Header::read(bytes)?;
    let (width, height) = (header.width, header.height);
    let pixels = limits.check(FORMAT, width as u64, height as u64, BYTES_PER_PIXEL)?;
    let data = bytes.get(header.pixels..).ok_or_else(cut)?;
    // Rows are padded to a multiple of four bytes.
    let row = (width * usize::from(header.depth)).div_ceil(32) * 4;
    // Two bytes encode at most 255 pixels, so no memory is taken for pixels that a file is too short to hold. The
    // last row may end early.
    let is_whole = match header.packing {
        Packing::Runs => data.len() / 2 * 255 >= pixels,
        _ => data.len() + 3 >= row * height,
    };
    if !is_whole {
        return Err(cut());
    }
    let samples = match header.packing {
        Packing::Masks(masks) => {
            let channels = if masks[3].most == 0 { 3 } else { 4 };
            let mut samples = zeroed(FORMAT, pixels * channels)?;
            let each = usize::from(header.depth / 8);
            for (y, out) in samples.chunks_exact_mut(width * channels).enumerate() {
                let stored = stored_row(&header, data, row, y);
                if stored.len() < width * each {
                    return Err(cut());
                }
                for (pixel, out) in stored.chunks_exact(each).zip(out.chunks_exact_mut(channels)) {
                    let pixel = pixel.iter().rev().fold(0, |pixel, &byte| pixel << 8 | u32::from(byte));
                    out.iter_mut().zip(masks).for_each(|(sample, mask)| *sample = mask.of(pixel));
                }
            }
            samples
        }
        Packing::Indices => {
            let mut samples = zeroed(FORMAT, pixels * 3)?;
            let depth = usize::from(header.depth);
            for (y, out) in samples.chunks_exact_mut(width * 3).enumerate() {
                let stored = stored_row(&header, data, row, y);
                for (x, out) in out.chunks_exact_mut(3).enumerate() {
                    let byte = stored.get(x * depth / 8).ok_or_else(cut)?;
                    // The first pixel is in the upper bits.
                    let index = byte >> (8 - depth - x * depth % 8) & (255 >> (8 - depth));
                    out.copy_from_slice(&colour(&header, index)?);
                }
            }
            samples
        }
        Packing::Runs => {
            let mut samples = zeroed(FORMAT, pixels * 3)?;
            for (index, out) in runs(&header, data, pixels)?.into_iter().zip(samples.chunks_exact_mut(3)) {
                out.copy_from_slice(&colour(&header, index)?);
            }
            samples
        }
    };
    let mut whole = Interleaved::new(width, height, samples);
    whole.make_opaque_if_all_transparent();
    Ok(whole)
}

/// The bytes of a row, counted from the top.
fn stored_row<'a>(header: &Header, data: &'a [u8], row: usize, y: usize) -> &'a [u8] {
    let y = if header.from_top { y } else { header.height - 1 - y };
    let rest = data.get(y * row..).unwrap_or_default();
    &rest[..row.min(rest.len())]
}

fn colour(header: &Header, index: u8) -> Result<[u8; 3], PictureError> {
    let found = header.palette.get(usize::from(index)).copied();
    found.ok_or_else(|| PictureError::invalid(FORMAT, format!("its palette has no colour {index}")))
}

/// Indices of run-length encoded pixels, top row first; skipped pixels are 0.
fn runs(header: &Header, data: &[u8], pixels: usize) -> Result<Vec<u8>, PictureError> {
    let cut = || PictureError::truncated(FORMAT, "the pixels");
    let (width, height) = (header.width, header.height);
    let mut indices = zeroed(FORMAT, pixels)?;
    let (mut x, mut y) = (0, 0);
    // Pixels beyond a row or the picture are dropped.
    let mut put = |x: usize, y: usize, index: u8| {
        if x < width && y < height {
            let y = if header.from_top { y } else { height - 1 - y };
            indices[y * width + x] = index;
        }
    };
    let nibbles = header.depth == 4;
    let of_byte = |byte: u8, i: usize| match (nibbles, i % 2) {
        (false, _) => byte,
        (true, 0) => byte >> 4,
        (true, _) => byte & 15,
    };
    let mut rest = data;
    while y < height {
        let is_last = y == height - 1 && x >= width;
        let Some((&[count, value], behind)) = rest.split_first_chunk::<2>() else {
            return if is_last { Ok(indices) } else { Err(cut()) };
        };
        rest = behind;
        match (count, value) {
            (0, 0) => (x, y) = (0, y + 1),
            (0, 1) => break,
            (0, 2) => {
                let (&[right, up], behind) = rest.split_first_chunk::<2>().ok_or_else(cut)?;
                (x, y, rest) = (x + usize::from(right), y + usize::from(up), behind);
            }
            (0, count) => {
                let count = usize::from(count);
                let size = if nibbles { count.div_ceil(2) } else { count };
                let plain = rest.get(..size).ok_or_else(cut)?;
                (0..count).for_each(|i| put(x + i, y, of_byte(plain[if nibbles { i / 2 } else { i }], i)));
                // Padded to a multiple of two bytes.
                rest = rest.get(size.next_multiple_of(2)..).unwrap_or_default();
                x += count;
            }
            (count, value) => {
                (0..usize::from(count)).for_each(|i| put(x + i, y, of_byte(value, i)));
                x += usize::from(count);
            }
        }
    }
    Ok(indices)
}
