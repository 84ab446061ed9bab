//! Samples: their random numbers and camera rays, what an integrator is given for one, and the light that it finds elsewhere on the film.

pub(crate) mod camera_rays;
pub(crate) mod sample_queue;
pub(crate) mod sampler;
pub(crate) mod splats;
pub(crate) mod task;
