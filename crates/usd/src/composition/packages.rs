//! Layers in packages.

use bilux_import::FormatError;
use bilux_import::bytes::text::whole_file;
use bilux_import::input::reading::Reading;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The layer of a package that stands for all of it: the first.
pub(crate) fn root_of_package(
    reading: &mut Reading,
    package: &Path,
    name: &Arc<str>,
) -> Result<PathBuf, FormatError> {
    if reading.locator.archives.at(package).is_none() {
        reading.mount(package, name)?;
    }
    let archive = reading.locator.archives.at(package);
    let is_layer = |name: &str| {
        let name = name.to_ascii_lowercase();
        [".usdc", ".usda", ".usd"].iter().any(|end| name.ends_with(end))
    };
    let first = archive.and_then(|archive| archive.members().iter().find(|member| is_layer(&member.name)));
    let first = first.ok_or_else(|| {
        FormatError::malformed("this package has no layer: put a .usdc file first in it", whole_file(name))
    })?;
    Ok(package.join(&first.name))
}

/// The parts of `package.usdz[layer.usd]`.
pub(super) fn in_package(asset: &str) -> Option<(&str, &str)> {
    asset.strip_suffix(']')?.split_once('[')
}
