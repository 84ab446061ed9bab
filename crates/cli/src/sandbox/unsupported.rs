//! Systems other than Linux: a process cannot restrict itself in the same way.

use super::enforcement::Enforcement;
use std::path::{Path, PathBuf};

/// Rules that this kernel can enforce: none.
pub fn available() -> Enforcement {
    Enforcement::Nothing
}

/// Restricts nothing.
pub fn restrict(_: &[PathBuf], _: Option<&Path>) -> anyhow::Result<Enforcement> {
    Ok(Enforcement::Nothing)
}
