//! Standard streams in place of files: `-`.

use std::path::{Path, PathBuf};

/// The format of a picture on standard output, if nothing else is said.
pub const PNG: &str = "png";

/// True for `-`.
pub fn is_stdout(path: &Path) -> bool {
    path == Path::new("-")
}

/// The name of a picture, which says its format: on standard output one of its own.
pub fn named(output: &Path, format: Option<&str>) -> PathBuf {
    match is_stdout(output) {
        true => Path::new("stdout").with_extension(format.unwrap_or(PNG)),
        false => output.to_owned(),
    }
}
