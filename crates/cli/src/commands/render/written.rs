//! Denoising and writing of the picture of a render.

use super::aov::{self, Layers};
use super::input::Input;
use crate::commands::shared::checks::warn_lost_alpha;
use crate::commands::shared::outputs;
use crate::process::interrupt::Interrupt;
use anyhow::bail;
use bilux::pictures::Picture;
use bilux::pictures::denoise::DenoiserChoice;
use bilux::pictures::formats::BitDepth;
use bilux::{Job, Outcome};
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::thread::Builder;
use std::time::{Duration, Instant};

/// Interval at which it is checked whether denoising has to give way to saving what there is.
const TICK: Duration = Duration::from_millis(20);

/// The denoised picture, which is `None` if a signal or the timeout comes first: there is no time to wait for it.
fn denoised(
    outcome: &Arc<Outcome>,
    chosen: &Arc<DenoiserChoice>,
    interrupt: &Interrupt,
) -> anyhow::Result<Option<Picture>> {
    let (sender, receiver) = sync_channel(1);
    let work = {
        let (outcome, chosen) = (outcome.clone(), chosen.clone());
        move || drop(sender.send(outcome.denoised(&chosen)))
    };
    if Builder::new().name("denoising".to_owned()).spawn(work).is_err() {
        return Ok(Some(outcome.denoised(chosen)?));
    }
    loop {
        match receiver.recv_timeout(TICK) {
            Ok(picture) => return Ok(Some(picture?)),
            Err(RecvTimeoutError::Timeout) if interrupt.is_signalled() => return Ok(None),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => bail!("denoising failed: render with --denoise=off"),
        }
    }
}

/// Whether the picture in the file is denoised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Denoising {
    /// Not wanted.
    Off,
    /// Denoised.
    Done,
    /// Not denoised, since a signal or the timeout came first.
    CutShort,
}

/// Writes the picture, and says how long denoising took; a partial render goes into an `.exr` with its exact sums.
pub fn write(
    input: &Input,
    job: &Job,
    outcome: &Arc<Outcome>,
    denoiser: Option<&Arc<DenoiserChoice>>,
    layers: &Layers,
    output: &Path,
) -> anyhow::Result<(Denoising, Duration)> {
    let Input { arguments, common, interrupt, .. } = *input;
    let is_exr = aov::is_exr(&arguments.named(output));
    let is_part = is_exr && (arguments.is_part() || outcome.rendered.cancelled);
    let chosen = denoiser.filter(|_| !is_part);
    let begun = Instant::now();
    let smooth = chosen.map(|chosen| denoised(outcome, chosen, interrupt)).transpose()?.flatten();
    let time = begun.elapsed();
    let denoiser = chosen.filter(|_| smooth.is_some());
    let mut picture = match smooth {
        Some(picture) => picture,
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
    warn_lost_alpha(&picture, &arguments.named(output), options.behind, common)?;
    outputs::write(output, arguments.output_format.as_deref(), &picture, &options)?;
    let denoising = match (chosen, denoiser) {
        (None, _) => Denoising::Off,
        (Some(_), Some(_)) => Denoising::Done,
        (Some(_), None) => Denoising::CutShort,
    };
    Ok((denoising, time))
}
