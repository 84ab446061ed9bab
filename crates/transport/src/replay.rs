//! Replays one sample, with all events along its path.

use crate::camera_rays::CameraRays;
use crate::error::{FilmError, RenderError};
use crate::failures::SamplePlace;
use crate::film::{MAX_SIDE, scale_exponent};
use crate::photons::Photons;
use crate::pixel_integrator::PixelIntegrator;
use crate::settings::RenderSettings;
use crate::splats::Splats;
use crate::task::Event;
use crate::window::Window;
use bilux_math::Rgb;
use bilux_scene::{Camera, Ray, Scene, Tracer};
use std::fmt;

/// The record of a sample; its `Display` is for people.
#[derive(Clone, Debug, PartialEq)]
pub struct Replay {
    /// The sample.
    pub place: SamplePlace,
    /// The camera ray.
    pub ray: Ray,
    /// The events along the path.
    pub events: Vec<Event>,
    /// The radiance in its own pixel.
    pub radiance: Rgb,
    /// Number of pixels that its light subpath contributes to.
    pub splats: usize,
    /// Number of rays traced.
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
    let plan = integrator.plan(scene, camera, &settings.for_planning());
    let integrator = plan.as_ref().map_or(integrator, |plan| &*plan.integrator);
    let mut eye = CameraRays::new(scene, camera, integrator, settings);
    let whole = Window::whole(width, height);
    let photons = Photons::of_iteration(&eye, &[whole], sample, None);
    eye.photons = photons.as_ref().map(|(photons, _)| photons);
    let mut tracer = Tracer::new(scene, false);
    let (ray, mut task) = eye.sample(&mut tracer, x, y, sample);
    task.events = Some(Vec::new());
    let mut splats = Splats::new(settings, whole, scale_exponent(scene));
    splats.begin(x, y, sample);
    let radiance = integrator.sample(&ray, true, &mut task, &mut splats);
    let events = task.events.take().unwrap_or_default();
    let splats = splats.deposits.len();
    Ok(Replay { place, ray, events, radiance, splats, rays: tracer.counters.rays })
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
        if self.splats > 0 {
            writeln!(f, "its light path contributes to {} pixels", self.splats)?;
        }
        writeln!(f, "radiance {r} {g} {b}, {} rays", self.rays)
    }
}
