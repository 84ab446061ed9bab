//! Options for reading files, and reports about what was read.

use super::sandbox_paths::folder_of;
use crate::arguments::Common;
use crate::arguments::choices::{Choices, GlassArgument};
use crate::process::output;
use anyhow::bail;
use bilux::formats::{Glass, ReadOptions};
use bilux::scene::error::nearest_name;
use bilux::scene::{SceneBuilder, Warning};
use std::path::{Path, PathBuf};

/// The options for reading files, as the command line sets them.
pub(in crate::commands) fn read_options(common: &Common) -> ReadOptions {
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
pub(in crate::commands) fn read_options_with(common: &Common, choices: &Choices, time: f32) -> ReadOptions {
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
pub(in crate::commands) fn load(path: &Path, options: &ReadOptions) -> anyhow::Result<SceneBuilder> {
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
pub(in crate::commands) fn check_choices(scene: &SceneBuilder, choices: &Choices) -> anyhow::Result<()> {
    if choices.animation.is_some() && scene.inventory.animations.is_empty() {
        bail!("--animation: this file has no animations: leave it out");
    }
    if choices.variant.is_some() && scene.inventory.variants.is_empty() {
        bail!("--variant: this file has no variants of its materials: leave it out");
    }
    Ok(())
}

/// Prints each warning; under `--strict` the first one is an error.
pub(in crate::commands) fn report_warnings(warnings: &[Warning], common: &Common) -> anyhow::Result<()> {
    if let (true, Some(first)) = (common.strict, warnings.first()) {
        bail!("{first} (--strict treats this warning as an error)");
    }
    if !common.quiet {
        warnings.iter().for_each(output::warning);
    }
    Ok(())
}

/// Prints what is worth knowing about a file though nothing is wrong with it, with `-v`.
pub(in crate::commands) fn report_notes(notes: &[Warning], common: &Common) {
    if common.verbose > 0 {
        notes.iter().for_each(|note| output::eprint(format_args!("note: {note}")));
    }
}
