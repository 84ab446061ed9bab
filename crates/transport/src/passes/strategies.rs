//! A picture of each technique: what connecting `s` vertices from the light with `t` from the camera finds, with its
//! MIS weight and without. [Veach 1997, fig. 10.3]

use crate::bidirectional::BothEnds;
use crate::film::error::{FilmError, RenderError};
use crate::film::failures::SamplePlace;
use crate::film::window::{TILE, Window};
use crate::film::{Film, scale_exponent, zeroed};
use crate::integrators::pixel_integrator::PixelIntegrator;
use crate::passes::layers::{Both, Layers, Strategy};
use crate::passes::photon_tracing::iterations;
use crate::photons::Photons;
use crate::sampling::camera_rays::CameraRays;
use crate::sampling::splats::Iterations;
use crate::sampling::task::Task;
use crate::schedule::progress::Progress;
use crate::schedule::settings::{RenderSettings, threads};
use bilux_math::Rgb;
use bilux_math::parallel::{install, try_for_each};
use bilux_scene::{Camera, Counters, Scene, Tracer};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

pub use crate::passes::layers::MAX_EDGES;

/// The pictures of all techniques that have found anything.
pub struct Strategies {
    /// The pixels that they cover.
    pub window: Window,
    /// In order of the techniques.
    pub pictures: Vec<StrategyPicture>,
    /// The work that tracing took.
    pub counters: Counters,
}

/// Light that one technique has found: pixels of the window in rows, the top row first.
#[derive(Clone, Debug, PartialEq)]
pub struct StrategyPicture {
    /// The technique.
    pub strategy: Strategy,
    /// Weighted contribution: those of all techniques add up to the picture, except for longer paths.
    pub weighted: Vec<Rgb>,
    /// All light of paths of this length, as far as this technique finds it.
    pub unweighted: Vec<Rgb>,
}

/// Renders the requested samples, technique by technique.
///
/// `None` when it was cancelled, or the integrator has no techniques (`has_strategies`). It traces
/// the same paths as [`crate::render()`], whatever may have ended that early.
///
/// # Errors
/// As [`crate::render()`].
pub fn strategies(
    scene: &Scene,
    camera: &dyn Camera,
    integrator: &dyn PixelIntegrator,
    settings: &RenderSettings,
    progress: &dyn Progress,
) -> Result<Option<Strategies>, RenderError> {
    settings.check()?;
    // Rejects invalid sizes.
    Film::windowed(settings.width, settings.height, settings.window(), scale_exponent(scene))?;
    if !integrator.has_strategies() {
        return Ok(None);
    }
    if camera.receives() {
        return Err(RenderError::Receives);
    }
    let pool = threads(settings)?;
    let whole = Window::whole(settings.width, settings.height);
    let tiles = whole.tiles(TILE);
    progress.begin(whole.pixels() as u64 * settings.samples.len() as u64);
    let mut sums = Sums::default();
    for samples in iterations(integrator, &settings.samples) {
        let mut eye = integrator.camera_rays(scene, camera, settings);
        let photons =
            install(&pool, || Photons::of_iteration(integrator, &eye, &tiles, samples.start, None, None));
        eye.photons = photons.as_ref().map(|(photons, _)| photons);
        install(&pool, || sums.add(integrator, &eye, &tiles, samples, progress))?;
    }
    if progress.is_cancelled() {
        return Ok(None);
    }
    Ok(Some(sums.means(settings, scale_exponent(scene))?))
}

/// Light that all techniques have found in all samples so far.
#[derive(Default)]
struct Sums {
    /// In the pixel of the camera subpath. Each pixel is summed in the order of its samples, so that floating point
    /// suffices.
    here: BTreeMap<Strategy, Vec<Both<Rgb>>>,
    /// Splats of light subpaths.
    there: BTreeMap<Strategy, Both<Iterations>>,
    counters: Counters,
}

