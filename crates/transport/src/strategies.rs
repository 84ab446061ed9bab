//! A picture of each technique: what connecting `s` vertices from the light with `t` from the camera finds, with its
//! MIS weight and without. [Veach 1997, fig. 10.3]

use crate::camera_rays::CameraRays;
use crate::error::{FilmError, RenderError};
use crate::film::{Film, scale_exponent, zeroed};
use crate::photons::Photons;
use crate::pixel_integrator::PixelIntegrator;
use crate::progress::Progress;
use crate::settings::{RenderSettings, threads};
use crate::splats::{IterationSplats, Iterations, Splats};
use crate::techniques::{Contribution, Tally, Technique};
use crate::window::{TILE, Window};
use bilux_math::{Rgb, Vec2};
use bilux_scene::{Camera, Counters, Scene, Tracer};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fmt;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Edges of the longest paths whose techniques have pictures.
pub const MAX_EDGES: u32 = 8;

/// A technique for paths of one length. Ordered by length, then connections before merging, then by vertices from the
/// light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Strategy {
    /// Edges of its paths, one more than their scattering events.
    pub edges: u32,
    /// True where the last vertices of both subpaths are merged, false where an edge connects them.
    pub merges: bool,
    /// Vertices from the light, including the one on the light.
    pub s: u32,
}

/// The pictures of all techniques that have found anything.
pub struct Strategies {
    /// The pixels that they cover.
    pub window: Window,
    /// In order of the techniques.
    pub pictures: Vec<StrategyPicture>,
    /// The work that tracing took.
    pub counters: Counters,
}

/// What one technique has found: pixels of the window in rows, the top row first.
#[derive(Clone, Debug, PartialEq)]
pub struct StrategyPicture {
    /// The technique.
    pub strategy: Strategy,
    /// Its weighted contribution: all of them add up to the picture, except for longer paths.
    pub weighted: Vec<Rgb>,
    /// All light of paths of this length, as far as this technique finds it.
    pub unweighted: Vec<Rgb>,
}

impl Strategy {
    /// Vertices from the camera, including the one at the camera.
    pub fn t(&self) -> u32 {
        self.edges + 1 + u32::from(self.merges) - self.s
    }

    fn of(technique: Technique) -> Strategy {
        match technique {
            Technique::Joined { s, t } => Strategy { edges: s + t - 1, merges: false, s },
            Technique::Merged { s, t } => Strategy { edges: s + t - 2, merges: true, s },
        }
    }
}

impl fmt::Display for Strategy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "s{}-t{}{}", self.s, self.t(), if self.merges { "-merged" } else { "" })
    }
}

/// Renders the requested samples, technique by technique.
///
/// `None` when it was cancelled, or the integrator has no techniques ([`PixelIntegrator::has_strategies`]). It traces
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
    let pool = threads(settings)?;
    let whole = Window::whole(settings.width, settings.height);
    let tiles = whole.tiles(TILE);
    progress.begin(whole.pixels() as u64 * settings.samples.len() as u64);
    let mut sums = Sums::default();
    let mut pass =
        |eye: &CameraRays, samples: Range<u32>| pool.install(|| sums.add(eye, &tiles, samples, progress));
    let eye = || CameraRays::new(scene, camera, integrator, settings);
    if let Some(merging) = integrator.merging() {
        for iteration in settings.samples.clone() {
            let mut eye = eye();
            let techniques = |eta, light_paths| merging.techniques(eta, light_paths);
            let (photons, _) = pool.install(|| {
                Photons::trace(&eye, merging, &tiles, iteration, techniques, None::<&IterationSplats>)
            });
            eye.photons = Some(&photons);
            pass(&eye, iteration..iteration + 1)?;
        }
    } else {
        pass(&eye(), settings.samples.clone())?;
    }
    if progress.is_cancelled() {
        return Ok(None);
    }
    Ok(Some(sums.means(settings, scale_exponent(scene))?))
}

