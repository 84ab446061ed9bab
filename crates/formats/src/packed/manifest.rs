//! The manifest of a Collada archive, which names its scene. [Collada 1.5, appendix: zip archive]

use bilux_import::FormatError;
use bilux_import::input::reading::Reading;
use bilux_scene::Span;
use std::path::{Path, PathBuf};

/// Name of the manifest, at the top of the archive.
pub(super) const NAME: &str = "manifest.xml";

/// The path of the scene that the manifest of an archive names, or its name if it is not there; `None` without a manifest.
pub(super) fn scene(
    reading: &mut Reading,
    root: &Path,
    at: &Span,
) -> Result<Option<Result<PathBuf, String>>, FormatError> {
    let Ok(path) = reading.locator.locate(Some(root), NAME, at) else { return Ok(None) };
    let bytes = reading.load_text(&path)?;
    let text = String::from_utf8_lossy(&bytes).into_owned();
    reading.release(bytes);
    let Some(name) = root_of(&text) else { return Ok(None) };
    let found = reading.locator.locate(Some(root), name, at);
    Ok(Some(found.map_err(|_| name.to_owned())))
}

/// The file that the element `dae_root` names, without the part of it that is meant.
fn root_of(text: &str) -> Option<&str> {
    let (_, after) = text.split_once("<dae_root")?;
    let (inside, _) = after.split_once('>')?.1.split_once("</dae_root")?;
    let name = inside.split('#').next()?.trim();
    Some(name.strip_prefix("./").unwrap_or(name)).filter(|name| !name.is_empty())
}
