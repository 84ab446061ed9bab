//! `bilux merge`: merges partial renders into one picture.

use crate::arguments::{Common, Merge};
use crate::commands::DONE;
use crate::commands::shared::checks::check_folder;
use crate::commands::shared::checks::check_not_input;
use crate::commands::shared::checks::warn_lost_alpha;
use crate::commands::shared::sandbox_paths::SandboxPaths;
use crate::process::{output, usage};
use anyhow::{Context, bail};
use bilux::Display;
use bilux::merging::Merging;
use bilux::pictures::formats::format_of_path;
use bilux::pictures::{Limits, Picture};

pub fn run(arguments: &Merge, common: &Common) -> anyhow::Result<u8> {
    check_folder(&arguments.output).map_err(usage::wrong)?;
    let parts = arguments.parts.iter().map(|part| &**part);
    check_not_input(&arguments.output, parts).map_err(usage::wrong)?;
    let format = format_of_path(&arguments.output).map_err(usage::wrong)?;
    let mut confines = SandboxPaths::default().writing(&arguments.output);
    confines.check_written(&arguments.output, common).map_err(usage::wrong)?;
    for part in &arguments.parts {
        confines = confines.reading(part);
    }
    confines.enter(common)?;
    let mut merging = Merging::default();
    for part in &arguments.parts {
        let picture = bilux::pictures::read_crop(part, &Limits::new(common.max_memory))?;
        merging.add(&picture).with_context(|| part.display().to_string())?;
    }
    check_complete(&merging, arguments, common)?;
    let is_exr = format.entry.name == "exr";
    if is_exr && merging.left_out() {
        output::warning(format_args!(
            "the variance of light-traced samples cannot be merged, so it is left out"
        ));
    }
    // If a part is still missing, the sums of an .exr allow adding it later.
    let (picture, display) = merging.picture(is_exr)?;
    write(picture, display, arguments, common)?;
    if !common.quiet {
        let parts = output::counted(arguments.parts.len(), "part", "parts");
        output::eprint(format_args!("{}: {parts} merged", arguments.output.display()));
    }
    Ok(DONE)
}

/// Refuses to make a picture that lacks samples, unless it is meant to.
fn check_complete(merging: &Merging, arguments: &Merge, common: &Common) -> anyhow::Result<()> {
    let missing = merging.missing();
    if missing.is_nothing() {
        return Ok(());
    }
    let output = arguments.output.display();
    if !arguments.partial {
        bail!(
            "{output}: the parts lack {missing}: name the parts with them too, or add --partial to merge what \
             there is"
        );
    }
    if !common.quiet {
        output::warning(format_args!("{output}: the parts lack {missing}"));
    }
    Ok(())
}

/// Writes the picture as its parts say that it is to be shown.
fn write(mut picture: Picture, display: Display, arguments: &Merge, common: &Common) -> anyhow::Result<()> {
    let options = display.options(&mut picture);
    warn_lost_alpha(&picture, &arguments.output, options.behind, common)?;
    Ok(bilux::pictures::write(&arguments.output, &picture, &options)?)
}
