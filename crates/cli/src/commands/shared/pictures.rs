//! Pictures that commands read: their layers, and what is wrong with them.

use super::checks::is_picture;
use super::reading::report_warnings;
use crate::arguments::Common;
use bilux::pictures::{Limits, PICTURE_FORMATS, Picture, PictureError, foreign_format, open_regular};
use bilux::scene::{Span, Warning};
use std::io::Read;
use std::path::Path;

/// Reads a picture, of a part of a larger one only the part, and reports what is wrong with it.
pub fn read_picture(path: &Path, limits: &Limits, common: &Common) -> anyhow::Result<Picture> {
    let mut picture = bilux::pictures::read_crop(path, limits)?;
    report(&std::mem::take(&mut picture.warnings), path, common)?;
    Ok(picture)
}

/// The picture with this layer as the main one ([`Picture::with_main`]).
pub fn with_main(
    picture: Picture,
    layer: Option<&str>,
    path: &Path,
    common: &Common,
) -> anyhow::Result<Picture> {
    let mut main = picture.with_main(layer).map_err(|error: PictureError| error.in_file(path))?;
    report(&std::mem::take(&mut main.warnings), path, common)?;
    Ok(main)
}

/// Reports the warnings of a picture file.
pub fn report(warnings: &[String], path: &Path, common: &Common) -> anyhow::Result<()> {
    let at = Span { file: path.display().to_string().into(), line: 0, column: 0 };
    let warning = |message: &String| Warning { message: message.clone(), at: at.clone() };
    report_warnings(&warnings.iter().map(warning).collect::<Vec<_>>(), common)
}

/// True for a file that is a picture, by its name, or if that says nothing, by its first bytes.
pub fn holds_picture(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    if is_picture(path) || bilux::formats::format_named(extension).is_some() {
        return is_picture(path);
    }
    let mut head = Vec::new();
    let read = open_regular(path).and_then(|file| file.take(4096).read_to_end(&mut head));
    read.is_ok()
        && (PICTURE_FORMATS.iter().any(|row| (row.sniff)(&head))
            || foreign_format(&head).is_some_and(|format| format.is_picture))
}