impl Sums {
    fn add(
        &mut self,
        integrator: &dyn PixelIntegrator,
        eye: &CameraRays,
        tiles: &[Window],
        samples: Range<u32>,
        progress: &dyn Progress,
    ) -> Result<(), FilmError> {
        let photons = eye.photons;
        let both_ends = integrator.light_subpaths().and_then(|subpaths| subpaths.both_ends(photons));
        let Some(both_ends) = both_ends.map(BothEnds::splatting) else { return Ok(()) };
        let sums = Mutex::new(self);
        try_for_each(tiles, |tile| {
            let mut tracer = Tracer::new(eye.context.scene, eye.settings.count_work);
            let mut layers = Layers::new(eye.settings, *tile, scale_exponent(eye.context.scene));
            for (x, y) in (0..tile.pixels()).map(|i| tile.position(i)) {
                if progress.is_cancelled() {
                    return Ok(());
                }
                for sample in samples.clone() {
                    layers.begin(x, y, sample);
                    let (ray, mut state) = eye.sample(SamplePlace { x, y, sample });
                    let mut task = Task { context: &eye.context, tracer: &mut tracer, sample: &mut state };
                    let is_wanted = layers.window.index(x, y).is_some();
                    both_ends.sample(&ray, is_wanted, &mut task, &mut layers);
                }
            }
            progress.advance(tile.pixels() as u64 * samples.len() as u64, tracer.counters.rays);
            let mut sums = sums.lock().unwrap_or_else(PoisonError::into_inner);
            sums.counters += tracer.counters;
            sums.take(layers, eye.settings.window())
        })
    }

    fn take(&mut self, layers: Layers, whole: Window) -> Result<(), FilmError> {
        for (strategy, light) in layers.here {
            let sum = match self.here.entry(strategy) {
                Entry::Occupied(entry) => entry.into_mut(),
                Entry::Vacant(entry) => entry.insert(zeroed(whole.pixels())?),
            };
            for (i, more) in light.into_iter().enumerate() {
                let (x, y) = layers.window.position(i);
                let Some(index) = whole.index(x, y) else { continue };
                (0..2).for_each(|k| sum[index][k] += more[k]);
            }
        }
        for (strategy, splats) in layers.there {
            let sum = match self.there.entry(strategy) {
                Entry::Occupied(entry) => entry.into_mut(),
                Entry::Vacant(entry) => {
                    let empty = || Iterations::new(whole.pixels(), usize::MAX);
                    entry.insert([empty()?, empty()?])
                }
            };
            for (sum, mut splats) in sum.iter_mut().zip(splats) {
                sum.take(&mut splats.deposits);
            }
        }
        Ok(())
    }

    fn means(self, settings: &RenderSettings, scale_exponent: i32) -> Result<Strategies, FilmError> {
        let (window, count) = (settings.window(), settings.samples.len() as u32);
        let here = self.here.into_iter().map(|(strategy, sums)| {
            let mean = |k: usize| sums.iter().map(|sum| sum[k] / count as f32).collect();
            StrategyPicture { strategy, weighted: mean(0), unweighted: mean(1) }
        });
        let mut pictures: Vec<StrategyPicture> = here.collect();
        for (strategy, [weighted, unweighted]) in self.there {
            let mean = |sums: Iterations| -> Result<Vec<Rgb>, FilmError> {
                let mut film = Film::windowed(settings.width, settings.height, window, scale_exponent)?;
                film.add_iterations(sums, count)?;
                Ok((0..window.pixels()).map(|i| window.position(i)).map(|(x, y)| film.pixel(x, y)).collect())
            };
            let (weighted, unweighted) = (mean(weighted)?, mean(unweighted)?);
            pictures.push(StrategyPicture { strategy, weighted, unweighted });
        }
        pictures.sort_by_key(|picture| picture.strategy);
        Ok(Strategies { window, pictures, counters: self.counters })
    }
}
