//! A sample that waits in a queue of them.

use crate::camera_rays::CameraRays;
use crate::failures::SamplePlace;
use crate::sample_queue::SampleSink;
use crate::task::SampleState;
use bilux_scene::Ray;

/// A sample of the film.
pub(crate) struct QueuedSample {
    /// From the camera.
    pub(crate) ray: Ray,
    pub(super) state: SampleState,
    /// Its camera subpath is traced.
    pub(crate) is_wanted: bool,
}

impl QueuedSample {
    /// Samples of a film, as their sink wants them.
    pub(crate) fn all(rays: &CameraRays, places: &[SamplePlace], sink: &SampleSink) -> Vec<QueuedSample> {
        places.iter().map(|&place| QueuedSample::new(rays.sample(place), sink.is_wanted(place))).collect()
    }

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
