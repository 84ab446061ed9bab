//! Reads and writes files with a table of formats.

use crate::bytes::archive::is_archive;
use crate::bytes::gzip;
use crate::bytes::text::{is_marked, plain, plain_size, whole_file};
use crate::input::authors::written_by;
use crate::input::locating::Locator;
use crate::input::reading::{OtherFormats, Reading, Source};
use crate::output::bake::{warn_of_vertices, with_pictures, without_media};
use crate::output::strokes::as_triangles;
use crate::output::writing::{Writing, write_all};
use crate::tables::formats::{Formats, ReadFormat, SceneFormatEntry, WriteFormat, extension};
use crate::world::frame::{Frame, in_frame, stated};
use crate::{FormatError, ReadOptions, WriteOptions};
use bilux_math::DVec3;
use bilux_pictures::{ForeignFormat, PICTURE_FORMATS, foreign_format};
use bilux_scene::lights::in_numbers;
use bilux_scene::{SceneBuilder, Spec, UpHint, Value, Warning};
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Reads a scene file. Its extension selects the format; if that is unknown, its first bytes do.
///
/// # Errors
/// A [`FormatError`] with its location.
pub fn read(formats: Formats, path: &Path, options: &ReadOptions) -> Result<SceneBuilder, FormatError> {
    let mut reading = Reading::new(options, path.parent());
    reading.others = Some(&formats);
    let row = formats.to_read(path);
    let name = path.display().to_string().into();
    if let Some(archive) = archive_of(path) {
        reading.locator = Locator::new(archive.parent(), options);
        reading.mount(archive, &archive.display().to_string().into())?;
    }
    reading.open.extend(std::fs::canonicalize(path));
    let scene = read_file(formats, row, &mut reading, path, &name)?;
    reading.complete(scene)
}

/// The archive in which a path lies, as in `models.zip/parts/wheel.stl`.
pub fn archive_of(path: &Path) -> Option<&Path> {
    let around = path.ancestors().skip(1).find(|around| !around.as_os_str().is_empty() && around.exists());
    let file = around.filter(|around| around.is_file())?;
    let mut head = Vec::new();
    std::fs::File::open(file).ok()?.take(BEGINNING).read_to_end(&mut head).ok()?;
    is_archive(&head).then_some(file)
}

/// Reads a file with the given format, or else with the one that its first bytes indicate; messages use `name`.
pub fn read_file(
    formats: Formats,
    row: Option<&'static SceneFormatEntry>,
    reading: &mut Reading,
    path: &Path,
    name: &Arc<str>,
) -> Result<SceneBuilder, FormatError> {
    keeping_digits(reading, |reading| read_file_once(formats, row, reading, path, name))
}

