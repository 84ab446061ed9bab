//! How the picture of a render becomes a file.

use super::{aov, warn_lost_alpha};
use crate::arguments::{Common, Render};
use crate::commands::targets::is_stdout;
use crate::output;
use bilux::pictures::denoise::DenoiserChoice;
use bilux::pictures::formats::BitDepth;
use bilux::transport::aovs::Aov;
use bilux::{ExtraLayers, Job, Outcome};
use std::path::Path;

/// The layers of an `.exr`.
pub struct Layers<'a> {
    /// Those that rendering keeps.
    pub kept: &'a [Aov],
    /// Those that are made after it.
    pub extra: Option<&'a ExtraLayers>,
}

/// True if only a part of the picture is rendered.
pub fn is_part(arguments: &Render) -> bool {
    arguments.samples.is_some() || arguments.crop.is_some()
}

/// Writes the picture; a partial render goes into an `.exr` with its exact sums. Returns true if it was denoised.
pub fn write(
    arguments: &Render,
    common: &Common,
    job: &Job,
    outcome: &Outcome,
    (denoiser, layers): (Option<&DenoiserChoice>, &Layers),
    output: &Path,
) -> anyhow::Result<bool> {
    let is_exr = !is_stdout(output) && aov::is_exr(output);
    let is_part = is_exr && (is_part(arguments) || outcome.rendered.cancelled);
    let denoiser = denoiser.filter(|_| !is_part);
    let mut picture = match denoiser {
        Some(chosen) => outcome.denoised(chosen)?,
        None if is_part => job.partial(outcome)?,
        None => outcome.picture()?,
    };
    job.describe(&mut picture, outcome, denoiser.map(|chosen| chosen.name));
    if is_exr {
        outcome.push_layers(&mut picture, layers.kept)?;
        if let Some(extra) = layers.extra {
            extra.push(&mut picture)?;
        }
        if denoiser.is_some() {
            picture.push_rgb("noisy", &outcome.picture()?.to_rgb().unwrap_or_default())?;
        }
    }
    let mut options = job.write_options_for(&picture)?;
    if arguments.bits == "16" {
        options.bit_depth = BitDepth::Sixteen;
    }
    options.quality = arguments.quality.unwrap_or(options.quality);
    if is_stdout(output) {
        output::print_bytes(&bilux::pictures::formats::write_bytes("png", &picture, &options)?)?;
    } else {
        warn_lost_alpha(&picture, output, options.behind, common)?;
        bilux::pictures::write(output, &picture, &options)?;
    }
    Ok(denoiser.is_some())
}
