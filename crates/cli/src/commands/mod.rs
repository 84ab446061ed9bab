//! One command a file. Each gives the exit status.

mod aov;
pub mod bench;
pub mod compare;
pub mod convert;
pub mod denoise;
pub mod generate;
pub mod info;
pub mod list;
pub mod manual;
pub mod merge;
pub mod render;
mod stats;
mod time_limit;

use crate::arguments::Common;
use crate::choices::{Choices, GlassArgument};
use crate::output;
use anyhow::bail;
use bilux::formats::{Glass, ReadOptions};
use bilux::scene::{SceneBuilder, Warning};
use std::path::{Path, PathBuf};

/// The work is done.
pub const DONE: u8 = 0;

/// How files are read, as the command line says.
fn read_options(common: &Common) -> ReadOptions {
    ReadOptions {
        max_memory: common.max_memory,
        allow_outside: common.allow_outside,
        working_folder: (!common.sandbox).then(PathBuf::new),
        strict: common.strict,
        ..ReadOptions::default()
    }
}

/// The same with what is chosen in a file, at a time in seconds.
fn read_options_with(common: &Common, choices: &Choices, time: f32) -> ReadOptions {
    ReadOptions {
        time,
        animation: choices.animation.clone(),
        variant: choices.variant.clone(),
        glass: match choices.glass {
            GlassArgument::Auto => Glass::Auto,
            GlassArgument::Thin => Glass::Thin,
            GlassArgument::Solid => Glass::Solid,
        },
        light_radius: choices.light_radius,
        ..read_options(common)
    }
}

/// Refuses a choice between things of which the file has none.
fn check_choices(scene: &SceneBuilder, choices: &Choices) -> anyhow::Result<()> {
    if choices.animation.is_some() && scene.inventory.animations.is_empty() {
        bail!("--animation: there are no animations in this file");
    }
    if choices.variant.is_some() && scene.inventory.variants.is_empty() {
        bail!("--variant: there are no variants of materials in this file");
    }
    Ok(())
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
