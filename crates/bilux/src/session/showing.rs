//! Changes of a picture that need no new samples.

use crate::Job;
use crate::settings::Settings;
use bilux_transport::RenderSettings;

/// The picture with settings that change no sample, and the number of samples ([`Settings::takes_samples_of`]).
pub(super) fn showing(job: &Job, settings: &Settings) -> Job {
    let Settings { spp, threads, fps, exposure, states_exposure, auto_exposure, .. } = *settings;
    let Settings { background, linear_transfer, .. } = *settings;
    let (tonemap, denoise) = (settings.tonemap.clone(), settings.denoise.clone());
    let settings = Settings {
        spp,
        threads,
        fps,
        exposure,
        states_exposure,
        auto_exposure,
        background,
        linear_transfer,
        tonemap,
        denoise,
        ..job.settings.clone()
    };
    let render = RenderSettings { threads, spp, samples: 0..spp, ..job.render.clone() };
    Job { settings, render, ..job.clone() }
}

/// True if the number of samples changes nothing but the number of samples.
pub(super) fn may_take_more(job: &Job) -> bool {
    job.integrator().is_random() && !job.settings.background.is_cut_out()
}
