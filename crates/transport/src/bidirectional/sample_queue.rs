//! How many samples of an integrator are taken at a time.

use super::queued_sample::QueuedSample;
use crate::task::Task;
use bilux_math::{Rgb, Vec2};

/// The number of samples in a queue: the vertices of their light subpaths fit into the second cache.
pub(crate) const PATHS: usize = 256;

/// Takes many samples at a time, whose rays are traced in batches. Each finds the same light as on its own, bit for bit.
pub trait SampleQueue {
    /// Takes up to [`PATHS`] samples, and returns the light of each in its own pixel. Splats go to `add_splat` in the order of
    /// the samples: the index of a sample, the point of the film, the light as an integral over the whole film.
    ///
    /// `task` has the tools that serve all samples; each has its own random numbers and wavelength.
    fn take(
        &mut self,
        samples: &[QueuedSample],
        task: &mut Task,
        add_splat: &mut dyn FnMut(usize, Vec2, Rgb),
    ) -> Vec<Rgb>;
}
