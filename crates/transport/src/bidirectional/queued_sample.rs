//! A sample that waits in a queue of them.

use crate::task::SampleState;
use bilux_scene::Ray;

/// A sample of the film.
pub(crate) struct QueuedSample {
    /// From the camera.
    pub(crate) ray: Ray,
    pub(crate) state: SampleState,
    /// Its camera subpath is traced.
    pub(crate) is_wanted: bool,
}

impl QueuedSample {
    /// A sample with both subpaths, or without the one from the camera.
    pub(crate) fn new((ray, state): (Ray, SampleState), is_wanted: bool) -> QueuedSample {
        QueuedSample { ray, state, is_wanted }
    }

    /// A sample whose light subpath alone is traced.
    pub(crate) fn of_light((time, state): (f32, SampleState)) -> QueuedSample {
        let nowhere = Ray { time, ..Ray::new([0.0; 3], [0.0; 3]) };
        QueuedSample::new((nowhere, state), false)
    }
}
