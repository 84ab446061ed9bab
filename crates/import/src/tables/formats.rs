//! The rows of the table of formats, and how a format is found in it.

use crate::FormatError;
use crate::bytes::gzip::plain_name;
use crate::bytes::text::{is_marked, plain};
use crate::input::reading::{Reading, Source};
use crate::output::writing::Writing;
use crate::world::frame::Frame;
use bilux_math::registry::Entry;
use bilux_scene::error::nearest_name;
use bilux_scene::{SceneBuilder, UpHint};
use std::io::Read;
use std::path::Path;

/// One format: a row of the table.
#[derive(Clone, Copy, Debug)]
pub struct SceneFormatEntry {
    /// Name, summary, source and parameters of the format.
    pub entry: Entry,
    /// Extensions in lower case without the dot, the usual one first.
    pub extensions: &'static [&'static str],
    /// The features of a scene that a file of this format can hold.
    pub capabilities: &'static [&'static str],
    /// The up axis of its files.
    pub up: UpHint,
    /// True if the bytes look like this format.
    pub sniff: fn(&[u8]) -> bool,
    pub read: Option<ReadFormat>,
    pub write: Option<WriteFormat>,
}

/// Turns bytes into a scene.
#[derive(Clone, Copy, Debug)]
pub enum ReadFormat {
    /// From the whole file in memory, without a byte order mark, and as UTF-8 if it is UTF-16.
    Whole(fn(&mut Reading, &Source) -> Result<SceneBuilder, FormatError>),
    /// From the whole file as it is: any bytes may come first in it.
    Binary(fn(&mut Reading, &Source) -> Result<SceneBuilder, FormatError>),
    /// From a stream of text, as for `Whole`. The source holds only the beginning of the file; the stream repeats it.
    Flowing(fn(&mut Reading, &Source, &mut dyn Read) -> Result<SceneBuilder, FormatError>),
    /// From an archive, whose members are the files of the source's folder. The source holds only its beginning.
    Packed(fn(&mut Reading, &Source) -> Result<SceneBuilder, FormatError>),
}

/// Turns a scene into bytes.
#[derive(Clone, Copy, Debug)]
pub struct WriteFormat {
    /// The axes and the unit of its files; the writer gets a scene that has them.
    pub frame: Frame,
    pub write: fn(&SceneBuilder, &mut Writing) -> Result<(), FormatError>,
}

impl SceneFormatEntry {
    /// True if files of this format can be read.
    pub fn reads(&self) -> bool {
        self.read.is_some()
    }

    /// True if its files are archives.
    pub fn is_packed(&self) -> bool {
        matches!(self.read, Some(ReadFormat::Packed(_)))
    }

    /// True if files of this format can be written.
    pub fn writes(&self) -> bool {
        self.write.is_some()
    }
}

/// A table of formats.
#[derive(Clone, Copy, Debug)]
pub struct Formats(pub &'static [SceneFormatEntry]);

impl Formats {
    /// The format with this name or extension, ignoring case.
    pub fn named(self, name: &str) -> Option<&'static SceneFormatEntry> {
        let name = name.to_lowercase();
        self.0.iter().find(|row| row.entry.name == name || row.extensions.contains(&&*name))
    }

    /// The format to write to a path, by its extension; lets a caller refuse a command line before the work.
    ///
    /// # Errors
    /// If no format that can be written has this extension; the error suggests the closest one.
    pub fn of_path(self, path: &Path) -> Result<&'static SceneFormatEntry, FormatError> {
        let found = extension(path).and_then(|e| self.named(&e)).filter(|row| row.writes());
        found.ok_or_else(|| self.unknown(path, "written", SceneFormatEntry::writes))
    }

    /// The format that the first bytes of a file indicate.
    pub fn sniffed(self, bytes: &[u8]) -> Option<&'static SceneFormatEntry> {
        let head = plain(&bytes[..bytes.len().min(HEAD)]);
        let looks_like = |row: &&SceneFormatEntry| match row.read {
            Some(ReadFormat::Binary(_) | ReadFormat::Packed(_)) => (row.sniff)(bytes),
            // Most look at the end too, but the text of a marked file is made anew.
            _ if is_marked(bytes) => (row.sniff)(&head),
            _ => (row.sniff)(bytes),
        };
        self.0.iter().filter(|row| row.reads()).find(looks_like)
    }

    /// The format of a file to read, by its extension; `.gz` after it does not count.
    pub fn to_read(self, path: &Path) -> Option<&'static SceneFormatEntry> {
        extension(&plain_name(path)).and_then(|e| self.named(&e))
    }

    /// The error for a file whose format is unknown, with the nearest name of those that `can` do what is `wanted`.
    pub fn unknown(
        self,
        path: &Path,
        wanted: &'static str,
        can: fn(&SceneFormatEntry) -> bool,
    ) -> FormatError {
        let rows = self.0.iter().filter(|row| can(row));
        let known: Vec<String> = rows.flat_map(|row| row.extensions).map(|&e| e.to_owned()).collect();
        let asked = extension(path).unwrap_or_else(|| path.display().to_string());
        // The formats of other programs, pictures and names without an extension are not misspelt.
        let is_bare = wanted == "written" && path.extension().is_none();
        let is_known = FOREIGN.contains(&&*asked) || self.named(&asked).is_some();
        let is_other = is_bare || is_known || bilux_pictures::format_named(&asked).is_some();
        let nearest = nearest_name(&asked, &known).filter(|_| !is_other);
        FormatError::UnknownFormat { name: path.display().to_string(), wanted, nearest, known }
    }
}

/// The bytes of a marked file that tell its format.
const HEAD: usize = 1 << 16;

/// Extensions of scene formats that other programs read.
const FOREIGN: &[&str] =
    &["3ds", "abc", "blend", "c4d", "iges", "igs", "lwo", "ma", "max", "mb", "skp", "vrm", "wrl", "x3d"];

/// The extension of a path as text.
pub fn extension(path: &Path) -> Option<String> {
    path.extension().map(|e| e.to_string_lossy().into_owned())
}