/// Reads a scene, and once more if it lies far from zero, relative to an origin near it.
fn keeping_digits(
    reading: &mut Reading,
    mut read: impl FnMut(&mut Reading) -> Result<(&'static SceneFormatEntry, SceneBuilder), FormatError>,
) -> Result<SceneBuilder, FormatError> {
    let before = reading.memory_held();
    let (row, scene) = read(reading)?;
    let Some(origin) = far_origin(row, &scene) else { return Ok(scene) };
    reading.go_back_to(before, scene);
    reading.origin = origin;
    let again = read(reading);
    reading.origin = DVec3::ZERO;
    again.map(|(_, scene)| SceneBuilder { origin, ..scene })
}

/// The formats whose readers take positions relative to [`Reading::origin`].
const KEEPING_DIGITS: [&str; 9] = ["obj", "ply", "stl", "off", "asc", "gltf", "fbx", "collada", "radiance"];

/// The origin of a model so far from zero that f32 coordinates have lost digits that the file may hold.
fn far_origin(row: &SceneFormatEntry, scene: &SceneBuilder) -> Option<DVec3> {
    const FAR: f64 = 1024.0;
    if !KEEPING_DIGITS.contains(&row.entry.name) {
        return None;
    }
    let bounds = scene.bounds(0.0);
    let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let middle = ((low + high) * 0.5).round();
    (!bounds.is_empty() && middle.is_finite() && middle.length() > FAR * (high - low).length())
        .then_some(middle)
}

fn read_file_once(
    formats: Formats,
    row: Option<&'static SceneFormatEntry>,
    reading: &mut Reading,
    path: &Path,
    name: &Arc<str>,
) -> Result<(&'static SceneFormatEntry, SceneBuilder), FormatError> {
    let folder = path.parent();
    if let Some(row @ SceneFormatEntry { read: Some(ReadFormat::Flowing(_)), .. }) = row {
        let failed = |source| FormatError::Io { path: path.to_owned(), action: "read it", source };
        let (mut file, _) = reading.open_file(path)?;
        let mut head = Vec::new();
        file.by_ref().take(BEGINNING).read_to_end(&mut head).map_err(failed)?;
        let source = Source { bytes: &head, name, folder };
        return Ok((row, flow(row, reading, &source, &mut (&head[..]).chain(file))?));
    }
    if let Some(row) = row.filter(|row| row.is_packed()) {
        return Ok((row, read_archive(row, reading, path, name)?));
    }
    let bytes = reading.load(path)?;
    let row = row.or_else(|| formats.sniffed(&bytes));
    let row = row.ok_or_else(|| {
        not_a_scene(name, &bytes)
            .or_else(|| picture_by_name(path))
            .unwrap_or_else(|| formats.unknown(path, "read", SceneFormatEntry::reads))
    })?;
    if row.is_packed() {
        reading.release(bytes);
        return Ok((row, read_archive(row, reading, path, name)?));
    }
    let scene = read_source(row, reading, &Source { bytes: &bytes, name, folder })?;
    reading.release(bytes);
    Ok((row, scene))
}

/// Reads an archive as the folder of its members.
fn read_archive(
    row: &SceneFormatEntry,
    reading: &mut Reading,
    path: &Path,
    name: &Arc<str>,
) -> Result<SceneBuilder, FormatError> {
    let failed = |source| FormatError::Io { path: path.to_owned(), action: "read it", source };
    let (file, _) = reading.open_file(path)?;
    let mut head = Vec::new();
    file.take(BEGINNING).read_to_end(&mut head).map_err(failed)?;
    if !head.is_empty() {
        reading.mount(path, name)?;
    }
    let scene = read_source(row, reading, &Source { bytes: &head, name, folder: Some(path) });
    reading.unmount(path);
    scene
}

/// The length of a file's beginning that a streaming reader can inspect first.
const BEGINNING: u64 = 4096;

/// Reads a scene from memory.
///
/// `format` is a name or an extension, or empty to detect it from the bytes; `base` is the folder of the files
/// that the scene refers to; `name` is what messages call it.
///
/// # Errors
/// A [`FormatError`] with its location.
pub fn read_bytes(
    formats: Formats,
    bytes: &[u8],
    format: &str,
    base: Option<&Path>,
    name: &str,
    options: &ReadOptions,
) -> Result<SceneBuilder, FormatError> {
    let mut reading = Reading::new(options, base);
    reading.others = Some(&formats);
    let bytes = plain_bytes(bytes, &mut reading, name)?;
    let bytes = &*bytes;
    let found = if format.is_empty() { formats.sniffed(bytes) } else { formats.named(format) };
    let asked = if format.is_empty() { name } else { format };
    let row = found.ok_or_else(|| {
        not_a_scene(name, bytes)
            .unwrap_or_else(|| formats.unknown(Path::new(asked), "read", SceneFormatEntry::reads))
    })?;
    reading.budget.take_bytes(bytes.len() as u64, name)?;
    let name = Arc::from(name);
    let mut source = Source { bytes, name: &name, folder: base };
    if row.is_packed() && !bytes.is_empty() {
        let root = Path::new(&*name);
        reading.mount_bytes(root, bytes, &name)?;
        source = Source { folder: Some(root), ..source };
    }
    let scene = keeping_digits(&mut reading, |reading| Ok((row, read_source(row, reading, &source)?)))?;
    reading.complete(scene)
}

/// The bytes, or what they hold if they are compressed by gzip.
fn plain_bytes<'b>(bytes: &'b [u8], reading: &mut Reading, name: &str) -> Result<Cow<'b, [u8]>, FormatError> {
    if !bytes.starts_with(&gzip::SIGNATURE) {
        return Ok(Cow::Borrowed(bytes));
    }
    let failed = |source| FormatError::Io { path: name.into(), action: "open it", source };
    let stream = gzip::plain(Box::new(bytes)).map_err(failed)?;
    reading.take(stream, bytes.len() as u64, Path::new(name)).map(Cow::Owned)
}

