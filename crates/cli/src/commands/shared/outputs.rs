//! Destinations of pictures: files, or standard output, in any format.

use super::checks::check_folder;
use super::checks::check_quality;
use crate::arguments::streams::{PNG, is_stdout, named};
use crate::process::output;
use anyhow::bail;
use bilux::pictures::formats::{WriteOptions, format_of_path};
use bilux::pictures::{Picture, Source, format_named};
use bilux::scene::SceneError;
use std::io::IsTerminal;
use std::path::Path;

/// Refuses a picture that cannot be written there, before any work.
///
/// # Errors
/// If no picture is written in its format, it has no quality, there is no such folder, or it would fill a terminal.
pub fn check(output: &Path, format: Option<&str>, quality: Option<u8>) -> anyhow::Result<()> {
    if let Some(name) = format {
        if !is_stdout(output) {
            bail!("--output-format is for -o -: the extension of '{}' says its format", output.display());
        }
        if format_named(name).is_none_or(|row| row.write.is_none()) {
            let rows = bilux::pictures::PICTURE_FORMATS.iter().filter(|row| row.write.is_some());
            let names = rows.map(|row| row.entry.name);
            let at = crate::arguments::assignments::from_flag("--output-format");
            return Err(SceneError::unknown("picture format", name, names, &at).into());
        }
    }
    if !is_stdout(output) {
        check_folder(output)?;
        check_not_scene(output)?;
    } else if std::io::stdout().is_terminal() {
        bail!("-o -: a picture is no text for a terminal: name a file, or pipe it into another program");
    }
    check_quality(quality, &named(output, format))
}

/// Refuses a picture in a format of scenes.
fn check_not_scene(output: &Path) -> anyhow::Result<()> {
    let extension = output.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    if format_of_path(output).is_err() && bilux::formats::format_named(extension).is_some() {
        bail!(
            "{}: {extension} is a format of scenes, not of pictures: write a picture, such as {}, or convert the scene with \
             `bilux convert`",
            output.display(),
            output.with_extension(PNG).display()
        );
    }
    Ok(())
}

/// Writes a picture.
///
/// # Errors
/// If that fails.
pub fn write(
    output: &Path,
    format: Option<&str>,
    picture: &Picture,
    options: &WriteOptions,
) -> anyhow::Result<()> {
    write_source(output, format, Source::Planes(picture), options)
}

/// Writes a picture from any source.
///
/// # Errors
/// If that fails.
pub fn write_source(
    output: &Path,
    format: Option<&str>,
    picture: Source,
    options: &WriteOptions,
) -> anyhow::Result<()> {
    if is_stdout(output) {
        let bytes = bilux::pictures::write_source_bytes(format.unwrap_or(PNG), picture, options)?;
        return output::print_bytes(&bytes);
    }
    Ok(bilux::pictures::write_source(output, picture, options)?)
}
