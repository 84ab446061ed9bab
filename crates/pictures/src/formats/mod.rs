//! Picture files. To add a format: a file with its `ENTRY`, and a line in the table.

mod bmp;
mod disk;
mod exr;
mod exr_write;
mod faults;
mod guard;
mod hdr;
mod jpeg;
#[cfg(feature = "ktx2")]
mod ktx2;
mod pfm;
mod png;
mod pnm;
mod primaries;
mod rgba8;
mod tga;
mod tiff;
mod tokens;
mod webp;

pub use disk::write_atomically;
pub use guard::{guarded_decoding, is_decoding};
pub use rgba8::{Rgba8, read_rgba8};

use crate::error::nearest;
use crate::picture::hold_within;
use crate::tonemap::{TONEMAPS, ToneMapEntry, to_display};
use crate::{Limits, Picture, PictureError};
use bilux_math::Rgb;
use bilux_math::registry::Entry;
use std::path::Path;

/// Every format that there is.
pub const PICTURE_FORMATS: &[PictureFormatEntry] = &[
    png::ENTRY,
    exr::ENTRY,
    hdr::ENTRY,
    pfm::ENTRY,
    pnm::ENTRY,
    jpeg::ENTRY,
    webp::ENTRY,
    #[cfg(feature = "ktx2")]
    ktx2::ENTRY,
    tiff::ENTRY,
    bmp::ENTRY,
    tga::ENTRY,
];

/// One format.
#[derive(Clone, Copy, Debug)]
pub struct PictureFormatEntry {
    /// Name, summary, source and parameters.
    pub entry: Entry,
    /// Lower-case extensions without the dot, the usual one first.
    pub extensions: &'static [&'static str],
    /// True when samples are encoded for a display: exposure and tone map apply when writing.
    pub for_display: bool,
    /// True when a file of this format may begin with these bytes; never, where a format has no mark of its own.
    pub sniff: fn(&[u8]) -> bool,
    /// True when a file can be transparent; other formats hold the picture in front of a colour.
    pub holds_alpha: bool,
    /// Reads a whole file.
    pub read: ReadFn,
    /// Reads it where it is stored in sRGB bytes, and gives none where it is not; `None` where that would save nothing.
    pub read_rgba8: Option<ReadRgba8Fn>,
    /// Writes a whole file; `None` where the format is only read.
    pub write: Option<WriteFn>,
}

/// How a format is read.
pub type ReadFn = fn(&[u8], &Limits) -> Result<Picture, PictureError>;
/// How a format is read into four bytes a pixel.
pub type ReadRgba8Fn = fn(&[u8], &Limits) -> Result<Option<Rgba8>, PictureError>;
/// How a format is written.
pub type WriteFn = fn(&Picture, &WriteOptions) -> Result<Vec<u8>, PictureError>;

/// What a writer may be told. Each looks only at what it knows.
#[derive(Clone, Copy, Debug)]
pub struct WriteOptions {
    /// How fine the steps of PNG and PPM are.
    pub bit_depth: BitDepth,
    /// Stops by which pictures for a display are brightened; other formats keep the light as it is.
    pub exposure: f32,
    /// The curve for pictures for a display.
    pub tone_map: &'static ToneMapEntry,
    /// What shows through what is transparent, in linear light of a display, in pictures for one.
    pub behind: Option<Rgb>,
    /// Of a JPEG, from 1 to 100: how true it is to the picture, and how large.
    pub quality: u8,
}

/// How many steps a sample of a picture for a display has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BitDepth {
    /// 256 steps.
    #[default]
    Eight,
    /// 65,536 steps.
    Sixteen,
}

/// The quality of a JPEG unless another is asked for: artefacts that nobody sees, in a sixth of a PNG's bytes.
pub const DEFAULT_QUALITY: u8 = 92;

impl Default for WriteOptions {
    fn default() -> WriteOptions {
        WriteOptions {
            bit_depth: BitDepth::default(),
            exposure: 0.0,
            tone_map: &TONEMAPS[0],
            behind: None,
            quality: DEFAULT_QUALITY,
        }
    }
}

/// Reads a picture file within the default [`Limits`]; see [`read_with`].
pub fn read(path: impl AsRef<Path>) -> Result<Picture, PictureError> {
    read_with(path, &Limits::default())
}

