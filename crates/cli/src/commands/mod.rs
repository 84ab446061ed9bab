//! One command a file. Each gives the exit status.

mod aov;
pub mod bench;
pub mod compare;
pub mod convert;
pub mod generate;
pub mod info;
pub mod list;
pub mod manual;
pub mod merge;
pub mod render;

use crate::arguments::Common;
use crate::output;
use anyhow::bail;
use bilux::formats::ReadOptions;
use bilux::scene::Warning;
use std::path::Path;

/// The work is done.
pub const DONE: u8 = 0;

/// How files are read, as the command line says.
fn read_options(common: &Common) -> ReadOptions {
    ReadOptions {
        max_memory: common.max_memory,
        allow_outside: common.allow_outside,
        strict: common.strict,
        ..ReadOptions::default()
    }
}

/// Says each warning once; under `--strict` the first is an error.
fn tell_warnings(warnings: &[Warning], common: &Common) -> anyhow::Result<()> {
    if let (true, Some(first)) = (common.strict, warnings.first()) {
        bail!("{first} (a warning, but --strict was asked for)");
    }
    if !common.quiet {
        warnings.iter().for_each(output::warning);
    }
    Ok(())
}

/// Finds out before the work whether a file can be written there.
fn check_folder(path: &Path) -> anyhow::Result<()> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        bail!("{}: there is no folder '{}': make it first", path.display(), folder.display());
    }
    if path.is_dir() {
        bail!("{}: is a folder: name a file in it", path.display());
    }
    Ok(())
}
