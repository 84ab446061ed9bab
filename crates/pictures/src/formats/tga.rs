//! TGA, read only: a texture format of older models. [TGA 2.0]

use super::PictureFormatEntry;
use super::guard::guarded;
use super::rgba8::Interleaved;
use crate::limits::zeroed;
use crate::{Limits, PictureError};
use bilux_math::registry::Entry;

/// The row of `tga`. Such a file has no signature at its beginning: its name has to say what it is.
pub(super) const ENTRY: PictureFormatEntry = PictureFormatEntry {
    entry: Entry {
        name: "tga",
        summary: "8 bits, sRGB, with alpha, run-length encoded or not; recognised only by its extension: read only",
        source: "TGA 2.0",
        parameters: &[],
    },
    extensions: &["tga", "targa", "vda", "icb", "vst"],
    for_display: true,
    holds_alpha: false,
    sniff: |_| false,
    read: |bytes, limits| guarded(FORMAT, || decode(bytes, limits)?.picture(FORMAT)),
    read_stored: None,
    read_crop: None,
    read_interleaved: Some(|bytes, limits| guarded(FORMAT, || decode(bytes, limits).map(Some))),
    write: None,
};

const FORMAT: &str = "TGA";

/// Samples, and our own four planes.
const BYTES_PER_PIXEL: u64 = 4 + 4 * 4;

/// The contents of the first 18 bytes.
struct Header {
    width: usize,
    height: usize,
    kind: Kind,
    in_runs: bool,
    /// Bits per pixel in the file.
    depth: u8,
    /// Alpha bits per pixel, as far as the file states them.
    alpha_bits: u8,
    from_right: bool,
    from_top: bool,
    palette: Palette,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Indices,
    Colours,
    Greys,
}

/// The location of the palette.
struct Palette {
    at: usize,
    first: usize,
    count: usize,
    depth: u8,
}

/// Bytes of a pixel or palette entry with this many bits.
fn bytes_of(depth: u8) -> usize {
    usize::from(depth).div_ceil(8)
}

impl Header {
    fn read(bytes: &[u8]) -> Result<Header, PictureError> {
        let Some(h) = bytes.first_chunk::<18>() else {
            return Err(PictureError::truncated(FORMAT, "the header"));
        };
        let u16_at = |at: usize| usize::from(u16::from_le_bytes([h[at], h[at + 1]]));
        let invalid = |what: String| Err(PictureError::invalid(FORMAT, what));
        let kind = match h[2] & !8 {
            1 => Kind::Indices,
            2 => Kind::Colours,
            3 => Kind::Greys,
            _ => return invalid(format!("its image type is {}, which does not exist", h[2])),
        };
        if h[1] > 1 {
            return invalid(format!("its palette type is {}, which does not exist", h[1]));
        }
        let palette = Palette {
            at: 18 + usize::from(h[0]),
            first: u16_at(3),
            count: if h[1] == 1 { u16_at(5) } else { 0 },
            depth: h[7],
        };
        let depth = h[16];
        let fits = match kind {
            Kind::Indices => matches!(depth, 8 | 16) && matches!(palette.depth, 15 | 16 | 24 | 32),
            Kind::Colours => matches!(depth, 15 | 16 | 24 | 32),
            Kind::Greys => matches!(depth, 8 | 16),
        };
        if !fits {
            let palette = if kind == Kind::Indices {
                format!(" into a palette of {} bits", palette.depth)
            } else {
                String::new()
            };
            return invalid(format!("image type {} does not have pixels of {depth} bits{palette}", h[2]));
        }
        Ok(Header {
            width: u16_at(12),
            height: u16_at(14),
            kind,
            in_runs: h[2] & 8 != 0,
            depth,
            alpha_bits: h[17] & 15,
            from_right: h[17] & 16 != 0,
            from_top: h[17] & 32 != 0,
            palette,
        })
    }

    /// Bits of a colour in the file, and the number of channels that it becomes.
    fn colour(&self) -> (u8, usize) {
        let depth = if self.kind == Kind::Indices { self.palette.depth } else { self.depth };
        let channels = match (self.kind, depth) {
            (Kind::Greys, 8) => 1,
            (Kind::Greys, _) => 2,
            (_, 32) => 4,
            (_, 16) if self.alpha_bits > 0 => 4,
            _ => 3,
        };
        (depth, channels)
    }
}

