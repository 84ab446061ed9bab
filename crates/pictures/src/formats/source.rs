//! Sources of pictures for writers: planes, or the bytes of another file. Files for a display are made a strip of rows
//! at a time, so that what is made on the way is never as large as the picture.

use super::options::{BitDepth, WriteOptions, require_colour};
use super::rgba8::Interleaved;
use crate::limits::reserved;
use crate::picture::quantise;
use crate::tonemap::to_display;
use crate::{Picture, PictureError};
use bilux_math::Rgb;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;

/// A picture that is to be written.
#[derive(Clone, Copy, Debug)]
pub enum Source<'a> {
    /// Planes of numbers.
    Planes(&'a Picture),
    /// The bytes of another file.
    Bytes(&'a Interleaved),
}

/// Pixels that are made at a time: enough for all threads, and a small part of a large picture.
const STRIP: usize = 1 << 20;

/// Interleaved samples for a display, `R G B` or `Y`, and `A` if present.
pub(super) struct DisplaySamples<'a> {
    pub(super) names: Vec<&'static str>,
    pub(super) samples: Cow<'a, [u8]>,
}

impl<'a> Source<'a> {
    /// Width in pixels.
    pub fn width(self) -> usize {
        match self {
            Source::Planes(picture) => picture.width(),
            Source::Bytes(bytes) => bytes.width,
        }
    }

    /// Height in pixels.
    pub fn height(self) -> usize {
        match self {
            Source::Planes(picture) => picture.height(),
            Source::Bytes(bytes) => bytes.height,
        }
    }

    /// The texts that belong to the picture.
    pub(super) fn metadata(self) -> &'a BTreeMap<String, String> {
        match self {
            Source::Planes(picture) => &picture.metadata,
            Source::Bytes(bytes) => &bytes.metadata,
        }
    }

    /// The whole picture as planes.
    pub(super) fn planes(self, format: &'static str) -> Result<Cow<'a, Picture>, PictureError> {
        match self {
            Source::Planes(picture) => Ok(Cow::Borrowed(picture)),
            Source::Bytes(bytes) => bytes.picture(format).map(Cow::Owned),
        }
    }

    /// The main picture exposed, tone mapped and encoded, as the options say.
    pub(super) fn for_display(
        self,
        format: &'static str,
        options: &WriteOptions,
    ) -> Result<DisplaySamples<'a>, PictureError> {
        self.shown(format, options, true)
    }

    /// The main picture as `for_display` gives it, for a format without alpha: transparent pixels are composited over white,
    /// unless the options have another colour.
    pub(super) fn opaque(
        self,
        format: &'static str,
        options: &WriteOptions,
    ) -> Result<DisplaySamples<'a>, PictureError> {
        let behind = options.behind.or_else(|| self.has_alpha().then_some(Rgb::WHITE));
        self.shown(format, &WriteOptions { behind, ..*options }, false)
    }

    fn has_alpha(self) -> bool {
        match self {
            Source::Planes(picture) => picture.channel("A").is_some(),
            Source::Bytes(bytes) => bytes.names().contains(&"A"),
        }
    }

    /// Some rows of the main picture.
    fn rows(self, format: &'static str, rows: Range<usize>) -> Result<Picture, PictureError> {
        match self {
            Source::Planes(picture) => Ok(picture.main_rows(rows)),
            Source::Bytes(bytes) => bytes.rows(format, rows),
        }
    }

    fn shown(
        self,
        format: &'static str,
        options: &WriteOptions,
        keeps_alpha: bool,
    ) -> Result<DisplaySamples<'a>, PictureError> {
        if let (Source::Bytes(bytes), BitDepth::Eight, true) = (self, options.bit_depth, options.is_neutral())
        {
            // They are what would come out.
            let samples = Cow::Borrowed(&bytes.samples[..]);
            return Ok(DisplaySamples { names: bytes.names().to_vec(), samples });
        }
        if let (Source::Bytes(bytes), BitDepth::Eight) = (self, options.bit_depth)
            && (WriteOptions { behind: None, ..*options }).is_neutral()
            && !bytes.is_transparent()
        {
            // Nothing is to be seen of the background.
            return without_alpha(bytes, format);
        }
        if let Source::Planes(picture) = self {
            require_colour(format, picture)?;
        }
        let (width, height) = (self.width(), self.height());
        let (mut names, mut samples) = (Vec::new(), Vec::new());
        let step = (STRIP / width.max(1)).clamp(1, height.max(1));
        for first in (0..height).step_by(step) {
            let strip = self.rows(format, first..(first + step).min(height))?;
            let mut strip = to_display(&strip, options.exposure, options.tone_map)?;
            if let Some(behind) = options.behind {
                strip = strip.before(behind);
            }
            if first == 0 {
                names = names_of(&strip, keeps_alpha);
                let each = if options.bit_depth == BitDepth::Sixteen { 2 } else { 1 };
                samples = reserved(format, width * height * names.len() * each)?;
            }
            match options.bit_depth {
                BitDepth::Eight => interleave(&strip, &names, &mut samples, |s| [quantise(s, 255.0) as u8]),
                BitDepth::Sixteen => {
                    interleave(&strip, &names, &mut samples, |s| (quantise(s, 65535.0) as u16).to_be_bytes())
                }
            }
        }
        Ok(DisplaySamples { names, samples: Cow::Owned(samples) })
    }
}

/// The colours of a picture with alpha.
fn without_alpha<'a>(bytes: &Interleaved, format: &'static str) -> Result<DisplaySamples<'a>, PictureError> {
    let names: Vec<&str> = bytes.names().iter().copied().filter(|&name| name != "A").collect();
    let mut samples = reserved(format, bytes.width * bytes.height * names.len())?;
    for pixel in bytes.samples.chunks_exact(bytes.channels().max(1)) {
        samples.extend_from_slice(&pixel[..names.len()]);
    }
    Ok(DisplaySamples { names, samples: Cow::Owned(samples) })
}

/// The planes that a display format writes, in its order.
fn names_of(picture: &Picture, keeps_alpha: bool) -> Vec<&'static str> {
    let mut names = if picture.channel("R").is_none() { vec!["Y"] } else { vec!["R", "G", "B"] };
    if keeps_alpha && picture.channel("A").is_some() {
        names.push("A");
    }
    names
}

/// Appends samples of 0 to 1, rounded half up to what can be stored; NaN becomes 0.
fn interleave<const N: usize>(
    picture: &Picture,
    names: &[&str],
    samples: &mut Vec<u8>,
    encode: impl Fn(f32) -> [u8; N],
) {
    let planes: Vec<&[f32]> = names.iter().filter_map(|name| picture.channel(name)).collect();
    for i in 0..picture.pixel_count() {
        planes.iter().for_each(|plane| samples.extend_from_slice(&encode(plane[i])));
    }
}
