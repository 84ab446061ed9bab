//! Files that commands read, or standard input in their place.

use super::pictures::{holds_picture, read_picture, report};
use super::reading::load;
use crate::arguments::Common;
use crate::arguments::assignments::from_flag;
use crate::commands::render::targets::is_stdout;
use crate::process::usage;
use anyhow::{Context, bail};
use bilux::formats::ReadOptions;
use bilux::pictures::{
    Interleaved, Limits, PICTURE_FORMATS, Picture, foreign_format, read_interleaved, read_interleaved_bytes,
};
use bilux::scene::{SceneBuilder, SceneError};
use std::io::Read;
use std::path::Path;

/// Name of standard input in messages.
const STANDARD_INPUT: &str = "standard input";

/// Detects the format of what is on standard input.
const AUTO: &str = "auto";

/// A file, or all that was on standard input.
pub struct Given<'a> {
    path: &'a Path,
    /// The bytes of standard input, which can be read only once.
    piped: Option<Vec<u8>>,
    /// The format of these bytes; detected from the first of them if this is empty.
    format: &'a str,
}

impl<'a> Given<'a> {
    /// Reads standard input, if the path is `-`; `format` is that of a scene there.
    ///
    /// # Errors
    /// If there is no such format, or standard input is empty or cannot be read.
    pub fn open(path: &'a Path, format: &'a str, common: &Common) -> anyhow::Result<Given<'a>> {
        if !is_stdout(path) {
            return Ok(Given { path, piped: None, format: "" });
        }
        check_input_format(format).map_err(usage::wrong)?;
        let mut bytes = Vec::new();
        let input = std::io::stdin().take(common.max_memory).read_to_end(&mut bytes);
        input.context("cannot read standard input")?;
        if bytes.is_empty() {
            bail!("standard input is empty: name a file, or pipe one in");
        }
        Ok(Given { path, piped: Some(bytes), format: if format == AUTO { "" } else { format } })
    }

    /// Bytes of standard input, if it was read.
    pub fn piped(&self) -> Option<&[u8]> {
        self.piped.as_deref()
    }

    /// The path, as sandboxes know it: a scene on standard input may name files in the working directory.
    pub fn place(path: &Path) -> &Path {
        if is_stdout(path) { Path::new("./stdin") } else { path }
    }

    /// Reads the scene.
    ///
    /// # Errors
    /// As [`load`].
    pub fn scene(&self, options: &ReadOptions) -> anyhow::Result<SceneBuilder> {
        let Some(bytes) = &self.piped else { return load(self.path, options) };
        Ok(bilux::formats::read_bytes(bytes, self.format, Some(Path::new(".")), STANDARD_INPUT, options)?)
    }

    /// True for a picture.
    pub fn holds_picture(&self) -> bool {
        let Some(bytes) = &self.piped else { return holds_picture(self.path) };
        self.format.is_empty()
            && (PICTURE_FORMATS.iter().any(|row| (row.sniff)(bytes))
                || foreign_format(bytes).is_some_and(|format| format.is_picture))
    }

    /// Reads a picture that is stored in sRGB bytes, and reports what is wrong with it; `None` for any other picture.
    ///
    /// # Errors
    /// If it is none, or takes more memory than is allowed.
    pub fn stored_picture(&self, limits: &Limits, common: &Common) -> anyhow::Result<Option<Interleaved>> {
        let (read, path) = match &self.piped {
            Some(bytes) => {
                let path = Path::new(STANDARD_INPUT);
                (read_interleaved_bytes(bytes, None, limits).map_err(|error| error.in_file(path)), path)
            }
            None => (read_interleaved(self.path, limits), self.path),
        };
        let Some(mut stored) = read? else { return Ok(None) };
        report(&std::mem::take(&mut stored.warnings), path, common)?;
        Ok(Some(stored))
    }

    /// Reads a picture, of a part of a larger one only the part, and reports what is wrong with it.
    ///
    /// # Errors
    /// If it is none, or takes more memory than is allowed.
    pub fn picture(&self, limits: &Limits, common: &Common) -> anyhow::Result<Picture> {
        let Some(bytes) = &self.piped else { return read_picture(self.path, limits, common) };
        let path = Path::new(STANDARD_INPUT);
        let mut picture =
            bilux::pictures::read_crop_bytes(bytes, None, limits).map_err(|error| error.in_file(path))?;
        report(&std::mem::take(&mut picture.warnings), path, common)?;
        Ok(picture)
    }
}

/// Refuses an unknown scene format.
fn check_input_format(name: &str) -> anyhow::Result<()> {
    if name == AUTO || bilux::formats::format_named(name).is_some_and(|row| row.reads()) {
        return Ok(());
    }
    let rows = bilux::formats::SCENE_FORMATS.iter().filter(|row| row.reads());
    let names = rows.map(|row| row.entry.name).chain([AUTO]);
    Err(SceneError::unknown("scene format", name, names, &from_flag("--input-format")).into())
}
