//! `bilux merge`: merges partial renders into one picture.

use super::{DONE, check_folder, check_not_input};
use crate::arguments::{Common, Merge};
use crate::sandbox::SandboxPaths;
use crate::{output, usage};
use anyhow::Context;
use bilux::pictures::Limits;
use bilux::pictures::formats::format_of_path;
use bilux::transport::{Film, JoinedLayers};

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
    let is_exr = format.entry.name == "exr";
    let mut layers = JoinedLayers::default();
    let mut joined: Option<Film> = None;
    for part in &arguments.parts {
        let picture = bilux::pictures::read_with(part, &Limits::new(common.max_memory))?;
        let next = Film::from_partial(&picture).with_context(|| part.display().to_string())?;
        if is_exr {
            layers.add(&picture, &next);
        }
        match &mut joined {
            Some(film) => film.merge(&next).with_context(|| part.display().to_string())?,
            None => joined = Some(next),
        }
    }
    let film = joined.context("there is nothing to merge: name partial renders")?;
    if layers.left_out() {
        output::warning(format_args!(
            "the variance of light-traced samples cannot be merged, so it is left out"
        ));
    }
    // If a part is still missing, an .exr keeps the sums, so that it can be added later.
    let mut picture = if is_exr { film.to_partial()? } else { film.to_picture()? };
    layers.push(&mut picture, &film)?;
    bilux::pictures::write(&arguments.output, &picture, &Default::default())?;
    if !common.quiet {
        let parts = output::counted(arguments.parts.len(), "part", "parts");
        output::eprint(format_args!("{}: {parts} merged", arguments.output.display()));
    }
    Ok(DONE)
}