/// Writes a scene and its accompanying files, in the format of the path's extension.
///
/// Each file is written under a temporary name in its folder first, then renamed, so that it appears in one step.
/// Accompanying files get names that no file has that the scene was read from. Returns a warning for everything that the
/// format could not hold.
///
/// # Errors
/// If the format is unknown, the scene was read from this file or a file cannot be written.
pub fn write(
    formats: Formats,
    path: &Path,
    scene: &SceneBuilder,
    options: &WriteOptions,
) -> Result<Vec<Warning>, FormatError> {
    let row = formats.of_path(path)?;
    check_not_read(path, &scene.files)?;
    let mut writing = Writing::new(path, scene, options);
    if let Some(WriteFormat { frame, write }) = row.write {
        let scene = &*in_frame(scene, frame);
        if scene.origin != DVec3::ZERO {
            let [x, y, z] = scene.origin.to_array();
            writing.warn(format!(
                "positions are written relative to {x}, {y}, {z}, the centre of the file's points"
            ));
        }
        warn_of_vertices(scene, &mut writing);
        let scene = &*without_media(scene, row.capabilities, &mut writing);
        let scene = &*with_numbers(scene, row);
        let scene = with_pictures(scene, row.capabilities, &mut writing);
        let scene = as_triangles(scene, row.capabilities, &mut writing);
        write(&scene, &mut writing)?;
    }
    write_all(path, writing)
}

/// Lights with numbers in place of quantities such as `800 lm`, unless the format is our own.
fn with_numbers<'s>(scene: &'s SceneBuilder, row: &SceneFormatEntry) -> Cow<'s, SceneBuilder> {
    let is_text =
        |light: &Spec| light.parameters.0.iter().any(|(_, value, _)| matches!(value, Value::Text(_)));
    if row.entry.name == "toml" || !scene.lights.iter().any(is_text) {
        return Cow::Borrowed(scene);
    }
    let lights = scene.lights.iter().map(in_numbers).collect();
    Cow::Owned(SceneBuilder { lights, ..scene.clone() })
}

/// Refuses to write to one of the files that a scene was read from ([`SceneBuilder::files`]).
///
/// # Errors
/// [`FormatError::IsInput`].
pub fn check_not_read(path: &Path, files: &BTreeSet<PathBuf>) -> Result<(), FormatError> {
    match std::fs::canonicalize(path) {
        Ok(full) if files.contains(&full) => Err(FormatError::IsInput { path: path.to_owned() }),
        _ => Ok(()),
    }
}

/// Reads with a known format, and checks the result against the options.
pub fn read_source(
    row: &SceneFormatEntry,
    reading: &mut Reading,
    source: &Source,
) -> Result<SceneBuilder, FormatError> {
    flow(row, reading, source, &mut &source.bytes[..])
}

impl OtherFormats for Formats {
    fn read_named(
        &self,
        format: &str,
        reading: &mut Reading,
        source: &Source,
    ) -> Result<SceneBuilder, FormatError> {
        let row = self.named(format);
        let row = row.ok_or_else(|| self.unknown(Path::new(format), "read", SceneFormatEntry::reads))?;
        read_source(row, reading, source)
    }
}

