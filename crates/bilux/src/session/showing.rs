//! Changes of a picture that need no new samples.

use crate::Job;
use crate::settings::Settings;
use bilux_transport::RenderSettings;

/// The picture with settings that change no sample, and the number of samples ([`Settings::takes_samples_of`]).
pub(super) fn showing(job: &Job, settings: &Settings) -> Job {
    let settings = settings.with_samples_of(&job.settings);
    let (spp, threads) = (settings.spp, settings.threads);
    let render = RenderSettings { threads, spp, samples: 0..spp, ..job.render.clone() };
    Job { settings, render, ..job.clone() }
}

/// True if the number of samples changes nothing but the number of samples.
pub(super) fn may_take_more(job: &Job) -> bool {
    job.integrator().is_random() && !job.settings.background.is_cut_out()
}
