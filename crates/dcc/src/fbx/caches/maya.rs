//! The caches of Maya: an XML file that describes them, and beside it one binary file, or one for each sample.

use super::around::Around;
use super::chunks;
use super::description::{Channel, Description};
use super::file::{CacheFile, Counts};
use bilux_import::FormatError;
use bilux_import::input::reading::Reading;
use bilux_math::Vec3;
use bilux_scene::Span;
use std::path::Path;

/// Units of time per second.
const TICKS: f64 = 6000.0;

/// The vectors of a channel at a time in seconds, and whether they are normals.
pub(super) fn read(
    path: &Path,
    channel: &str,
    seconds: f64,
    counts: Counts,
    at: &Span,
    reading: &mut Reading,
) -> Result<(bool, Vec<Vec3>), FormatError> {
    let fail = |what: String| FormatError::malformed(what, at.clone());
    let described = Description::read(path, at, reading)?;
    let named = described.channels.iter().find(|known| known.name == channel);
    // Marvelous Designer calls the only channel by another name in the scene.
    let only = described.channels.first().filter(|_| described.channels.len() == 1);
    let Some(found) = named.or(only) else {
        let known: Vec<&str> = described.channels.iter().map(|known| known.name.as_str()).take(8).collect();
        return Err(fail(format!("it has no channel '{channel}', but '{}'", known.join("', '"))));
    };
    // Normals may belong to corners; positions belong to points.
    let counts = if found.is_normals { counts } else { Counts { corners: counts.points, ..counts } };
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    // Times between two units are rounding errors.
    let wanted = (seconds * TICKS * 1000.0).round() / 1000.0;
    let mut around = Around::new(wanted);
    let files = match described.is_one_file {
        true => vec![format!("{stem}.{}", described.extension)],
        false => files_around(&stem, found, wanted, &described),
    };
    let (mut missing, mut opened) = (None, false);
    for name in files {
        match reading.locator.locate(path.parent(), &name, at) {
            Ok(file) => {
                let file = CacheFile::open(&file, at.clone(), reading)?;
                chunks::read(file, &found.name, counts, &mut around, reading)?;
                opened = true;
            }
            Err(error) => _ = missing.get_or_insert(error),
        }
    }
    if let Some(error) = missing.filter(|_| !opened) {
        return Err(error);
    }
    let vectors = around.vectors();
    if vectors.is_empty() && counts.points > 0 {
        return Err(fail(format!("there are no samples of the channel '{}'", found.name)));
    }
    Ok((found.is_normals, vectors))
}

/// The names of the files of the samples before and after a time.
fn files_around(stem: &str, channel: &Channel, wanted: f64, described: &Description) -> Vec<String> {
    let &Channel { start, end, step, .. } = channel;
    let last = (end.saturating_sub(start) / step).max(0) as f64;
    let place = ((wanted - start as f64) / step as f64).clamp(0.0, last);
    let mut samples = vec![place.floor(), place.ceil()];
    samples.dedup();
    let name = |sample: f64| {
        let time = start.saturating_add((sample as i64).saturating_mul(step));
        let (frame, rest) = (time.div_euclid(described.per_frame), time.rem_euclid(described.per_frame));
        let tick = if rest == 0 { String::new() } else { format!("Tick{rest}") };
        format!("{stem}Frame{frame}{tick}.{}", described.extension)
    };
    samples.into_iter().map(name).collect()
}
