//! One command per file. Each returns the exit status.

mod aov;
pub mod bench;
pub mod compare;
pub mod convert;
pub mod denoise;
pub mod generate;
pub mod info;
pub mod list;
mod log;
pub mod manual;
pub mod merge;
pub mod render;
mod stats;
mod targets;
mod time_limit;

use crate::arguments::Common;
use crate::choices::{Choices, GlassArgument};
use crate::output;
use crate::sandbox::folder_of;
use anyhow::bail;
use bilux::formats::{Glass, ReadOptions};
use bilux::math::Rgb;
use bilux::pictures::Picture;
use bilux::pictures::formats::format_of_path;
use bilux::scene::{SceneBuilder, Span, Warning};
use std::path::{Path, PathBuf};

/// The exit status of a command that succeeded.
pub const DONE: u8 = 0;

/// The options for reading files, as the command line sets them.
fn read_options(common: &Common) -> ReadOptions {
    ReadOptions {
        max_memory: common.max_memory,
        allow_outside: common.allow_outside,
        working_folder: (!common.sandbox).then(PathBuf::new),
        strict: common.strict,
        ..ReadOptions::default()
    }
}

/// The same, with the choices within a file, at a time in seconds.
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

/// Refuses a choice among things that the file does not have.
fn check_choices(scene: &SceneBuilder, choices: &Choices) -> anyhow::Result<()> {
    if choices.animation.is_some() && scene.inventory.animations.is_empty() {
        bail!("--animation: this file has no animations: leave it out");
    }
    if choices.variant.is_some() && scene.inventory.variants.is_empty() {
        bail!("--variant: this file has no variants of its materials: leave it out");
    }
    Ok(())
}

/// Prints each warning; under `--strict` the first one is an error.
fn report_warnings(warnings: &[Warning], common: &Common) -> anyhow::Result<()> {
    if let (true, Some(first)) = (common.strict, warnings.first()) {
        bail!("{first} (a warning, which --strict makes an error)");
    }
    if !common.quiet {
        warnings.iter().for_each(output::warning);
    }
    Ok(())
}

/// Checks, before any work, that a file can be written there.
fn check_folder(path: &Path) -> anyhow::Result<()> {
    let folder = folder_of(path);
    if !folder.is_dir() {
        bail!("{}: there is no folder '{}': make it first", path.display(), folder.display());
    }
    if path.is_dir() {
        bail!("{}: this is a folder: name a file in it", path.display());
    }
    Ok(())
}

/// Refuses a quality for a format other than JPEG.
fn check_quality(quality: Option<u8>, output: &Path) -> anyhow::Result<()> {
    let format = format_of_path(output)?.entry.name;
    if quality.is_some() && format != "jpeg" {
        bail!("{}: --quality is for JPEG: name a .jpg, or leave it out", output.display());
    }
    Ok(())
}

/// Warns if a picture is transparent and its format cannot be.
fn warn_lost_alpha(
    picture: &Picture,
    output: &Path,
    behind: Option<Rgb>,
    common: &Common,
) -> anyhow::Result<()> {
    let format = format_of_path(output)?;
    let transparent = picture.channel("A").is_some_and(|alpha| alpha.iter().any(|&alpha| alpha < 1.0));
    if !transparent || format.holds_alpha || behind.is_some() && format.for_display {
        return Ok(());
    }
    let instead = if format.for_display { "white" } else { "black" };
    let message = format!(
        "{}: {} cannot be transparent, and has {instead} there: name a .png or an .exr to keep it",
        output.display(),
        format.entry.name
    );
    report_warnings(&[Warning { message, at: Span::default() }], common)
}
