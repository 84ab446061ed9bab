//! Places where the library may be found.

use super::python;
use std::env;
use std::path::{Path, PathBuf};

/// Name of the library's file.
pub(super) const FILE: &str = if cfg!(target_os = "windows") {
    "OpenImageDenoise.dll"
} else if cfg!(target_os = "macos") {
    "libOpenImageDenoise.2.dylib"
} else {
    "libOpenImageDenoise.so.2"
};

/// The library, or the folder that contains it, as named by the environment variable `OIDN_LIB`.
pub(super) fn named() -> Option<PathBuf> {
    let named = PathBuf::from(env::var_os("OIDN_LIB").filter(|named| !named.is_empty())?);
    Some(if named.is_dir() { named.join(FILE) } else { named })
}

/// Every file that may be the library, most likely first. Each is searched for only if those before it were of no
/// use: next to this program, where Python keeps packages, and, where `python3` is a script, where it says, which takes a tenth of a
/// second.
pub(super) fn files() -> impl Iterator<Item = PathBuf> {
    let beside = env::current_exe().ok().and_then(|program| program.parent().map(Path::to_owned));
    let beside = beside.into_iter().flat_map(|folder| [folder.join(FILE), folder.join("../lib").join(FILE)]);
    let in_packages = python::packages().into_iter().flat_map(|package| in_package(&package));
    let asked = std::iter::once_with(python::asked).flatten().flat_map(|package| in_package(&package));
    beside.chain(in_packages).chain(asked).filter(|file| file.is_file())
}

/// Paths of the library within the package pyoidn.
fn in_package(package: &Path) -> [PathBuf; 3] {
    let folder = if cfg!(target_os = "windows") { "bin" } else { "lib" };
    [package.join("oidn").join(folder).join(FILE), package.join(folder).join(FILE), package.join(FILE)]
}
