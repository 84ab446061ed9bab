//! A sample that waits in a queue of them.

use crate::sampler::PixelSampler;
use crate::task::Task;
use bilux_scene::{Ray, Wavelength};

/// A sample of the film.
pub struct QueuedSample {
    /// From the camera.
    pub(crate) ray: Ray,
    pub(super) sampler: PixelSampler,
    pub(super) wavelength: Wavelength,
    /// Its camera subpath is traced.
    pub(crate) is_wanted: bool,
}

impl QueuedSample {
    /// A sample whose random numbers and wavelength are those of a task.
    pub(crate) fn new(ray: Ray, task: &Task, is_wanted: bool) -> QueuedSample {
        QueuedSample { ray, sampler: task.sampler.clone(), wavelength: task.wavelength, is_wanted }
    }

    /// A sample whose light subpath alone is traced.
    pub(crate) fn of_light(time: f32, task: &Task) -> QueuedSample {
        let nowhere = Ray { time, ..Ray::new([0.0; 3], [0.0; 3]) };
        QueuedSample::new(nowhere, task, false)
    }

    /// Gives its random numbers and wavelength to the task that serves all samples.
    #[inline]
    pub(crate) fn enter(&self, task: &mut Task) {
        (task.sampler, task.wavelength) = (self.sampler.clone(), self.wavelength);
    }
}