/// Reads as [`read_source`] does, but the source may hold only the beginning of its bytes, with a reader that streams them.
fn flow(
    row: &SceneFormatEntry,
    reading: &mut Reading,
    source: &Source,
    from: &mut dyn Read,
) -> Result<SceneBuilder, FormatError> {
    let Some(read) = row.read else {
        return Err(Formats(&[]).unknown(Path::new(row.entry.name), "read", SceneFormatEntry::reads));
    };
    if source.bytes.is_empty() {
        return Err(FormatError::malformed("the file is empty", whole_file(source.name)));
    }
    let (spent, textures) = (reading.budget.spent(), reading.texture_bytes());
    let read = match read {
        ReadFormat::Binary(read) | ReadFormat::Packed(read) => read(reading, source),
        ReadFormat::Whole(read) => {
            reading.budget.take_bytes(plain_size(source.bytes), source.name)?;
            read(reading, &Source { bytes: &plain(source.bytes), ..*source })
        }
        ReadFormat::Flowing(read) if is_marked(source.bytes) => {
            // Such files are rare, and need not flow.
            let bytes = read_all(reading, source, from)?;
            let source = Source { bytes: &plain(&bytes), ..*source };
            read(reading, &source, &mut &source.bytes[..])
        }
        ReadFormat::Flowing(read) => read(reading, source, from),
    };
    let mut scene = read.map_err(|error| explained(error, row, source))?;
    reading.refine_cages(&mut scene, source.name);
    reading.displace(&mut scene, source.name);
    if scene.written_by.is_empty() {
        scene.written_by = written_by(row.entry.name, source.bytes).unwrap_or_default();
    }
    // A scene that is based on another one keeps what that file says.
    if let Some((up, unit)) = stated(source.bytes).filter(|_| is_open(row)) {
        (scene.up, scene.unit) = (UpHint::Is(up), unit);
    } else if scene.up == UpHint::default() {
        scene.up = row.up;
    }
    reading.settle(spent, textures, &scene);
    match scene.warnings.first() {
        Some(first) if reading.options.strict => Err(FormatError::Strict(first.clone())),
        _ => Ok(scene),
    }
}

/// True for formats that have no words for the up axis and the unit.
fn is_open(row: &SceneFormatEntry) -> bool {
    row.up != UpHint::default() && matches!(row.write, Some(WriteFormat { frame: Frame::Stated(_), .. }))
}

/// The rest of a stream, charged with what its text takes.
fn read_all(reading: &mut Reading, source: &Source, from: &mut dyn Read) -> Result<Vec<u8>, FormatError> {
    let path = || Path::new(&**source.name).to_owned();
    let failed = |source| FormatError::Io { path: path(), action: "read it", source };
    let mut bytes = Vec::new();
    let left = reading.budget.left();
    from.take(left.saturating_add(1)).read_to_end(&mut bytes).map_err(failed)?;
    reading.budget.take_bytes(bytes.len() as u64 + plain_size(&bytes), source.name)?;
    Ok(bytes)
}

/// The error for a file that is something other than a scene in a known format, by its bytes.
fn not_a_scene(name: &str, bytes: &[u8]) -> Option<FormatError> {
    let name = name.to_owned();
    if let Some(row) = PICTURE_FORMATS.iter().find(|row| (row.sniff)(bytes)) {
        return Some(FormatError::IsPicture { name, format: row.extensions[0] });
    }
    let &ForeignFormat { what, advice, is_picture, .. } = foreign_format(bytes)?;
    Some(if is_picture {
        FormatError::IsForeignPicture { name, what, advice }
    } else {
        FormatError::IsForeign { name, what, advice }
    })
}

/// The error for a picture in place of a scene, by the file's name.
fn picture_by_name(path: &Path) -> Option<FormatError> {
    let row = bilux_pictures::format_named(&extension(path)?)?;
    Some(FormatError::IsPicture { name: path.display().to_string(), format: row.extensions[0] })
}

/// An error of a reader, or if the bytes are in another format than the file's name says, that.
fn explained(error: FormatError, row: &SceneFormatEntry, source: &Source) -> FormatError {
    // A package without a layer is a package nevertheless.
    let is_package = row.entry.name == "usdz" && source.bytes.starts_with(b"PK\x03\x04");
    match error {
        FormatError::Malformed { .. } if !is_package && !(row.sniff)(source.bytes) => {
            not_a_scene(source.name, source.bytes).unwrap_or(error)
        }
        error => error,
    }
}
