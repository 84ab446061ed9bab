//! `--lengths`: the light of a picture in intervals of the optical length of paths.

use crate::arguments::Common;
use crate::commands::shared::progress::Report;
use crate::process::interrupt::Interrupt;
use crate::process::output;
use bilux::math::Rgb;
use bilux::pictures::{Picture, WriteOptions};
use bilux::transport::LengthBins;
use bilux::{Job, Outcome};
use std::path::Path;

/// The extension of its file.
pub const EXTENSION: &str = "lengths.exr";

/// Takes the samples of the picture again, and writes `OUT.lengths.exr`: a layer for each interval, the layer `rest`, and all of them together
/// as the main picture. Returns false if it was stopped.
pub fn write(
    bins: LengthBins,
    job: &Job,
    outcome: &Outcome,
    output: &Path,
    common: &Common,
    interrupt: &Interrupt,
) -> anyhow::Result<bool> {
    let path = output.with_extension(EXTENSION);
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let report = Report::new(&name, common, interrupt.clone());
    let found = job.transient(bins, outcome.rendered.reached.map(|reached| reached.spp), &report)?;
    let seconds = report.finish();
    let Some(found) = found else {
        output::eprint(format_args!("{}: interrupted, so it was not written", path.display()));
        return Ok(false);
    };
    let count = bins.count as usize;
    let mut picture = Picture::new(found.window.width as usize, found.window.height as usize)?;
    let all = found.light.chunks(count).zip(&found.rest);
    let all: Vec<Rgb> =
        all.map(|(light, rest)| light.iter().fold(*rest, |sum, light| sum + *light)).collect();
    picture.push_rgb("", &all)?;
    for interval in 0..count {
        let light: Vec<Rgb> = found.light.iter().skip(interval).step_by(count).copied().collect();
        picture.push_rgb(&format!("length_{interval:05}"), &light)?;
    }
    picture.push_rgb("rest", &found.rest)?;
    picture.crop = outcome.rendered.film.crop();
    let LengthBins { begin, width, .. } = bins;
    picture.metadata.insert("bilux.lengths".to_owned(), format!("{begin},{width},{count}"));
    bilux::pictures::write(&path, &picture, &WriteOptions::default())?;
    if !common.quiet {
        output::eprint(format_args!("{}: {count} intervals of {width} m, {seconds:.2} s", path.display()));
    }
    Ok(true)
}
