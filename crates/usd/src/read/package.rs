//! Packages: zip files whose first member is a layer.

use crate::composition::root_of_package;
use crate::read;
use bilux_import::FormatError;
use bilux_import::input::reading::{Reading, Source};
use bilux_scene::SceneBuilder;
use std::path::Path;

/// True for a zip file that begins with a layer.
pub(crate) fn is_package(bytes: &[u8]) -> bool {
    // The header of a member: its length at 26, its name at 30.
    let Some(head) = bytes.get(..30).filter(|head| head.starts_with(b"PK\x03\x04")) else { return false };
    let length = usize::from(u16::from_le_bytes([head[26], head[27]]));
    let name = bytes.get(30..30 + length).unwrap_or_default().to_ascii_lowercase();
    [&b".usdc"[..], b".usda", b".usd"].iter().any(|end| name.ends_with(end))
}

/// Reads the first layer of a package, and what it refers to.
pub(crate) fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let root = source.folder.unwrap_or(Path::new(""));
    let path = root_of_package(reading, root, source.name)?;
    let bytes = reading.load(&path)?;
    let name = path.display().to_string().into();
    reading.open.push(path.clone());
    let scene = read::read(reading, &Source { bytes: &bytes, name: &name, folder: path.parent() })?;
    reading.release(bytes);
    Ok(scene)
}
