//! One sample once more, with all that happens on its way.

use crate::error::{FilmError, RenderError};
use crate::film::{MAX_SIDE, SamplePlace};
use crate::integrators::PixelIntegrator;
use crate::render::{Eye, RenderSettings};
use crate::task::Event;
use bilux_math::Rgb;
use bilux_scene::{Camera, Ray, Scene, Tracer};
use std::fmt;

/// A sample's story; its `Display` is for people.
#[derive(Clone, Debug, PartialEq)]
pub struct Replay {
    /// Which sample.
    pub place: SamplePlace,
    /// The ray that the camera sent.
    pub ray: Ray,
    /// What happened on the way.
    pub events: Vec<Event>,
    /// What came of it.
    pub radiance: Rgb,
    /// How many rays it took.
    pub rays: u64,
}

/// Takes one sample of one pixel again, exactly as [`crate::render()`] takes it.
///
/// # Errors
/// When the pixel is not on the film.
pub fn replay(
    scene: &Scene,
    camera: &dyn Camera,
    integrator: &dyn PixelIntegrator,
    settings: &RenderSettings,
    place: SamplePlace,
) -> Result<Replay, RenderError> {
    let SamplePlace { x, y, sample } = place;
    let RenderSettings { width, height, .. } = *settings;
    if width > MAX_SIDE || height > MAX_SIDE {
        return Err(FilmError::Size { width, height }.into());
    }
    if x >= width || y >= height {
        return Err(RenderError::Pixel { x, y, width, height });
    }
    let eye = Eye::new(scene, camera, integrator, settings);
    let mut tracer = Tracer::new(scene, false);
    let (ray, mut task) = eye.sample(&mut tracer, x, y, sample);
    task.events = Some(Vec::new());
    let radiance = integrator.radiance(&ray, &mut task);
    let events = task.events.take().unwrap_or_default();
    Ok(Replay { place, ray, events, radiance, rays: tracer.counters.rays })
}

impl fmt::Display for Replay {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let SamplePlace { x, y, sample } = self.place;
        let Ray { origin, direction, time, .. } = self.ray;
        writeln!(f, "pixel {x},{y} sample {sample}")?;
        writeln!(f, "camera ray from {origin:?} towards {direction:?} at {time} s")?;
        for event in &self.events {
            writeln!(f, "{:2$}{}", "", event.what, 2 * (event.depth as usize + 1))?;
        }
        let [r, g, b] = self.radiance.to_array();
        writeln!(f, "radiance {r} {g} {b}, {} rays", self.rays)
    }
}
