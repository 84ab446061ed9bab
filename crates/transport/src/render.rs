//! The tile loop: every sample of every pixel, on all cores, into one film.

use crate::camera_rays::CameraRays;
use crate::error::RenderError;
use crate::film::{Film, scale_exponent};
use crate::interval::Interval;
use crate::passes::{all_passes, passes};
use crate::photon_tracing::iterations;
use crate::photons::{Merging, Photons};
use crate::pixel_integrator::{PixelIntegrator, Plan};
use crate::progress::Progress;
use crate::rendered::Rendered;
use crate::schedule::Schedule;
use crate::settings::{RenderSettings, threads};
use crate::splats::IterationSplats;
use crate::window::{TILE, Window};
use bilux_accel::Counters;
use bilux_scene::{Camera, Scene};
use std::ops::Range;
use std::time::Instant;

/// Side of a large tile, whose pixels fill a queue of paths with one sample each.
const LARGE_TILE: u32 = 32;
/// Large tiles are used where each thread gets at least this many.
const MANY_TILES: usize = 16;

impl RenderSettings {
    /// The number of samples that an integrator takes. Integrators that trace light subpaths take all samples of the
    /// whole film, whatever part of it is requested, since any light subpath may contribute there.
    pub fn sample_count(&self, integrator: &dyn PixelIntegrator) -> u64 {
        self.sampled_window(integrator).pixels() as u64 * self.samples.len() as u64
    }

    /// The pixels whose samples are taken.
    fn sampled_window(&self, integrator: &dyn PixelIntegrator) -> Window {
        if integrator.splats() { Window::whole(self.width, self.height) } else { self.window() }
    }
}

/// What an integrator that chooses its strategies chooses for a picture; `None` for the others. The plan's integrator
/// renders as the one that chose it, without choosing again: for pictures that are rendered in several ranges of
/// samples.
///
/// # Errors
/// As for [`render`].
pub fn plan(
    scene: &Scene,
    camera: &dyn Camera,
    integrator: &dyn PixelIntegrator,
    settings: &RenderSettings,
) -> Result<Option<Plan>, RenderError> {
    settings.check()?;
    let pool = threads(settings)?;
    Ok(pool.install(|| integrator.plan(scene, camera, &settings.for_planning())))
}

/// Renders the requested samples.
///
/// # Errors
/// When the size, crop, range of samples or depth is invalid, or there is not enough memory or no threads.
pub fn render(
    scene: &Scene,
    camera: &dyn Camera,
    integrator: &dyn PixelIntegrator,
    settings: &RenderSettings,
    progress: &dyn Progress,
) -> Result<Rendered, RenderError> {
    settings.check()?;
    let begun = Instant::now();
    let scale = scale_exponent(scene);
    let film = Film::windowed(settings.width, settings.height, settings.window(), scale)?;
    let pool = threads(settings)?;
    let plan = pool.install(|| integrator.plan(scene, camera, &settings.for_planning()));
    let (choice, planned, counters) = match plan {
        Some(Plan { choice, integrator, counters }) => (Some(choice), Some(integrator), counters),
        None => (None, None, Counters::default()),
    };
    let integrator = planned.as_deref().unwrap_or(integrator);
    if settings.interval && !integrator.is_random() {
        return Err(RenderError::IntervalOfPattern);
    }
    progress.begin(settings.sample_count(integrator));
    let run = Run { scene, camera, integrator, settings, progress, pool, scale };
    let mut interval = settings.interval.then(|| Interval::new(settings.window())).transpose()?;
    let mut take = |samples: &Range<u32>, rendered| match &mut interval {
        Some(interval) => run.take_each(samples, interval, rendered),
        None => run.take(samples, rendered),
    };
    let mut rendered = Rendered {
        film,
        counters,
        cancelled: false,
        choice,
        reached: None,
        interval: None,
        batch_means: None,
    };
    let mut schedule = Schedule::new(settings, begun.elapsed());
    while !rendered.cancelled
        && let Some(samples) = schedule.next()
    {
        rendered = take(&samples, rendered)?;
        if !rendered.cancelled {
            schedule.look(&rendered.film, &samples);
            if let Some(expected) = schedule.expected() {
                progress.begin(settings.sampled_window(integrator).pixels() as u64 * u64::from(expected));
            }
        }
    }
    let (reached, batch_means) = schedule.end(Some(&rendered.film).filter(|_| !rendered.cancelled));
    Ok(Rendered { interval, reached, batch_means, ..rendered })
}

/// Everything that stays the same while a picture is rendered.
struct Run<'a> {
    scene: &'a Scene,
    camera: &'a dyn Camera,
    integrator: &'a dyn PixelIntegrator,
    settings: &'a RenderSettings,
    progress: &'a dyn Progress,
    pool: rayon::ThreadPool,
    scale: i32,
}

impl<'a> Run<'a> {
    fn eye(&self) -> CameraRays<'a> {
        CameraRays::new(self.scene, self.camera, self.integrator, self.settings)
    }

    /// Adds some samples of every pixel.
    fn take(&self, samples: &Range<u32>, mut rendered: Rendered) -> Result<Rendered, RenderError> {
        let (pool, settings) = (&self.pool, self.settings);
        let window = settings.sampled_window(self.integrator);
        let large = MANY_TILES * pool.current_num_threads() * (LARGE_TILE * LARGE_TILE) as usize;
        let tiles = window.tiles(if window.pixels() >= large { LARGE_TILE } else { TILE });
        let whole = Window::whole(settings.width, settings.height).tiles(TILE);
        let shows_photons = self.integrator.merging().is_some_and(Merging::shows_photons);
        for samples in iterations(self.integrator, samples) {
            let mut eye = self.eye();
            let film = &mut rendered.film;
            let shown = shows_photons.then(|| IterationSplats::of_film(film, settings, whole.len()));
            let shown = shown.transpose()?;
            let trace = |shown: Option<&IterationSplats>| {
                pool.install(|| Photons::of_iteration(&self.eye(), &whole, samples.start, shown))
            };
            let photons = trace(shown.as_ref());
            if let Some((photons, counters)) = &photons {
                rendered.counters += *counters;
                eye.photons = Some(photons);
            }
            let passes = passes(&samples);
            rendered = all_passes(pool, eye, tiles.clone(), passes, self.progress, rendered)?;
            match shown {
                Some(shown) if rendered.cancelled => {
                    shown.take_back(&mut rendered.film, whole.len(), |shown| drop(trace(Some(shown))));
                }
                Some(shown) => shown.complete(&mut rendered.film),
                None => {}
            }
            if rendered.cancelled {
                break;
            }
        }
        Ok(rendered)
    }

    /// The same, one sample after the other, so that each goes into its replicate.
    fn take_each(
        &self,
        samples: &Range<u32>,
        interval: &mut Interval,
        mut rendered: Rendered,
    ) -> Result<Rendered, RenderError> {
        for sample in samples.clone() {
            let (settings, window) = (self.settings, self.settings.window());
            let empty = Film::windowed(settings.width, settings.height, window, self.scale)?;
            let before = std::mem::replace(&mut rendered.film, empty);
            rendered = self.take(&(sample..sample + 1), rendered)?;
            let one = std::mem::replace(&mut rendered.film, before);
            rendered.film.merge(&one)?;
            if rendered.cancelled {
                break;
            }
            interval.add(sample, &one);
        }
        Ok(rendered)
    }
}
