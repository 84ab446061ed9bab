//! `bilux merge`: partial films into one picture.

use super::{DONE, check_folder};
use crate::arguments::{Common, Merge};
use crate::output;
use crate::usage;
use anyhow::Context;
use bilux::pictures::Limits;
use bilux::pictures::formats::format_of_path;
use bilux::transport::Film;
use std::path::Path;

pub fn run(arguments: &Merge, common: &Common) -> anyhow::Result<u8> {
    check_folder(&arguments.output).map_err(usage::wrong)?;
    let format = format_of_path(&arguments.output)?;
    let mut films = arguments.parts.iter().map(|part| read(part, common));
    let mut film = films.next().context("nothing to merge")??;
    for (part, next) in arguments.parts[1..].iter().zip(films) {
        film.merge(&next?).with_context(|| part.display().to_string())?;
    }
    // Where a part is still missing, an .exr keeps the sums, so that it can be added later.
    let picture = if format.entry.name == "exr" { film.to_partial()? } else { film.to_picture()? };
    bilux::pictures::write(&arguments.output, &picture, &Default::default())?;
    if !common.quiet {
        let parts = arguments.parts.len();
        output::say(format_args!("{}: {parts} parts joined", arguments.output.display()));
    }
    Ok(DONE)
}

fn read(part: &Path, common: &Common) -> anyhow::Result<Film> {
    let picture = bilux::pictures::read_with(part, &Limits::new(common.max_memory))?;
    Film::from_partial(&picture).with_context(|| part.display().to_string())
}
