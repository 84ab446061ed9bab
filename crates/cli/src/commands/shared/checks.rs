//! Checks before a file is written.

use super::reading::report_warnings;
use super::sandbox_paths::folder_of;
use crate::arguments::Common;
use anyhow::bail;
use bilux::math::Rgb;
use bilux::pictures::Picture;
use bilux::pictures::format_named;
use bilux::pictures::formats::format_of_path;
use std::path::Path;

/// Checks, before any work, that a file can be written there.
pub(in crate::commands) fn check_folder(path: &Path) -> anyhow::Result<()> {
    let folder = folder_of(path);
    if !folder.is_dir() {
        bail!("{}: there is no folder '{}': create it first", path.display(), folder.display());
    }
    if path.is_dir() {
        bail!("{}: this is a folder: name a file in it", path.display());
    }
    Ok(())
}

/// Refuses to write a file over one of the files that the command reads.
pub(in crate::commands) fn check_not_input<'a>(
    output: &Path,
    inputs: impl IntoIterator<Item = &'a Path>,
) -> anyhow::Result<()> {
    let Ok(full) = output.canonicalize() else { return Ok(()) };
    if inputs.into_iter().any(|input| input.canonicalize().is_ok_and(|input| input == full)) {
        bail!("{}: this file is read, so it is not overwritten: write to another file", output.display());
    }
    Ok(())
}

/// True for files that are read as pictures, even in formats that are never written.
pub fn is_picture(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str());
    extension.is_some_and(|extension| format_named(extension).is_some())
}

/// Refuses a quality for a format other than JPEG.
pub(in crate::commands) fn check_quality(quality: Option<u8>, output: &Path) -> anyhow::Result<()> {
    let format = format_of_path(output)?.entry.name;
    if quality.is_some() && format != "jpeg" {
        bail!("{}: --quality is only for JPEG: write a .jpg, or leave it out", output.display());
    }
    Ok(())
}

/// Warns if a picture is transparent and its format cannot be.
pub(in crate::commands) fn warn_lost_alpha(
    picture: &Picture,
    output: &Path,
    behind: Option<Rgb>,
    common: &Common,
) -> anyhow::Result<()> {
    report_warnings(bilux::lost_alpha(picture, output, behind)?.as_slice(), common)
}
