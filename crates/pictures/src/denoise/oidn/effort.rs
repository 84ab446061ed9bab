//! How much work is put into a picture, by the time that there is.

use super::library::{Purpose, Quality};
use std::time::Duration;

/// From the best to the fastest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Effort {
    /// Albedo and normals are denoised first; then the best network.
    Best,
    /// The same with a network half as large.
    Balanced,
    /// The smallest network, and albedo and normals as they come.
    Least,
}

/// What is to be made ready before any number of pixels, about.
const BEGIN: Duration = Duration::from_millis(20);

impl Effort {
    const ALL: [Effort; 3] = [Effort::Best, Effort::Balanced, Effort::Least];

    /// The best that fits into a time, and how long it takes for so many pixels on so many threads, about.
    pub(super) fn within(limit: Option<Duration>, pixels: u64, threads: usize) -> (Effort, Duration) {
        let timed = Effort::ALL.map(|effort| (effort, effort.time(pixels, threads)));
        let fits = |&(_, time): &(Effort, Duration)| limit.is_none_or(|limit| time <= limit);
        timed.into_iter().find(fits).unwrap_or(timed[2])
    }

    fn time(self, pixels: u64, threads: usize) -> Duration {
        // Of a pixel on one thread, as measured with 512 x 512.
        let nanoseconds = match self {
            Effort::Best => 8000,
            Effort::Balanced => 5000,
            Effort::Least => 1500,
        };
        BEGIN + Duration::from_nanos(pixels.saturating_mul(nanoseconds) / threads.max(1) as u64)
    }

    /// True where albedo and normals are denoised before they help.
    pub(super) fn cleans(self) -> bool {
        self != Effort::Least
    }

    /// The filter for light.
    pub(super) fn for_light(self, inputs: &'static [&'static str]) -> Purpose {
        let quality = match self {
            Effort::Best => Quality::High,
            Effort::Balanced => Quality::Balanced,
            Effort::Least => Quality::Fast,
        };
        Purpose { inputs, hdr: true, clean: self.cleans() && inputs.len() > 1, quality }
    }

    /// The filter for albedo or normals. They have so little noise that the smallest network gives the same picture in the end.
    pub(super) fn for_feature(input: &'static [&'static str]) -> Purpose {
        Purpose { inputs: input, hdr: false, clean: false, quality: Quality::Fast }
    }
}
