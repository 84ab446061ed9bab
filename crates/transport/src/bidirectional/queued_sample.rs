//! A sample that waits in a queue of them.

use crate::sampling::task::SampleState;
use bilux_scene::Ray;

/// A sample of the film.
pub(crate) struct QueuedSample {
    /// From the camera.
    pub(crate) ray: Ray,
    pub(crate) state: SampleState,
    /// Whether its camera subpath is traced.
    pub(crate) is_wanted: bool,
    /// The beams of its light subpath are kept.
    pub(crate) has_beams: bool,
}

impl QueuedSample {
    /// A sample with both subpaths, or without the one from the camera.
    pub(crate) fn new((ray, state): (Ray, SampleState), is_wanted: bool) -> QueuedSample {
        let is_wanted = is_wanted && !ray.is_nowhere();
        QueuedSample { ray, state, is_wanted, has_beams: false }
    }

    /// A sample whose light subpath alone is traced, and its beams kept if it `has_beams`.
    pub(crate) fn of_light((time, state): (f32, SampleState), has_beams: bool) -> QueuedSample {
        let nowhere = Ray { time, ..Ray::new([0.0; 3], [0.0; 3]) };
        QueuedSample { has_beams, ..QueuedSample::new((nowhere, state), false) }
    }
}
