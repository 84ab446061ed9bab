//! PBM, PGM and PPM, in text and binary: the simplest picture formats. [Netpbm]

use super::tokens::Tokens;
use super::{BitDepth, PictureFormatEntry, Source, WriteOptions};
use crate::limits::reserved;
use crate::{ColourSpace, Limits, Picture, PictureError};
use bilux_math::registry::Entry;

/// The row of `ppm`.
pub(super) const ENTRY: PictureFormatEntry = PictureFormatEntry {
    entry: Entry {
        name: "ppm",
        summary: "portable pixmap: uncompressed colour or grey, 8 or 16 bits, sRGB (reads P1 to P6)",
        source: "Netpbm",
        parameters: &[],
    },
    extensions: &["ppm", "pgm", "pbm", "pnm"],
    for_display: true,
    holds_alpha: false,
    sniff: |bytes| matches!(bytes, [b'P', b'1'..=b'6', next, ..] if next.is_ascii_whitespace() || *next == b'#'),
    read,
    read_stored: None,
    read_crop: None,
    read_interleaved: None,
    write: Some(write),
};

const FORMAT: &str = "PPM";

fn read(bytes: &[u8], limits: &Limits) -> Result<Picture, PictureError> {
    let mut tokens = Tokens::new(FORMAT, bytes);
    let magic = tokens.word("magic number")?;
    let channels = match magic {
        "P1" | "P2" | "P4" | "P5" => 1,
        "P3" | "P6" => 3,
        other => {
            return Err(PictureError::invalid(FORMAT, format!("it begins with '{other}', not P1 to P6")));
        }
    };
    let (width, height) = (tokens.integer("width")?, tokens.integer("height")?);
    let bitmap = matches!(magic, "P1" | "P4");
    let maximum = if bitmap { 1 } else { tokens.integer("greatest value")? };
    if !(1..=65535).contains(&maximum) {
        let what = format!("the maximum value is {maximum}, but must be from 1 to 65535");
        return Err(PictureError::invalid(FORMAT, what));
    }
    let pixels = limits.check(FORMAT, width, height, 4 * channels)?;
    // The size of the shortest file of these dimensions, so that no memory is taken for pixels that are not there.
    let shortest = match magic {
        "P1" => pixels,
        "P2" | "P3" => pixels.saturating_mul(2 * channels as usize).saturating_sub(1),
        "P4" => (width as usize).div_ceil(8).saturating_mul(height as usize),
        _ => pixels.saturating_mul(channels as usize).saturating_mul(if maximum > 255 { 2 } else { 1 }),
    };
    if bytes.len() < shortest {
        return Err(PictureError::truncated(FORMAT, "the pixels"));
    }
    let layout =
        Layout { width: width as usize, pixels, channels: channels as usize, maximum: maximum as u32 };
    let planes = match magic {
        "P1" | "P2" | "P3" => read_text(tokens, bitmap, &layout)?,
        "P4" => vec![read_packed_bits(tokens.binary()?, &layout)?],
        _ => read_binary(tokens.binary()?, &layout)?,
    };
    let mut picture = Picture::new(width as usize, height as usize)?;
    picture.colour_space = ColourSpace::Srgb;
    let names: &[&str] = if channels == 3 { &["R", "G", "B"] } else { &["Y"] };
    for (name, plane) in names.iter().zip(planes) {
        picture.push_channel(*name, plane)?;
    }
    Ok(picture)
}

struct Layout {
    width: usize,
    pixels: usize,
    channels: usize,
    maximum: u32,
}

impl Layout {
    fn scale(&self, value: u32) -> f32 {
        value.min(self.maximum) as f32 / self.maximum as f32
    }

    fn planes(&self) -> Result<Vec<Vec<f32>>, PictureError> {
        (0..self.channels).map(|_| reserved(FORMAT, self.pixels)).collect()
    }
}

fn read_text(mut tokens: Tokens, bitmap: bool, layout: &Layout) -> Result<Vec<Vec<f32>>, PictureError> {
    let mut planes = layout.planes()?;
    for i in 0..layout.pixels * layout.channels {
        let sample = if bitmap {
            // In a bitmap 1 is ink.
            if tokens.bit()? { 0.0 } else { 1.0 }
        } else {
            let value = tokens.integer("pixels")?;
            if value > u64::from(layout.maximum) {
                let what = format!("a sample is {value}, but the maximum value is {}", layout.maximum);
                return Err(PictureError::invalid(FORMAT, what));
            }
            layout.scale(value as u32)
        };
        planes[i % layout.channels].push(sample);
    }
    Ok(planes)
}

fn read_packed_bits(data: &[u8], layout: &Layout) -> Result<Vec<f32>, PictureError> {
    let stride = layout.width.div_ceil(8);
    let height = layout.pixels / layout.width;
    if data.len() / stride < height {
        return Err(PictureError::truncated(FORMAT, "the pixels"));
    }
    let mut plane = reserved(FORMAT, layout.pixels)?;
    for row in data.chunks_exact(stride).take(height) {
        let ink = |x: usize| row[x / 8] >> (7 - x % 8) & 1 == 1;
        plane.extend((0..layout.width).map(|x| if ink(x) { 0.0 } else { 1.0 }));
    }
    Ok(plane)
}

fn read_binary(data: &[u8], layout: &Layout) -> Result<Vec<Vec<f32>>, PictureError> {
    let samples = layout.pixels * layout.channels;
    let wide = layout.maximum > 255;
    if data.len() / if wide { 2 } else { 1 } < samples {
        return Err(PictureError::truncated(FORMAT, "the pixels"));
    }
    let mut planes = layout.planes()?;
    for i in 0..samples {
        let value =
            if wide { u32::from(data[2 * i]) << 8 | u32::from(data[2 * i + 1]) } else { u32::from(data[i]) };
        planes[i % layout.channels].push(layout.scale(value));
    }
    Ok(planes)
}

/// P6 or P5. The format has no alpha.
fn write(picture: Source, options: &WriteOptions) -> Result<Vec<u8>, PictureError> {
    let shown = picture.opaque(FORMAT, options)?;
    let magic = if shown.names.len() == 1 { "P5" } else { "P6" };
    let maximum = match options.bit_depth {
        BitDepth::Eight => 255,
        BitDepth::Sixteen => 65535,
    };
    let mut bytes = format!("{magic}\n{} {}\n{maximum}\n", picture.width(), picture.height()).into_bytes();
    bytes.extend_from_slice(&shown.samples);
    Ok(bytes)
}