/// Weighted and unweighted.
type Both<T> = [T; 2];

/// What all techniques have found in all samples so far.
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
        eye: &CameraRays,
        tiles: &[Window],
        samples: Range<u32>,
        progress: &dyn Progress,
    ) -> Result<(), FilmError> {
        let sums = Mutex::new(self);
        tiles.par_iter().try_for_each(|tile| {
            let mut tracer = Tracer::new(eye.scene, eye.settings.count_work);
            let mut layers = Layers::new(eye.settings, *tile, scale_exponent(eye.scene));
            for (x, y) in (0..tile.pixels()).map(|i| tile.position(i)) {
                if progress.is_cancelled() {
                    return Ok(());
                }
                for sample in samples.clone() {
                    layers.begin(x, y, sample);
                    let (ray, mut task) = eye.sample(&mut tracer, x, y, sample);
                    let is_wanted = layers.window.index(x, y).is_some();
                    eye.integrator.sample_strategies(&ray, is_wanted, &mut task, &mut layers);
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
        for (strategy, sums) in self.there {
            let mean = |sums: &Iterations| -> Result<Vec<Rgb>, FilmError> {
                let mut film = Film::windowed(settings.width, settings.height, window, scale_exponent)?;
                film.add_iterations(sums, count)?;
                Ok((0..window.pixels()).map(|i| window.position(i)).map(|(x, y)| film.pixel(x, y)).collect())
            };
            let (weighted, unweighted) = (mean(&sums[0])?, mean(&sums[1])?);
            pictures.push(StrategyPicture { strategy, weighted, unweighted });
        }
        pictures.sort_by_key(|picture| picture.strategy);
        Ok(Strategies { window, pictures, counters: self.counters })
    }
}

/// What all techniques find in a tile.
pub struct Layers<'a> {
    settings: &'a RenderSettings,
    scale_exponent: i32,
    /// The requested part of the tile.
    window: Window,
    /// The current sample: column, row and index.
    place: [u32; 3],
    here: BTreeMap<Strategy, Vec<Both<Rgb>>>,
    there: BTreeMap<Strategy, Both<Splats<'a>>>,
}

impl<'a> Layers<'a> {
    fn new(settings: &'a RenderSettings, tile: Window, scale_exponent: i32) -> Layers<'a> {
        let window = tile.intersection(&settings.window());
        let (here, there) = (BTreeMap::new(), BTreeMap::new());
        Layers { settings, scale_exponent, window, place: [0; 3], here, there }
    }

    fn begin(&mut self, x: u32, y: u32, sample: u32) {
        self.place = [x, y, sample];
        self.there.values_mut().flatten().for_each(|splats| splats.begin(x, y, sample));
    }
}

impl Tally<1> for Layers<'_> {
    fn add_sample(&mut self, technique: Technique, found: &Contribution) {
        let (strategy, [x, y, _]) = (Strategy::of(technique), self.place);
        let Some(index) = self.window.index(x, y).filter(|_| strategy.edges <= MAX_EDGES) else { return };
        let pixels = self.window.pixels();
        let light = &mut self.here.entry(strategy).or_insert_with(|| vec![[Rgb::BLACK; 2]; pixels])[index];
        light[0] += found.weighted();
        light[1] += found.light * (1.0 / found.own.0[0]);
    }

    fn add_splat(&mut self, film: Vec2, technique: Technique, found: &Contribution) {
        let strategy = Strategy::of(technique);
        if strategy.edges > MAX_EDGES {
            return;
        }
        let (settings, [x, y, sample]) = (self.settings, self.place);
        let splats = self.there.entry(strategy).or_insert_with(|| {
            let mut splats = Splats::new(settings, settings.window(), self.scale_exponent);
            splats.begin(x, y, sample);
            [splats.clone(), splats]
        });
        // Here every pixel has a light subpath that is splatted, even where fewer make the picture.
        splats[0].add(film, found.weighted() * found.own.0[0]);
        splats[1].add(film, found.light);
    }
}
