//! Pictures as bytes: textures take four per pixel, and other files as many as there are channels, without a detour through
//! planes, which take four times as much.

use super::planes::planes_of;
use crate::{Alpha, ColourSpace, Picture, PictureError};
use std::collections::BTreeMap;
use std::ops::Range;

/// Bytes of an sRGB picture with straight alpha.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rgba8 {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// In rows from the top.
    pub texels: Vec<[u8; 4]>,
    /// Faults of the file, though it could be read.
    pub warnings: Vec<String>,
}

/// Interleaved bytes of one to four channels (grey, grey and alpha, colour, colour and alpha), in sRGB with straight
/// alpha: a picture as its file has it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Interleaved {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) samples: Vec<u8>,
    /// Texts that are stored with the picture.
    pub metadata: BTreeMap<String, String>,
    /// Faults of the file, though it could be read.
    pub warnings: Vec<String>,
}

impl Interleaved {
    pub(super) fn new(width: usize, height: usize, samples: Vec<u8>) -> Interleaved {
        Interleaved { width, height, samples, ..Interleaved::default() }
    }

    pub(super) fn channels(&self) -> usize {
        self.samples.len() / (self.width * self.height).max(1)
    }

    /// True if its only colour is grey.
    pub fn is_grey(&self) -> bool {
        self.channels() < 3
    }

    /// True if a pixel is not opaque.
    pub fn is_transparent(&self) -> bool {
        let channels = self.channels();
        matches!(channels, 2 | 4)
            && self.samples.iter().skip(channels - 1).step_by(channels).any(|&alpha| alpha < 255)
    }

    /// The names of the channels.
    pub(super) fn names(&self) -> &'static [&'static str] {
        match self.channels() {
            1 => &["Y"],
            2 => &["Y", "A"],
            3 => &["R", "G", "B"],
            _ => &["R", "G", "B", "A"],
        }
    }

    /// The picture as planes.
    pub(super) fn picture(&self, format: &'static str) -> Result<Picture, PictureError> {
        let mut picture = self.rows(format, 0..self.height)?;
        picture.warnings.clone_from(&self.warnings);
        picture.metadata.clone_from(&self.metadata);
        Ok(picture)
    }

    /// Some rows as planes, without texts.
    pub(super) fn rows(&self, format: &'static str, rows: Range<usize>) -> Result<Picture, PictureError> {
        let names = self.names();
        let mut picture = Picture::new(self.width, rows.len())?;
        picture.colour_space = ColourSpace::Srgb;
        picture.alpha = Alpha::Straight;
        let number = |byte: &u8| f32::from(*byte) / 255.0;
        let row = self.width * names.len();
        let samples = self.samples.get(rows.start * row..rows.end * row).unwrap_or_default();
        let planes = planes_of(format, samples.iter(), names.len(), picture.pixel_count(), number)?;
        for (name, plane) in names.iter().zip(planes) {
            picture.push_channel(*name, plane)?;
        }
        Ok(picture)
    }

    /// The picture as four bytes a pixel.
    pub(super) fn rgba8(&self) -> Option<Rgba8> {
        let samples = &self.samples[..];
        let texels = match self.channels() {
            1 => samples.iter().map(|&y| [y, y, y, 255]).collect(),
            2 => samples.as_chunks::<2>().0.iter().map(|&[y, a]| [y, y, y, a]).collect(),
            3 => samples.as_chunks::<3>().0.iter().map(|&[r, g, b]| [r, g, b, 255]).collect(),
            4 => samples.as_chunks::<4>().0.to_vec(),
            _ => return None,
        };
        Some(Rgba8 { width: self.width, height: self.height, texels, warnings: self.warnings.clone() })
    }

    /// Makes a picture opaque if its alpha is zero everywhere: writers that do not know alpha leave zeros in its
    /// place.
    pub(super) fn make_opaque_if_all_transparent(&mut self) {
        let channels = self.channels();
        let first = channels.saturating_sub(1);
        if !matches!(channels, 2 | 4) {
            return;
        }
        if self.samples.iter().skip(first).step_by(channels).all(|&alpha| alpha == 0) {
            self.make_opaque();
        }
    }

    /// Makes a picture with alpha opaque.
    pub(super) fn make_opaque(&mut self) {
        let channels = self.channels();
        let first = channels.saturating_sub(1);
        self.samples.iter_mut().skip(first).step_by(channels).for_each(|alpha| *alpha = 255);
    }

    /// Turns colours that have been multiplied by alpha into straight ones.
    pub(super) fn divide_by_alpha(&mut self) {
        let channels = self.channels();
        for pixel in self.samples.chunks_exact_mut(channels.max(1)) {
            let Some((&mut alpha, colour)) = pixel.split_last_mut() else { continue };
            let straight = |c: u8| (u32::from(c) * 255 + u32::from(alpha) / 2) / u32::from(alpha).max(1);
            colour.iter_mut().for_each(|c| *c = straight(*c).min(255) as u8);
        }
    }

    /// Turns the picture so that its first row or column becomes the last.
    #[cfg(feature = "ktx2")]
    pub(super) fn flip(&mut self, columns: bool, rows: bool) {
        let channels = self.channels();
        let row = self.width * channels;
        if rows {
            let flipped: Vec<u8> = self.samples.chunks_exact(row.max(1)).rev().flatten().copied().collect();
            self.samples = flipped;
        }
        if columns {
            for row in self.samples.chunks_exact_mut(row.max(1)) {
                let flipped: Vec<u8> = row.chunks_exact(channels.max(1)).rev().flatten().copied().collect();
                row.copy_from_slice(&flipped);
            }
        }
    }
}
