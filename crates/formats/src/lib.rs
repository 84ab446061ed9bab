//! Reads and writes scene files. The table of formats is [`SCENE_FORMATS`]; most are crates of their own.
//!
//! A reader converts bytes to a [`bilux_scene::SceneBuilder`], which is plain data: this crate does not validate
//! it against the scene's tables, and renders nothing. For any input, a reader returns a scene, or a
//! [`FormatError`] that states the location and the remedy. It uses no more memory than
//! [`ReadOptions::max_memory`], and opens no file outside the scene's folder unless allowed.

mod native;
mod packed;

use bilux_dcc::{dae, fbx};
use bilux_import::tables::files;
use bilux_import::tables::formats::Formats;
use bilux_import::tables::grids;
use bilux_meshes::{asc, e57, las, obj, off, ply, stl, threemf, xyz};
use bilux_renderers::{mitsuba, pbrt, radiance};
use bilux_scene::{SceneBuilder, Warning};
use std::path::Path;

pub use bilux_import::tables::calibrations::{CalibratedCameras, read_cameras};
pub use bilux_import::tables::files::{archive_of, check_not_read};
pub use bilux_import::tables::formats::SceneFormatEntry;
pub use bilux_import::tables::grids::{GridOfFile, read_grid, read_grids};
pub use bilux_import::tables::luminaires::read_distribution;
pub use bilux_import::{FormatError, Glass, ReadOptions, Scheme, WriteOptions};
pub use native::{SHAPES, ShapeEntry, overlay, toml_schema};

/// All scene formats.
pub static SCENE_FORMATS: &[SceneFormatEntry] = &[
    asc::ENTRY,
    bilux_gltf::ENTRY,
    fbx::ENTRY,
    dae::ENTRY,
    pbrt::ENTRY,
    bilux_usd::ENTRY,
    bilux_usd::CRATE,
    bilux_usd::PACKAGE,
    mitsuba::ENTRY,
    radiance::ENTRY,
    obj::ENTRY,
    ply::ENTRY,
    stl::ENTRY,
    off::ENTRY,
    bilux_step::ENTRY,
    las::ENTRY,
    e57::ENTRY,
    xyz::ENTRY,
    grids::ENTRY,
    threemf::ENTRY,
    packed::ENTRY,
    native::ENTRY,
];

/// The table, as readers take it.
static FORMATS: Formats = Formats(SCENE_FORMATS);

/// The format with this name or extension, ignoring case.
pub fn format_named(name: &str) -> Option<&'static SceneFormatEntry> {
    FORMATS.named(name)
}

/// The format to write to a path, by its extension; lets a caller refuse a command line before the work.
///
/// # Errors
/// If no format that can be written has this extension; the error suggests the closest one.
pub fn format_of_path(path: &Path) -> Result<&'static SceneFormatEntry, FormatError> {
    FORMATS.of_path(path)
}

/// Reads a scene file. Its extension selects the format; if that is unknown, its first bytes do.
///
/// # Errors
/// A [`FormatError`] with its location.
pub fn read(path: &Path, options: &ReadOptions) -> Result<SceneBuilder, FormatError> {
    files::read(FORMATS, path, options)
}

/// Reads a scene from memory.
///
/// `format` is a name or an extension, or empty to detect it from the bytes; `base` is the folder of the files
/// that the scene refers to; `name` is what messages call it.
///
/// # Errors
/// A [`FormatError`] with its location.
pub fn read_bytes(
    bytes: &[u8],
    format: &str,
    base: Option<&Path>,
    name: &str,
    options: &ReadOptions,
) -> Result<SceneBuilder, FormatError> {
    files::read_bytes(FORMATS, bytes, format, base, name, options)
}

/// Writes a scene and its accompanying files, in the format of the path's extension.
///
/// Each file is written under a temporary name in its folder first, then renamed, so that it appears in one step.
/// Accompanying files get names that no file has that the scene was read from. Returns a warning for everything that the
/// format could not hold.
///
/// # Errors
/// If the format is unknown, the scene was read from this file or a file cannot be written.
pub fn write(path: &Path, scene: &SceneBuilder, options: &WriteOptions) -> Result<Vec<Warning>, FormatError> {
    files::write(FORMATS, path, scene, options)
}
