//! PFM: 32-bit floats, uncompressed, bottom row first. [Debevec PFM]

use super::tokens::Tokens;
use super::{PictureFormatEntry, Source, WriteOptions, require_colour};
use crate::limits::reserved;
use crate::{Limits, Picture, PictureError};
use bilux_math::registry::Entry;

/// The row of `pfm`.
pub(super) const ENTRY: PictureFormatEntry = PictureFormatEntry {
    entry: Entry {
        name: "pfm",
        summary: "portable float map: linear 32-bit floats, colour or grey, exact and uncompressed",
        source: "Debevec PFM",
        parameters: &[],
    },
    extensions: &["pfm"],
    for_display: false,
    holds_alpha: false,
    sniff: |bytes| matches!(bytes, [b'P', b'F' | b'f', blank, ..] if blank.is_ascii_whitespace()),
    read,
    read_stored: None,
    read_crop: None,
    read_interleaved: None,
    write: Some(write),
};

const FORMAT: &str = "PFM";

fn read(bytes: &[u8], limits: &Limits) -> Result<Picture, PictureError> {
    let mut tokens = Tokens::new(FORMAT, bytes);
    let names: &[&str] = match tokens.word("magic number")? {
        "PF" => &["R", "G", "B"],
        "Pf" => &["Y"],
        other => {
            return Err(PictureError::invalid(FORMAT, format!("it begins with '{other}', not PF or Pf")));
        }
    };
    let (width, height) = (tokens.integer("width")?, tokens.integer("height")?);
    let scale = tokens.word("scale")?;
    let scale: f32 = match scale.parse() {
        Ok(number) if number != 0.0 && f32::is_finite(number) => number,
        _ => {
            let what = format!(
                "the scale is '{scale}'; it must be a number other than zero, negative for little-endian samples"
            );
            return Err(PictureError::invalid(FORMAT, what));
        }
    };
    let data = tokens.binary()?;
    let pixels = limits.check(FORMAT, width, height, 4 * names.len() as u64)?;
    if data.len() / 4 / names.len() < pixels {
        return Err(PictureError::truncated(FORMAT, "the pixels"));
    }
    let decode = if scale < 0.0 { f32::from_le_bytes } else { f32::from_be_bytes };
    let (width, height) = (width as usize, height as usize);
    let mut picture = Picture::new(width, height)?;
    for (channel, name) in names.iter().enumerate() {
        let mut samples = reserved(FORMAT, pixels)?;
        for row in data.chunks_exact(4 * names.len() * width).take(height).collect::<Vec<_>>().iter().rev() {
            let (floats, _) = row.as_chunks::<4>();
            samples.extend(floats.iter().skip(channel).step_by(names.len()).map(|float| decode(*float)));
        }
        picture.push_channel(*name, samples)?;
    }
    Ok(picture)
}

/// Little-endian, scale 1.
fn write(picture: Source, _: &WriteOptions) -> Result<Vec<u8>, PictureError> {
    let picture = picture.planes(FORMAT)?;
    require_colour(FORMAT, &picture)?;
    let picture = picture.into_owned().into_linear();
    let grey = picture.channel("R").is_none();
    let planes = picture.rgb_planes().unwrap_or_default();
    let planes = if grey { &planes[..1] } else { &planes[..] };
    let (width, height) = (picture.width(), picture.height());
    let magic = if grey { "Pf" } else { "PF" };
    let mut bytes = format!("{magic}\n{width} {height}\n-1.0\n").into_bytes();
    bytes.reserve(4 * planes.len() * picture.pixel_count());
    for i in (0..height).rev().flat_map(|y| y * width..(y + 1) * width) {
        planes.iter().for_each(|plane| bytes.extend_from_slice(&plane[i].to_le_bytes()));
    }
    Ok(bytes)
}
