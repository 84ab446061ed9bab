//! Picture files. To add a format, add a file with its `ENTRY`, and a line in the table.

mod bmp;
mod curve;
mod disk;
mod exr;
mod exr_write;
mod faults;
mod foreign;
mod guard;
mod hdr;
mod icc;
mod jpeg;
#[cfg(feature = "ktx2")]
mod ktx2;
mod meaning;
mod options;
mod orientation;
mod pfm;
mod planes;
mod png;
mod pnm;
mod primaries;
mod rgba8;
mod source;
mod tga;
mod tiff;
mod tokens;
mod unfinished;
mod webp;

pub use disk::{open_regular, write_atomically};
pub use foreign::{FOREIGN_FORMATS, ForeignFormat, foreign_format};
pub use guard::{guarded_decoding, is_decoding};
use options::require_colour;
pub use options::{BitDepth, DEFAULT_QUALITY, WriteOptions};
pub use rgba8::{Interleaved, Rgba8};
pub use source::Source;
pub use unfinished::{Unfinished, remove_unfinished};

use crate::error::nearest;
use crate::{Limits, Picture, PictureError};
use bilux_math::registry::Entry;
use std::path::Path;

/// Every available format.
pub static PICTURE_FORMATS: &[PictureFormatEntry] = &[
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
    /// Lower-case extensions without the dot, the most common one first.
    pub extensions: &'static [&'static str],
    /// True when samples are encoded for a display: exposure and tone map apply when writing.
    pub for_display: bool,
    /// True when a file of this format may begin with these bytes; never, if the format has no signature.
    pub sniff: fn(&[u8]) -> bool,
    /// True when a file can be transparent; other formats store the picture composited over a background colour.
    pub holds_alpha: bool,
    /// Reads a whole file.
    pub read: ReadFn,
    /// Reads samples as they are stored, whatever the file says of its colours; `None` if the format says nothing of them.
    pub read_stored: Option<ReadFn>,
    /// Reads of a picture that is a part of a larger one only that part; `None` if the format has no such pictures.
    pub read_crop: Option<ReadFn>,
    /// Reads a file that stores sRGB bytes, and returns none for other files; `None` where that would save nothing.
    pub read_interleaved: Option<ReadInterleavedFn>,
    /// Writes a whole file; `None` if the format is read only.
    pub write: Option<WriteFn>,
}

/// Type of the function that reads a format.
pub type ReadFn = fn(&[u8], &Limits) -> Result<Picture, PictureError>;
/// Type of the function that reads a format into the bytes that it stores.
pub type ReadInterleavedFn = fn(&[u8], &Limits) -> Result<Option<Interleaved>, PictureError>;
/// Type of the function that writes a format.
pub type WriteFn = fn(Source, &WriteOptions) -> Result<Vec<u8>, PictureError>;

/// Reads a picture file within the default [`Limits`]; see [`read_with`].
pub fn read(path: impl AsRef<Path>) -> Result<Picture, PictureError> {
    read_with(path, &Limits::default())
}

/// Reads a picture file. Its first bytes determine its format; the extension is used only if they do not. Samples are
/// kept as they are in the file: see [`Picture::into_linear`].
pub fn read_with(path: impl AsRef<Path>, limits: &Limits) -> Result<Picture, PictureError> {
    let path = path.as_ref();
    let bytes = disk::read_within(path, limits).map_err(|error| error.in_file(path))?;
    let extension = path.extension().and_then(|extension| extension.to_str());
    read_bytes(&bytes, extension, limits).map_err(|error| error.in_file(path))
}

/// Reads a picture file as [`read_with`] does, but of a part of a larger picture only that part, with its place as
/// [`Picture::crop`]. From `read_with` it comes as the larger picture, which is black around it.
pub fn read_crop(path: impl AsRef<Path>, limits: &Limits) -> Result<Picture, PictureError> {
    let path = path.as_ref();
    let bytes = disk::read_within(path, limits).map_err(|error| error.in_file(path))?;
    let extension = path.extension().and_then(|extension| extension.to_str());
    read_crop_bytes(&bytes, extension, limits).map_err(|error| error.in_file(path))
}

/// Reads a picture from memory as [`read_crop`] reads a file; `hint` is as for [`read_bytes`].
pub fn read_crop_bytes(bytes: &[u8], hint: Option<&str>, limits: &Limits) -> Result<Picture, PictureError> {
    match row_of(bytes, hint)? {
        PictureFormatEntry { read_crop: Some(read_crop), .. } => read_crop(bytes, limits),
        row => (row.read)(bytes, limits),
    }
}

/// Reads a picture from memory. `hint`, a format's name or extension, is used only if the first bytes do not
/// determine the format.
pub fn read_bytes(bytes: &[u8], hint: Option<&str>, limits: &Limits) -> Result<Picture, PictureError> {
    (row_of(bytes, hint)?.read)(bytes, limits)
}

/// Reads a picture from memory as [`read_bytes`] does, whatever the file says of its colours: for numbers that are no colours, and
/// for formats that say themselves what the colours of their textures are.
pub fn read_stored_bytes(bytes: &[u8], hint: Option<&str>, limits: &Limits) -> Result<Picture, PictureError> {
    let row = row_of(bytes, hint)?;
    (row.read_stored.unwrap_or(row.read))(bytes, limits)
}

/// Decodes a picture that is stored in sRGB bytes. Returns `None` for any other picture, which [`read_bytes`]
/// reads. Where both apply, they give the same result, and this function takes a quarter of the memory.
///
/// # Errors
/// As [`read_bytes`].
pub fn read_rgba8(bytes: &[u8], hint: Option<&str>, limits: &Limits) -> Result<Option<Rgba8>, PictureError> {
    Ok(read_interleaved_bytes(bytes, hint, limits)?.and_then(|stored| stored.rgba8()))
}