fn decode(bytes: &[u8], limits: &Limits) -> Result<Interleaved, PictureError> {
    let header = Header::read(bytes)?;
    let (width, height) = (header.width, header.height);
    let pixels = limits.check(FORMAT, width as u64, height as u64, BYTES_PER_PIXEL)?;
    let palette_size = header.palette.count * bytes_of(header.palette.depth);
    let rest = bytes.get(header.palette.at..).unwrap_or_default();
    let Some((palette, data)) = rest.split_at_checked(palette_size) else {
        return Err(PictureError::truncated(FORMAT, "the palette"));
    };
    let each = bytes_of(header.depth);
    let (depth, channels) = header.colour();
    let mut samples = Samples { header: &header, out: Vec::new(), depth, channels, palette };
    // The shortest packet encodes the most, 128 pixels, so no memory is taken for pixels that a file is too short to
    // hold.
    let most = if header.in_runs { data.len() / (1 + each) * 128 } else { data.len() / each };
    if most < pixels {
        return Err(PictureError::truncated(FORMAT, "the pixels"));
    }
    samples.out = zeroed(FORMAT, pixels * channels)?;
    if header.in_runs {
        samples.unpack(data, pixels)?;
    } else {
        for (at, pixel) in data.chunks_exact(each).take(pixels).enumerate() {
            samples.put(at, pixel)?;
        }
    }
    let mut whole = Interleaved::new(width, height, samples.out);
    if channels == 4 || channels == 2 {
        whole.make_opaque_if_all_transparent();
        match attributes_type(bytes) {
            Some(NO_ALPHA | IGNORED) => whole.make_opaque(),
            Some(PREMULTIPLIED) => whole.divide_by_alpha(),
            _ => {}
        }
    }
    Ok(whole)
}

/// Kinds of alpha: none, none that means anything, and one that the colours have been multiplied by. [TGA 2.0, field 24]
const NO_ALPHA: u8 = 0;
const IGNORED: u8 = 1;
const PREMULTIPLIED: u8 = 4;

/// Type of the fourth channel, where the file has an extension area, which its last 26 bytes point to. [TGA 2.0, fields 10 and 28]
fn attributes_type(bytes: &[u8]) -> Option<u8> {
    let footer = bytes.last_chunk::<26>().filter(|footer| footer[8..].starts_with(b"TRUEVISION-XFILE."))?;
    let start = u32::from_le_bytes([footer[0], footer[1], footer[2], footer[3]]) as usize;
    let area = bytes.get(start..).filter(|_| start != 0)?;
    area.get(494).copied().filter(|_| area.starts_with(&495u16.to_le_bytes()))
}

/// Pixels on their way from the file to their positions.
struct Samples<'a> {
    header: &'a Header,
    palette: &'a [u8],
    /// Bits per colour.
    depth: u8,
    channels: usize,
    out: Vec<u8>,
}

impl Samples<'_> {
    /// Unpacks pixels: run-length packets and raw packets. A packet may continue in the next row.
    fn unpack(&mut self, data: &[u8], pixels: usize) -> Result<(), PictureError> {
        let cut = || PictureError::truncated(FORMAT, "the pixels");
        let each = bytes_of(self.header.depth);
        let (mut at, mut rest) = (0, data);
        while at < pixels {
            let (&head, behind) = rest.split_first().ok_or_else(cut)?;
            let count = usize::from(head & 127) + 1;
            let stored = if head & 128 != 0 { 1 } else { count };
            let (packet, behind) = behind.split_at_checked(stored * each).ok_or_else(cut)?;
            for i in 0..count.min(pixels - at) {
                let pixel = if stored == 1 { packet } else { &packet[i * each..][..each] };
                self.put(at + i, pixel)?;
            }
            (at, rest) = (at + count, behind);
        }
        Ok(())
    }

    /// Stores a pixel at its position, given its number in the order of the file.
    fn put(&mut self, number: usize, pixel: &[u8]) -> Result<(), PictureError> {
        let Header { width, height, from_right, from_top, .. } = *self.header;
        let (x, y) = (number % width, number / width);
        let x = if from_right { width - 1 - x } else { x };
        let y = if from_top { y } else { height - 1 - y };
        let colour = match (self.header.kind, pixel) {
            (Kind::Indices, pixel) => self.entry(pixel)?,
            (Kind::Greys, [grey]) => [*grey, 0, 0, 0],
            (Kind::Greys, pixel) => [pixel[0], pixel[1], 0, 0],
            (Kind::Colours, pixel) => colour(pixel, self.depth),
        };
        let place = (y * width + x) * self.channels;
        self.out[place..place + self.channels].copy_from_slice(&colour[..self.channels]);
        Ok(())
    }

    /// A colour from the palette.
    fn entry(&self, index: &[u8]) -> Result<[u8; 4], PictureError> {
        let index = index.iter().rev().fold(0, |index, &byte| index << 8 | usize::from(byte));
        let each = bytes_of(self.depth);
        let found =
            index.checked_sub(self.header.palette.first).and_then(|i| self.palette.chunks_exact(each).nth(i));
        let outside = || PictureError::invalid(FORMAT, format!("its palette has no colour {index}"));
        Ok(colour(found.ok_or_else(outside)?, self.depth))
    }
}

