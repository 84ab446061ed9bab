//! One command per file. Each returns the exit status.

pub(crate) mod advice;
pub(crate) mod denoisers;
pub(crate) mod progress;
pub(crate) mod sandbox_paths;

mod aov;
pub mod bench;
pub mod compare;
mod contours;
pub mod convert;
pub mod denoise;
pub mod explain;
pub mod farm;
mod finishing;
mod frames;
pub mod generate;
mod given;
pub mod info;
mod input;
mod keeping;
mod lengths;
pub mod list;
mod log;
pub mod manual;
pub mod merge;
mod outputs;
mod pictures;
mod plan;
pub mod render;
mod replaying;
pub mod sensor;
pub mod serve;
mod stats;
mod targets;
mod time_limit;
mod watching;
pub mod worker;
mod written;

use crate::arguments::Common;
use crate::arguments::choices::{Choices, GlassArgument};
use crate::commands::sandbox_paths::folder_of;
use crate::process::output;
use anyhow::bail;
use bilux::formats::{Glass, ReadOptions};
use bilux::math::Rgb;
use bilux::pictures::Picture;
use bilux::pictures::format_named;
use bilux::pictures::formats::format_of_path;
use bilux::scene::error::nearest_name;
use bilux::scene::{SceneBuilder, Warning};
use std::path::{Path, PathBuf};

/// The exit status of a command that succeeded.
pub const DONE: u8 = 0;

/// The options for reading files, as the command line sets them.
fn read_options(common: &Common) -> ReadOptions {
    ReadOptions {
        max_memory: common.max_memory,
        allow_outside: common.allow_outside,
        whole_package: !common.sandbox,
        working_folder: (!common.sandbox).then(PathBuf::new),
        strict: common.strict,
        ..ReadOptions::default()
    }
}

/// The options for reading files, with the choices within a file, at a time in seconds.
fn read_options_with(common: &Common, choices: &Choices, time: f32) -> ReadOptions {
    ReadOptions {
        time,
        animation: choices.animation.clone(),
        variant: choices.variant.clone(),
        subdivide: choices.subdivide,
        definitions: choices.definitions.clone(),
        glass: match choices.glass {
            GlassArgument::Auto => Glass::Auto,
            GlassArgument::Thin => Glass::Thin,
            GlassArgument::Solid => Glass::Solid,
        },
        light_radius: choices.light_radius,
        ..read_options(common)
    }
}

/// Reads a scene file; if there is none of this name, suggests the one that is called most like it.
fn load(path: &Path, options: &ReadOptions) -> anyhow::Result<SceneBuilder> {
    let text = path.to_string_lossy();
    if text.starts_with("http://") || text.starts_with("https://") {
        bail!("{text}: this is an address, not a file: download it first");
    }
    let result = bilux::load(path, options);
    let (Err(error), false, Some(name)) = (&result, path.exists(), path.file_name()) else {
        return Ok(result?);
    };
    let files = std::fs::read_dir(folder_of(path)).into_iter().flatten().flatten();
    let files: Vec<String> = files.map(|file| file.file_name().to_string_lossy().into_owned()).collect();
    match nearest_name(&name.to_string_lossy(), &files) {
        Some(near) => bail!("{error}; did you mean '{}'?", path.with_file_name(near).display()),
        None => Ok(result?),
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
        bail!("{first} (--strict treats this warning as an error)");
    }
    if !common.quiet {
        warnings.iter().for_each(output::warning);
    }
    Ok(())
}

/// Prints what is worth knowing about a file though nothing is wrong with it, with `-v`.
fn report_notes(notes: &[Warning], common: &Common) {
    if common.verbose > 0 {
        notes.iter().for_each(|note| output::eprint(format_args!("note: {note}")));
    }
}

/// Checks, before any work, that a file can be written there.
fn check_folder(path: &Path) -> anyhow::Result<()> {
    let folder = folder_of(path);
    if !folder.is_dir() {
        bail!("{}: there is no folder '{}': create it first", path.display(), folder.display());
    }
    if path.is_dir() {
        bail!("{}: this is a folder: name a file in it", path.display());
    }
    Ok(())
}

/// Refuses to write a file over one of the files that the command reads.
fn check_not_input<'a>(output: &Path, inputs: impl IntoIterator<Item = &'a Path>) -> anyhow::Result<()> {
    let Ok(full) = output.canonicalize() else { return Ok(()) };
    if inputs.into_iter().any(|input| input.canonicalize().is_ok_and(|input| input == full)) {
        bail!("{}: this file is read, so it is not overwritten: write to another file", output.display());
    }
    Ok(())
}

/// True for files that are read as pictures, even in formats that are never written.
pub fn is_picture(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str());
    extension.is_some_and(|extension| format_named(extension).is_some())
}

/// Refuses a quality for a format other than JPEG.
fn check_quality(quality: Option<u8>, output: &Path) -> anyhow::Result<()> {
    let format = format_of_path(output)?.entry.name;
    if quality.is_some() && format != "jpeg" {
        bail!("{}: --quality is only for JPEG: write a .jpg, or leave it out", output.display());
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
    report_warnings(bilux::lost_alpha(picture, output, behind)?.as_slice(), common)
}