/// Decodes a picture as [`read_rgba8`] does, with as many bytes per pixel as the file has, for another file.
///
/// # Errors
/// As [`read_bytes`].
pub fn read_interleaved_bytes(
    bytes: &[u8],
    hint: Option<&str>,
    limits: &Limits,
) -> Result<Option<Interleaved>, PictureError> {
    row_of(bytes, hint)?.read_interleaved.map_or(Ok(None), |read| read(bytes, limits))
}

/// Decodes a picture file as [`read_interleaved_bytes`] decodes bytes.
///
/// # Errors
/// As [`read_with`].
pub fn read_interleaved(
    path: impl AsRef<Path>,
    limits: &Limits,
) -> Result<Option<Interleaved>, PictureError> {
    let path = path.as_ref();
    let bytes = disk::read_within(path, limits).map_err(|error| error.in_file(path))?;
    let extension = path.extension().and_then(|extension| extension.to_str());
    read_interleaved_bytes(&bytes, extension, limits).map_err(|error| error.in_file(path))
}

/// The format of these bytes.
fn row_of(bytes: &[u8], hint: Option<&str>) -> Result<&'static PictureFormatEntry, PictureError> {
    let by_content = PICTURE_FORMATS.iter().find(|row| (row.sniff)(bytes));
    if let (None, Some(foreign)) = (by_content, foreign_format(bytes)) {
        let ForeignFormat { what, advice, is_picture, .. } = *foreign;
        return Err(PictureError::Foreign { what, is_picture, advice, known: known(|_| true) });
    }
    match (by_content, hint) {
        (Some(row), _) => Ok(row),
        (None, Some(hint)) => format_named(hint).ok_or_else(|| unknown(hint, "read", |_| true)),
        (None, None) => Err(PictureError::Unrecognised { known: known(|_| true) }),
    }
}

/// Writes a picture file atomically: first next to the target, then renamed over it. The extension chooses the
/// format.
pub fn write(path: impl AsRef<Path>, picture: &Picture, options: &WriteOptions) -> Result<(), PictureError> {
    write_source(path, Source::Planes(picture), options)
}

/// Writes a picture file as `write` does, from any source. Bytes give the same files as the planes that they stand for.
///
/// # Errors
/// If the picture does not fit into the format, or the file cannot be written.
pub fn write_source(
    path: impl AsRef<Path>,
    picture: Source,
    options: &WriteOptions,
) -> Result<(), PictureError> {
    let path = path.as_ref();
    let row = format_of_path(path)?;
    let bytes = encode(row, picture, options).map_err(|error| error.in_file(path))?;
    write_atomically(path, &bytes).map_err(|error| error.in_file(path))
}

/// The bytes of a picture file of this format, by name or extension.
pub fn write_bytes(format: &str, picture: &Picture, options: &WriteOptions) -> Result<Vec<u8>, PictureError> {
    write_source_bytes(format, Source::Planes(picture), options)
}

/// The bytes of a picture file as [`write_bytes`] makes them, from any source.
///
/// # Errors
/// If the format cannot be written, or the picture does not fit into it.
pub fn write_source_bytes(
    format: &str,
    picture: Source,
    options: &WriteOptions,
) -> Result<Vec<u8>, PictureError> {
    let row = format_named(format).filter(|row| row.write.is_some());
    encode(row.ok_or_else(|| unknown(format, "written", |row| row.write.is_some()))?, picture, options)
}

/// The format in which a picture of this name would be written; it lets a command line be rejected before the work.
/// Returns an error with the closest name if no format has this extension.
pub fn format_of_path(path: impl AsRef<Path>) -> Result<&'static PictureFormatEntry, PictureError> {
    let path = path.as_ref();
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    format_named(extension)
        .filter(|row| row.write.is_some())
        .ok_or_else(|| unknown(extension, "written", |row| row.write.is_some()).in_file(path))
}

/// The format with this name or extension, in upper or lower case.
pub fn format_named(name: &str) -> Option<&'static PictureFormatEntry> {
    let name = name.to_lowercase();
    PICTURE_FORMATS.iter().find(|row| row.entry.name == name || row.extensions.contains(&&name[..]))
}

fn encode(
    row: &PictureFormatEntry,
    picture: Source,
    options: &WriteOptions,
) -> Result<Vec<u8>, PictureError> {
    let writer = row.write.ok_or_else(|| unknown(row.entry.name, "written", |row| row.write.is_some()))?;
    writer(picture, options)
}

fn unknown(name: &str, verb: &'static str, able: fn(&PictureFormatEntry) -> bool) -> PictureError {
    let names = PICTURE_FORMATS.iter().filter(|row| able(row)).flat_map(|row| row.extensions.iter().copied());
    // A format that is known, but read only, is not misspelt.
    let suggestion = if format_named(name).is_some() { None } else { nearest(name, names) };
    PictureError::UnknownFormat { name: name.to_owned(), verb, suggestion, known: known(able) }
}

fn known(able: fn(&PictureFormatEntry) -> bool) -> String {
    let rows = PICTURE_FORMATS.iter().filter(|row| able(row));
    rows.map(|row| row.entry.name).collect::<Vec<_>>().join(", ")
}

/// Rejects sides that are too long for a format.
fn check_sides(format: &'static str, picture: Source, most: usize) -> Result<[u16; 2], PictureError> {
    let (width, height) = (picture.width(), picture.height());
    match [width, height].map(u16::try_from) {
        [Ok(w), Ok(h)] if width.max(height) <= most => Ok([w, h]),
        _ => Err(PictureError::Unwritable {
            format,
            what: format!(
                "it has {width} x {height} pixels, but a side can have at most {most}; write .png instead"
            ),
        }),
    }
}
