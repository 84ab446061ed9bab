//! Opens files that hold something.

use crate::FormatError;
use crate::bytes::text::whole_file;
use bilux_pictures::open_regular;
use std::fs;
use std::path::Path;

/// Opens a file for reading, and gives its length too.
///
/// # Errors
/// If it cannot be opened, or is a folder, a pipe or a device.
pub fn open(path: &Path) -> Result<(fs::File, u64), FormatError> {
    let failed = |source| FormatError::Io { path: path.to_owned(), action: "open it", source };
    let file = open_regular(path).map_err(failed)?;
    let metadata = file.metadata().map_err(failed)?;
    if metadata.is_dir() {
        let at = whole_file(&path.display().to_string().into());
        return Err(FormatError::malformed("this is a folder: name a scene file in it", at));
    }
    Ok((file, metadata.len()))
}
