//! Amount of work for a picture, depending on the available time.

use super::library::{Purpose, Quality};
use std::time::Duration;

/// Ordered from best to fastest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Effort {
    /// Denoises albedo and normals first; then uses the best network.
    Best,
    /// Denoises albedo and normals first; then uses a network of half the size.
    Balanced,
    /// The smallest network, with albedo and normals as they are.
    Least,
}

/// Approximate setup time, whatever the number of pixels.
const BEGIN: Duration = Duration::from_millis(20);

impl Effort {
    const ALL: [Effort; 3] = [Effort::Best, Effort::Balanced, Effort::Least];

    /// The best effort that fits into a time limit, and its approximate time for this many pixels and threads.
    pub(super) fn within(limit: Option<Duration>, pixels: u64, threads: usize) -> (Effort, Duration) {
        let timed = Effort::ALL.map(|effort| (effort, effort.time(pixels, threads)));
        let fits = |&(_, time): &(Effort, Duration)| limit.is_none_or(|limit| time <= limit);
        timed.into_iter().find(fits).unwrap_or(timed[2])
    }

    fn time(self, pixels: u64, threads: usize) -> Duration {
        // Per pixel on one thread, as measured with 512 x 512.
        let nanoseconds = match self {
            Effort::Best => 8000,
            Effort::Balanced => 5000,
            Effort::Least => 1500,
        };
        BEGIN + Duration::from_nanos(pixels.saturating_mul(nanoseconds) / threads.max(1) as u64)
    }

    /// True if albedo and normals are denoised before they are used as features.
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

    /// The filter for albedo or normals. They have so little noise that the smallest network leads to the same final
    /// picture.
    pub(super) fn for_feature(input: &'static [&'static str]) -> Purpose {
        Purpose { inputs: input, hdr: false, clean: false, quality: Quality::Fast }
    }
}
