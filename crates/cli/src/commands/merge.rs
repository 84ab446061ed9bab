//! `bilux merge`: merges partial renders into one picture.

use super::{DONE, check_folder, check_not_input, warn_lost_alpha};
use crate::arguments::{Common, Merge};
use crate::sandbox::SandboxPaths;
use crate::{output, usage};
use anyhow::Context;
use bilux::Display;
use bilux::description::{SETTINGS, SOFTWARE, is_handed_on};
use bilux::pictures::formats::format_of_path;
use bilux::pictures::{Limits, Picture};
use bilux::transport::{Film, JoinedLayers, Window};
use std::collections::BTreeMap;
use std::ops::Range;

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
    let mut joined: Option<(Film, Display)> = None;
    let mut described = BTreeMap::new();
    for part in &arguments.parts {
        let picture = bilux::pictures::read_crop(part, &Limits::new(common.max_memory))?;
        let next = Film::from_partial(&picture).with_context(|| part.display().to_string())?;
        layers.add(&picture, &next);
        for (key, value) in picture.metadata.iter().filter(|(key, _)| is_handed_on(key)) {
            // As EXR calls it.
            let key = if key == "software" { SOFTWARE } else { key };
            described.entry(key.to_owned()).or_insert_with(|| value.clone());
        }
        match &mut joined {
            Some((film, _)) => film.merge(&next).with_context(|| part.display().to_string())?,
            None => {
                let display = Display::recorded(&picture).with_context(|| part.display().to_string())?;
                joined = Some((next, display));
            }
        }
    }
    let (film, display) = joined.context("there is nothing to merge: name partial renders")?;
    if is_exr && layers.left_out() {
        output::warning(format_args!(
            "the variance of light-traced samples cannot be merged, so it is left out"
        ));
    }
    let mut picture = if is_exr {
        // If a part is still missing, its sums allow adding it later.
        let mut picture = film.to_partial()?;
        display.record(&mut picture);
        layers.push(&mut picture, &film)?;
        picture
    } else {
        let mut picture = film.to_picture()?;
        layers.push_coverage(&mut picture)?;
        picture
    };
    if !described.get(SETTINGS).is_some_and(|settings| is_complete(&film, settings)) {
        described.remove(SETTINGS);
    }
    picture.metadata.extend(described);
    write(picture, display, arguments, common)?;
    if !common.quiet {
        let parts = output::counted(arguments.parts.len(), "part", "parts");
        output::eprint(format_args!("{}: {parts} merged", arguments.output.display()));
    }
    Ok(DONE)
}

/// True if the parts together have all samples of the whole picture that their settings speak of.
fn is_complete(film: &Film, settings: &str) -> bool {
    let spp = settings.split(' ').find_map(|word| word.strip_prefix("spp=")?.parse::<u64>().ok());
    let taken = |(window, samples): &(Window, Range<u32>)| window.pixels() as u64 * samples.len() as u64;
    let taken: u64 = film.coverage().pieces().iter().map(taken).sum();
    spp.is_some_and(|spp| taken == spp * u64::from(film.width()) * u64::from(film.height()))
}

/// Writes the picture as its parts say that it is to be shown.
fn write(mut picture: Picture, display: Display, arguments: &Merge, common: &Common) -> anyhow::Result<()> {
    let options = display.options(&mut picture);
    warn_lost_alpha(&picture, &arguments.output, options.behind, common)?;
    Ok(bilux::pictures::write(&arguments.output, &picture, &options)?)
}
