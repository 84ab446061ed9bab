//! Replays one sample, with all events along its path.

use crate::film::error::{FilmError, RenderError};
use crate::film::failures::SamplePlace;
use crate::film::window::Window;
use crate::film::{MAX_SIDE, scale_exponent};
use crate::integrators::pixel_integrator::PixelIntegrator;
use crate::photons::Photons;
use crate::sampling::splats::{Splats, Sum};
use crate::sampling::task::{Event, Record, Task};
use crate::schedule::settings::RenderSettings;
use crate::techniques::{Contribution, Tally, Technique};
use bilux_math::{Rgb, Vec2};
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
    /// Contributions of the techniques of a bidirectional integrator, in the order in which they were found.
    pub contributions: Vec<Contributed>,
    /// Number of rays traced.
    pub rays: u64,
}

/// Contribution of one technique to a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contributed {
    /// The number of vertices of the light subpath, the light's own included.
    pub s: u32,
    /// The number of vertices of the camera subpath, the camera's own included.
    pub t: u32,
    /// True if the last vertices of both were merged, false if they were connected.
    pub is_merged: bool,
    /// MIS weight, 0..=1.
    pub weight: f32,
    /// Weighted radiance that it adds to the sample.
    pub light: Rgb,
    /// For light that belongs to other pixels (t = 1), where it falls on the film's plane (the film is 0..1 on both axes):
    /// there `light` is an integral over the whole film.
    pub film: Option<Vec2>,
}

impl Contributed {
    fn of(technique: Technique, found: &Contribution, film: Option<Vec2>) -> Contributed {
        let (s, t, is_merged) = match technique {
            Technique::Connected { s, t } => (s, t, false),
            Technique::Merged { s, t } => (s, t, true),
        };
        let weight = found.mis_weight();
        Contributed { s, t, is_merged, weight, light: found.weighted(), film }
    }
}

/// Records what a sum receives.
struct Recorded<'a, 's> {
    sum: Sum<'a, 's>,
    contributions: Vec<Contributed>,
}

impl Tally<1> for Recorded<'_, '_> {
    fn add_sample(&mut self, technique: Technique, found: &Contribution) {
        self.contributions.push(Contributed::of(technique, found, None));
        self.sum.add_sample(technique, found);
    }

    fn add_splat(&mut self, film: Vec2, technique: Technique, found: &Contribution) {
        self.contributions.push(Contributed::of(technique, found, Some(film)));
        self.sum.add_splat(film, technique, found);
    }
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
    let mut eye = integrator.camera_rays(scene, camera, settings);
    let whole = Window::whole(width, height);
    let photons = Photons::of_iteration(integrator, &eye, &[whole], sample, None, None);
    eye.photons = photons.as_ref().map(|(photons, _)| photons);
    let mut tracer = Tracer::new(scene, false);
    let (ray, mut state) = eye.sample(place);
    state.record = Some(Box::new(Record { events: Some(Vec::new()), ..Record::default() }));
    let mut task = Task { context: &eye.context, tracer: &mut tracer, sample: &mut state };
    let mut splats = Splats::new(settings, whole, scale_exponent(scene));
    splats.begin(x, y, sample);
    let subpaths = integrator.light_subpaths();
    let (radiance, contributions) = match subpaths.and_then(|subpaths| subpaths.both_ends(eye.photons)) {
        Some(both_ends) => {
            let sum = Sum { here: Rgb::BLACK, splats: &mut splats };
            let mut recorded = Recorded { sum, contributions: Vec::new() };
            both_ends.sample(&ray, true, &mut task, &mut recorded);
            (recorded.sum.here, recorded.contributions)
        }
        None => (integrator.sample(&ray, true, eye.photons, &mut task, &mut splats), Vec::new()),
    };
    let events = state.record.and_then(|record| record.events).unwrap_or_default();
    let splats = splats.deposits.len();
    Ok(Replay { place, ray, events, radiance, splats, contributions, rays: tracer.counters.rays })
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
        for contributed in &self.contributions {
            writeln!(f, "  {contributed}")?;
        }
        let [r, g, b] = self.radiance.to_array();
        if self.splats > 0 {
            writeln!(f, "its light path contributes to {} pixels", self.splats)?;
        }
        writeln!(f, "radiance {r} {g} {b}, {} rays", self.rays)
    }
}

impl fmt::Display for Contributed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Contributed { s, t, is_merged, weight, light, film } = *self;
        let how = match (is_merged, s, t) {
            (true, ..) => "merges vertices",
            (false, 0, _) => "hits a light",
            (false, 1, _) => "samples a light",
            (false, _, 1) => "connects a light vertex with the camera",
            _ => "connects vertices",
        };
        let [r, g, b] = light.to_array();
        write!(f, "s = {s}, t = {t}: {how}, weight {weight}, light {r} {g} {b}")?;
        film.map_or(Ok(()), |film| write!(f, ", over the film at {} {}", film.x, film.y))
    }
}