/// Red, green, blue and alpha from 15, 16, 24 or 32 bits.
fn colour(stored: &[u8], depth: u8) -> [u8; 4] {
    match (stored, depth) {
        (&[b, g, r, a], _) => [r, g, b, a],
        (&[b, g, r], _) => [r, g, b, 255],
        (&[low, high], _) => {
            let bits = u16::from_le_bytes([low, high]);
            let five = |shift: u16| ((u32::from(bits >> shift & 31) * 255 + 15) / 31) as u8;
            [five(10), five(5), five(0), if bits >> 15 == 1 { 255 } else { 0 }]
        }
        _ => [0; 4],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file of 2 x 2 pixels: red and green above, blue and white below.
    fn file(kind: u8, depth: u8, descriptor: u8, body: &[u8]) -> Vec<u8> {
        let mut bytes = vec![0, 0, kind, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 2, 0, depth, descriptor];
        bytes.extend_from_slice(body);
        bytes
    }

    const UPPER: [[u8; 3]; 2] = [[0, 0, 255], [0, 255, 0]];
    const LOWER: [[u8; 3]; 2] = [[255, 0, 0], [255, 255, 255]];

    fn check(bytes: &[u8]) {
        let whole = decode(bytes, &Limits::default()).unwrap();
        let colours: Vec<[u8; 4]> = whole.rgba8().unwrap().texels;
        let rgb: Vec<[u8; 3]> = colours.iter().map(|c| [c[0], c[1], c[2]]).collect();
        assert_eq!(rgb, [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]]);
    }

    #[test]
    fn pixels_begin_at_any_corner() {
        let rows = |a: [[u8; 3]; 2], b: [[u8; 3]; 2]| [a, b].as_flattened().as_flattened().to_vec();
        let turned = |row: [[u8; 3]; 2]| [row[1], row[0]];
        check(&file(2, 24, 0, &rows(LOWER, UPPER)));
        check(&file(2, 24, 32, &rows(UPPER, LOWER)));
        check(&file(2, 24, 16, &rows(turned(LOWER), turned(UPPER))));
        check(&file(2, 24, 48, &rows(turned(UPPER), turned(LOWER))));
    }

    #[test]
    fn runs_palettes_and_few_bits() {
        // Three raw pixels, the last of which is in the next row; then a run.
        check(&file(10, 24, 32, &[2, 0, 0, 255, 0, 255, 0, 255, 0, 0, 128, 255, 255, 255]));
        check(&file(2, 16, 32, &[0, 0x7c, 0xe0, 0x03, 0x1f, 0, 0xff, 0x7f]));
        let mut palette = file(1, 8, 32, &[]);
        palette[1] = 1;
        palette[3] = 5;
        palette[5] = 4;
        palette[7] = 24;
        palette.extend([LOWER, UPPER].as_flattened().as_flattened());
        palette.extend([7, 8, 5, 6]);
        check(&palette);
        let last = palette.len() - 1;
        palette[last] = 9;
        let error = decode(&palette, &Limits::default()).err().unwrap().to_string();
        assert!(error.contains("no colour 9"), "{error}");
    }

    #[test]
    fn alpha_is_used_unless_it_is_zero_everywhere() {
        let pixels =
            |alpha: u8| [[1, 2, 3, alpha], [1, 2, 3, 0], [1, 2, 3, 0], [1, 2, 3, 0]].as_flattened().to_vec();
        let alphas = |alpha: u8| {
            let whole = decode(&file(2, 32, 32 + 8, &pixels(alpha)), &Limits::default()).unwrap();
            whole.rgba8().unwrap().texels.iter().map(|c| c[3]).collect::<Vec<u8>>()
        };
        assert_eq!(alphas(77), [77, 0, 0, 0]);
        assert_eq!(alphas(0), [255; 4]);
        let grey = decode(&file(3, 16, 32 + 8, &[9, 80, 8, 255, 7, 0, 6, 1]), &Limits::default()).unwrap();
        assert_eq!(grey.rgba8().unwrap().texels[0], [9, 9, 9, 80]);
    }

    #[test]
    fn a_stated_size_takes_no_memory() {
        for kind in [2, 10] {
            let mut bytes = file(kind, 32, 8, &[0; 1000]);
            bytes[12..16].copy_from_slice(&[0xff, 0x3f, 0xff, 0x3f]);
            let error = decode(&bytes, &Limits::new(u64::MAX)).err().unwrap();
            assert!(matches!(error, PictureError::Truncated { .. }), "{error}");
        }
    }
}
