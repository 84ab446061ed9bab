//! Progress of a picture from small previews to the picture in full size.

use super::pace::Pace;
use crate::frame::Facts;
use crate::settings::Level;
use bilux::Outcome;
use bilux::transport::NoiseMeter;
use std::time::{Duration, Instant};

/// Progress of a picture, and how fast it comes about.
pub(super) struct Refinement {
    pub(super) level: Level,
    /// When something last changed, and how many times.
    pub(super) changed: Instant,
    pub(super) changes: u64,
    pub(super) pace: Pace,
    meter: NoiseMeter,
    /// The facts of the picture that was shown last.
    pub(super) facts: Facts,
    /// Whether nothing is to be done until something changes.
    pub(super) rests: bool,
    /// The samples that the picture in full size has before it takes the place of the clean one of half the size.
    pub(super) enough: u32,
    /// Whether the picture in full size was shown.
    pub(super) is_full_shown: bool,
    /// Time that the last change of level took.
    pub(super) entering: Duration,
    /// Time that the samples of the picture took so far.
    pub(super) worked: Duration,
}

impl Refinement {
    /// A picture of which nothing is there yet.
    pub(super) fn new() -> Refinement {
        Refinement {
            level: Level::Full,
            changed: Instant::now(),
            changes: 0,
            pace: Pace::new(),
            meter: NoiseMeter::default(),
            facts: Facts { side: "own", ..Facts::default() },
            rests: false,
            enough: 1,
            is_full_shown: false,
            entering: Duration::ZERO,
            worked: Duration::ZERO,
        }
    }

    /// Another picture begins, with its smallest preview.
    pub(super) fn begin(&mut self) {
        self.changes += 1;
        (self.enough, self.is_full_shown) = (1, false);
    }

    /// The samples of a picture begin anew.
    pub(super) fn begin_samples(&mut self) {
        self.facts.picture += 1;
        (self.meter, self.facts.noise) = (NoiseMeter::default(), None);
        self.worked = Duration::ZERO;
    }

    /// Looks at the first sample: noise is measured by what later samples change.
    pub(super) fn look_first(&mut self, outcome: &Outcome) {
        self.meter.look(&outcome.rendered.film, 1);
    }

    /// Measures the noise of a picture with more samples.
    pub(super) fn measure_noise(&mut self, outcome: &Outcome, samples: u32) {
        self.facts.noise = self.meter.look(&outcome.rendered.film, samples).or(self.facts.noise);
    }

    /// A frame of the picture with these facts is there. One that was denoised may be of an earlier picture.
    pub(super) fn note_frame(&mut self, facts: Facts) {
        self.is_full_shown |= !facts.is_preview;
        if facts.picture == self.facts.picture {
            self.facts = Facts { noise: self.facts.noise.or(facts.noise), ..facts };
        }
    }
}