/// Reads a picture file. Its first bytes say what it is; the extension only where they do not.
/// Samples are kept as they are in the file: see [`Picture::into_linear`].
pub fn read_with(path: impl AsRef<Path>, limits: &Limits) -> Result<Picture, PictureError> {
    let path = path.as_ref();
    let bytes = disk::read_within(path, limits).map_err(|error| error.in_file(path))?;
    let extension = path.extension().and_then(|extension| extension.to_str());
    read_bytes(&bytes, extension, limits).map_err(|error| error.in_file(path))
}

/// Reads a picture from memory. `hint`, a format's name or extension, is asked only where the first
/// bytes do not tell what this is.
pub fn read_bytes(bytes: &[u8], hint: Option<&str>, limits: &Limits) -> Result<Picture, PictureError> {
    (row_of(bytes, hint)?.read)(bytes, limits)
}

/// The format of these bytes.
fn row_of(bytes: &[u8], hint: Option<&str>) -> Result<&'static PictureFormatEntry, PictureError> {
    let by_content = PICTURE_FORMATS.iter().find(|row| (row.sniff)(bytes));
    match (by_content, hint) {
        (Some(row), _) => Ok(row),
        (None, Some(hint)) => format_named(hint).ok_or_else(|| unknown(hint, "read", |_| true)),
        (None, None) => Err(PictureError::Unrecognised { known: known(|_| true) }),
    }
}

/// Writes a picture file in one step: beside the target first, then renamed over it. The extension
/// chooses the format.
pub fn write(path: impl AsRef<Path>, picture: &Picture, options: &WriteOptions) -> Result<(), PictureError> {
    let path = path.as_ref();
    let row = format_of_path(path)?;
    let bytes = encode(row, picture, options).map_err(|error| error.in_file(path))?;
    write_atomically(path, &bytes).map_err(|error| error.in_file(path))
}

/// The bytes of a picture file of this format, by name or extension.
pub fn write_bytes(format: &str, picture: &Picture, options: &WriteOptions) -> Result<Vec<u8>, PictureError> {
    let row = format_named(format).filter(|row| row.write.is_some());
    encode(row.ok_or_else(|| unknown(format, "written", |row| row.write.is_some()))?, picture, options)
}

/// The format that a picture of this name would be written in; so that a command line can be refused
/// before the work. Errors, with the nearest name, where no format goes by the extension.
pub fn format_of_path(path: impl AsRef<Path>) -> Result<&'static PictureFormatEntry, PictureError> {
    let path = path.as_ref();
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    format_named(extension)
        .filter(|row| row.write.is_some())
        .ok_or_else(|| unknown(extension, "written", |row| row.write.is_some()).in_file(path))
}

/// The format of this name or extension, in any case.
pub fn format_named(name: &str) -> Option<&'static PictureFormatEntry> {
    let name = name.to_lowercase();
    PICTURE_FORMATS.iter().find(|row| row.entry.name == name || row.extensions.contains(&&name[..]))
}

fn encode(
    row: &PictureFormatEntry,
    picture: &Picture,
    options: &WriteOptions,
) -> Result<Vec<u8>, PictureError> {
    let writer = row.write.ok_or_else(|| unknown(row.entry.name, "written", |row| row.write.is_some()))?;
    writer(picture, options)
}

fn unknown(name: &str, verb: &'static str, able: fn(&PictureFormatEntry) -> bool) -> PictureError {
    let names = PICTURE_FORMATS.iter().filter(|row| able(row)).flat_map(|row| row.extensions.iter().copied());
    // A format that is known, but only read, is not misspelt.
    let suggestion = if format_named(name).is_some() { None } else { nearest(name, names) };
    PictureError::UnknownFormat { name: name.to_owned(), verb, suggestion, known: known(able) }
}

fn known(able: fn(&PictureFormatEntry) -> bool) -> String {
    let rows = PICTURE_FORMATS.iter().filter(|row| able(row));
    rows.map(|row| row.entry.name).collect::<Vec<_>>().join(", ")
}

/// The planes that a display format writes, in its order: `R G B` or `Y`, and `A` where there is one.
pub(crate) struct DisplayPlanes {
    pub(crate) picture: Picture,
    pub(crate) names: Vec<&'static str>,
}

