//! Denoisers of a picture and its shadows, and the time that this takes.

use super::Subject;
use crate::settings::Settings;
use crate::{Error, JobRequest};
use bilux_pictures::denoise::{Denoiser, DenoiserChoice, Task, denoiser};
use bilux_transport::{RenderSettings, shadow_alpha_time};
use std::time::Duration;

/// Denoiser of the picture, if any.
///
/// # Errors
/// If the denoiser that was asked for is not available.
pub(super) fn chosen(
    request: &JobRequest,
    settings: &Settings,
    render: &RenderSettings,
) -> Result<Option<DenoiserChoice>, Error> {
    let Some(name) = request.denoiser_name(settings) else { return Ok(None) };
    let task = Task {
        size: (render.width as usize, render.height as usize),
        threads: settings.threads,
        // Any more of it is better spent on samples.
        time: render.stop.time_limit.map(|limit| limit / 4),
        sandboxed: request.sandboxed,
    };
    Ok(Some(denoiser(name, &task)?))
}

/// Denoiser of a shadow on an invisible ground, where the picture is denoised: the built-in filter.
pub(super) fn of_shadow(settings: &Settings) -> Result<Box<dyn Denoiser>, Error> {
    Ok(denoiser("builtin", &threads_task(settings))?.denoiser)
}

/// The time set aside for the shadow on an invisible ground.
pub(super) fn shadow_time(subject: &Subject, settings: &Settings) -> Duration {
    if subject.catcher.is_none() || !settings.background.is_cut_out() {
        return Duration::ZERO;
    }
    let pixels = settings.width as usize * settings.height as usize;
    shadow_alpha_time(pixels, threads_task(settings).thread_count())
}

fn threads_task(settings: &Settings) -> Task {
    Task { threads: settings.threads, ..Task::default() }
}
