//! The result of a render.

use crate::film::Film;
use crate::film::batch_means::BatchMeans;
use crate::film::interval::Interval;
use crate::schedule::plan::Choice;
use crate::schedule::stop::Reached;
use bilux_accel::Counters;
use std::time::Duration;

/// The result of a render.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The film; [`Film::sample_failures`] reports bad samples.
    pub film: Film,
    /// The work of tracing; only `rays` unless [`crate::RenderSettings::count_work`] was on.
    pub counters: Counters,
    /// True when it was cancelled. Then [`Film::coverage`] states which samples the film holds; each of them is
    /// complete.
    pub cancelled: bool,
    /// True when a limit of time ended it within a pass over the film: some pixels have one more sample than others.
    pub cut_short: bool,
    /// The distance between the pixels that surely have a sample, if the picture ended within its first pass under a limit of time. They
    /// are all those whose column and row are multiples of it; of the others only some have one ([`crate::Completion`]), and [`Film::coverage`]
    /// states where all have.
    pub spacing: Option<u32>,
    /// Time before the first sample: that of the pilot of an integrator that chooses.
    pub planning: Duration,
    /// The choice of an integrator that chooses.
    pub choice: Option<Choice>,
    /// State of the picture when it ended, where it could end early ([`crate::RenderSettings::stop`]).
    pub reached: Option<Reached>,
    /// The pixels' confidence intervals, where requested ([`crate::RenderSettings::interval`]): of whole iterations, even if
    /// it was cancelled.
    pub interval: Option<Interval>,
    /// Batches of samples, which give the variance of each pixel, where it was asked for ([`crate::RenderSettings::batch_means`]).
    pub batch_means: Option<BatchMeans>,
}