/// The main picture exposed, tone mapped and encoded, as the options say.
fn display_planes(
    format: &'static str,
    picture: &Picture,
    options: &WriteOptions,
) -> Result<DisplayPlanes, PictureError> {
    require_colour(format, picture)?;
    let mut picture = to_display(picture, options.exposure, options.tone_map)?;
    if let Some(behind) = options.behind {
        picture = picture.before(behind);
    }
    let grey = picture.channel("R").is_none();
    let mut names = if grey { vec!["Y"] } else { vec!["R", "G", "B"] };
    if picture.channel("A").is_some() {
        names.push("A");
    }
    Ok(DisplayPlanes { picture, names })
}

/// The same for a format without alpha: what is transparent shows white, unless the options have another colour.
fn opaque_planes(
    format: &'static str,
    picture: &Picture,
    options: &WriteOptions,
) -> Result<DisplayPlanes, PictureError> {
    let behind = options.behind.or_else(|| picture.channel("A").map(|_| Rgb::WHITE));
    let mut planes = display_planes(format, picture, &WriteOptions { behind, ..*options })?;
    planes.names.retain(|&name| name != "A");
    Ok(planes)
}

/// Refuses sides that a format has no room for.
fn check_sides(format: &'static str, picture: &Picture, most: usize) -> Result<[u16; 2], PictureError> {
    let (width, height) = (picture.width(), picture.height());
    match [width, height].map(u16::try_from) {
        [Ok(w), Ok(h)] if width.max(height) <= most => Ok([w, h]),
        _ => Err(PictureError::Unwritable {
            format,
            what: format!(
                "it has {width} x {height} pixels, and a side has at most {most}; write .png instead"
            ),
        }),
    }
}

fn require_colour(format: &'static str, picture: &Picture) -> Result<(), PictureError> {
    if picture.rgb_planes().is_some() {
        return Ok(());
    }
    let names: Vec<&str> = picture.channels().iter().map(|c| &c.name[..]).collect();
    let names =
        if names.is_empty() { "no channels".to_owned() } else { format!("only {}", names.join(", ")) };
    let what = format!(
        "it needs the channels R, G and B, or Y, and there are {names}; write .exr instead, or choose a layer"
    );
    Err(PictureError::Unwritable { format, what })
}

impl DisplayPlanes {
    /// Interleaved samples of 0..=255, rounded half up; what is not a number becomes 0.
    pub(crate) fn to_u8(&self, names: &[&str]) -> Vec<u8> {
        self.interleave(names, |sample| [quantise(sample, 255.0) as u8])
    }

    /// Interleaved big-endian samples of 0..=65535, rounded half up; what is not a number becomes 0.
    pub(crate) fn to_u16_be(&self, names: &[&str]) -> Vec<u8> {
        self.interleave(names, |sample| (quantise(sample, 65535.0) as u16).to_be_bytes())
    }

    fn interleave<const N: usize>(&self, names: &[&str], encode: impl Fn(f32) -> [u8; N]) -> Vec<u8> {
        let planes: Vec<&[f32]> = names.iter().filter_map(|name| self.picture.channel(name)).collect();
        let mut bytes = Vec::with_capacity(self.picture.pixel_count() * planes.len() * N);
        for i in 0..self.picture.pixel_count() {
            planes.iter().for_each(|plane| bytes.extend_from_slice(&encode(plane[i])));
        }
        bytes
    }
}

/// A sample of 0..=1 to one of `steps`, rounded half up. In f64, so that every step comes back.
pub(crate) fn quantise(sample: f32, steps: f64) -> u32 {
    (f64::from(hold_within(sample, 1.0)) * steps + 0.5).floor() as u32
}

/// Splits interleaved samples into planes of `f32`.
pub(crate) fn planes_of<'a, T: Copy + 'a>(
    format: &'static str,
    samples: impl Iterator<Item = T> + Clone,
    channels: usize,
    pixels: usize,
    convert: impl Fn(T) -> f32,
) -> Result<Vec<Vec<f32>>, PictureError> {
    let mut planes = Vec::with_capacity(channels);
    for channel in 0..channels {
        let mut plane = crate::limits::reserved(format, pixels)?;
        plane.extend(samples.clone().skip(channel).step_by(channels).take(pixels).map(&convert));
        planes.push(plane);
    }
    Ok(planes)
}
