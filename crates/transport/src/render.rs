//! The tile loop: every sample of every pixel, on all cores, into one film.

use crate::bidirectional::Photons;
use crate::error::{FilmError, RenderError};
use crate::eye::Eye;
use crate::film::{Film, MAX_SAMPLES, scale_exponent};
use crate::filters::Filter;
use crate::integrators::PixelIntegrator;
use crate::plan::{Choice, Plan};
use crate::splats::{Iterations, Shown, Splats};
use crate::stop::{Reached, Stop, Watch};
use crate::window::Window;
use bilux_accel::Counters;
use bilux_scene::{Camera, Scene, Tracer};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

/// Scattering events after the camera where nothing else is said.
pub const DEFAULT_MAX_DEPTH: u32 = 16;

/// The greatest depth that may be asked for.
pub const MAX_DEPTH: u32 = 1000;

/// Side of a tile, in pixels.
pub(crate) const TILE: u32 = 16;

/// The most samples of each pixel in one pass over the film.
const PASS: u32 = 32;

/// Enough for trees of rays as deep as [`MAX_DEPTH`].
const STACK_BYTES: usize = 16 << 20;

/// What is to be rendered, apart from scene, camera and integrator.
#[derive(Clone, Debug)]
pub struct RenderSettings {
    /// Pixels across the whole film.
    pub width: u32,
    /// Pixels down the whole film.
    pub height: u32,
    /// Samples of each pixel in all.
    pub spp: u32,
    /// Which of them are to be taken now.
    pub samples: Range<u32>,
    /// Which pixels; `None` for all.
    pub crop: Option<Window>,
    /// Another seed gives other noise.
    pub seed: u64,
    /// How many threads; 0 for one each core.
    pub threads: usize,
    /// Greatest number of scattering events after the camera; 0 is emission only.
    pub max_depth: u32,
    /// Where in a pixel its middle sample lies.
    pub pixel_anchor: PixelAnchor,
    /// How samples spread around the pixel's middle.
    pub filter: Filter,
    /// Count nodes and triangle tests, not only rays.
    pub count_work: bool,
    /// What may end it before all samples are taken.
    pub stop: Stop,
}

/// Which point stands for a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PixelAnchor {
    /// Its middle.
    #[default]
    Centre,
    /// Its upper left corner, at integer coordinates, as older renderers have it.
    Corner,
}

impl RenderSettings {
    /// Every sample of a film of this size.
    pub fn new(width: u32, height: u32, spp: u32) -> RenderSettings {
        RenderSettings {
            width,
            height,
            spp,
            samples: 0..spp,
            crop: None,
            seed: 0,
            threads: 0,
            max_depth: DEFAULT_MAX_DEPTH,
            pixel_anchor: PixelAnchor::Centre,
            filter: Filter::default(),
            count_work: false,
            stop: Stop::default(),
        }
    }

    pub(crate) fn window(&self) -> Window {
        self.crop.unwrap_or(Window::whole(self.width, self.height))
    }

    /// How many samples an integrator takes: of those that follow light from its sources, all that the whole film has,
    /// whatever part of it is wanted, since the light of any may land there.
    pub fn sample_count(&self, integrator: &dyn PixelIntegrator) -> u64 {
        self.walked(integrator).pixels() as u64 * self.samples.len() as u64
    }

    /// The pixels whose samples are taken.
    fn walked(&self, integrator: &dyn PixelIntegrator) -> Window {
        if integrator.splats() { Window::whole(self.width, self.height) } else { self.window() }
    }

    pub(crate) fn check(&self) -> Result<(), RenderError> {
        let Range { start, end } = self.samples;
        let spp = self.spp;
        if start >= end || end > spp || spp > MAX_SAMPLES {
            return Err(RenderError::Samples { start, end, spp });
        }
        if self.stop.is_any() && (self.crop.is_some() || self.samples != (0..spp)) {
            return Err(RenderError::StopOfPart);
        }
        if self.max_depth > MAX_DEPTH {
            return Err(RenderError::Depth { depth: self.max_depth });
        }
        Ok(())
    }
}

/// Whom to tell how far it is, and who may stop it. Called from many threads, about once for each tile.
pub trait Progress: Sync {
    /// So many samples and rays more.
    fn advance(&self, samples: u64, rays: u64);
    /// So many samples are going to be taken.
    fn begin(&self, _samples: u64) {}
    /// True when the work is to stop; what is finished is kept.
    fn is_cancelled(&self) -> bool;
}

/// Nobody to tell, and nobody to stop it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn advance(&self, _samples: u64, _rays: u64) {}
    fn is_cancelled(&self) -> bool {
        false
    }
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The film; [`Film::trouble`] tells of samples that went wrong.
    pub film: Film,
    /// What the rays took; only `rays` unless [`RenderSettings::count_work`] was on.
    pub counters: Counters,
    /// True when it was stopped. Then [`Film::coverage`] tells which samples are in; each is there whole.
    pub cancelled: bool,
    /// What an integrator that chooses has chosen.
    pub choice: Option<Choice>,
    /// How far it came, where it could end early ([`RenderSettings::stop`]).
    pub reached: Option<Reached>,
}

/// Renders the samples asked for.
///
/// # Errors
/// When the size, crop, range of samples or depth makes no sense, or the machine gives no room or threads.
pub fn render(
    scene: &Scene,
    camera: &dyn Camera,
    integrator: &dyn PixelIntegrator,
    settings: &RenderSettings,
    progress: &dyn Progress,
) -> Result<Rendered, RenderError> {
    settings.check()?;
    let film = Film::windowed(settings.width, settings.height, settings.window(), scale_exponent(scene))?;
    let pool = threads(settings)?;
    let (choice, planned, counters) = match pool.install(|| integrator.plan(scene, camera, settings)) {
        Some(Plan { choice, integrator, counters }) => (Some(choice), Some(integrator), counters),
        None => (None, None, Counters::default()),
    };
    let integrator = planned.as_deref().unwrap_or(integrator);
    progress.begin(settings.sample_count(integrator));
    let tiles = settings.walked(integrator).tiles(TILE);
    let mut rendered = Rendered { film, counters, cancelled: false, choice, reached: None };
    let eye = || Eye::new(scene, camera, integrator, settings);
    let take = |samples: &Range<u32>, mut rendered: Rendered| {
        let Some(merging) = integrator.merging() else {
            return all_passes(&pool, eye(), tiles.clone(), passes(samples), progress, rendered);
        };
        let whole = Window::whole(settings.width, settings.height).tiles(TILE);
        for iteration in samples.clone() {
            let mut eye = eye();
            let shown =
                merging.shows_photons().then(|| Shown::new(settings, scale_exponent(scene), whole.len()));
            let shown = shown.transpose()?;
            let ways = |eta, light_paths| merging.ways(eta, light_paths);
            let (photons, counters) =
                pool.install(|| Photons::trace(&eye, merging, &whole, iteration, ways, shown.as_ref()));
            rendered.counters += counters;
            eye.photons = Some(&photons);
            let pass = passes(&(iteration..iteration + 1));
            rendered = all_passes(&pool, eye, tiles.clone(), pass, progress, rendered)?;
            if rendered.cancelled {
                break;
            }
            if let Some(shown) = shown {
                rendered.film.add_iterations(&shown.into_iterations(), 1)?;
            }
        }
        Ok(rendered)
    };
    if !settings.stop.is_any() {
        return take(&settings.samples, rendered);
    }
    let mut watch = Watch::new(settings);
    while !rendered.cancelled
        && let Some(samples) = watch.next()
    {
        rendered = take(&samples, rendered)?;
        if !rendered.cancelled {
            watch.look(&rendered.film, &samples);
            progress.begin(settings.walked(integrator).pixels() as u64 * u64::from(watch.expected()));
        }
    }
    rendered.reached = watch.reached;
    Ok(rendered)
}

/// As many as are wanted.
pub(crate) fn threads(settings: &RenderSettings) -> Result<rayon::ThreadPool, RenderError> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(settings.threads)
        .stack_size(STACK_BYTES)
        .build()
        .map_err(|e| RenderError::Threads { threads: settings.threads, reason: e.to_string() })
}

/// Some passes over all tiles, by all threads.
fn all_passes(
    pool: &rayon::ThreadPool,
    eye: Eye,
    tiles: Vec<Window>,
    passes: Vec<Range<u32>>,
    progress: &dyn Progress,
    before: Rendered,
) -> Result<Rendered, RenderError> {
    let Rendered { film, mut counters, choice, reached, .. } = before;
    let work = Work {
        eye,
        progress,
        tiles,
        passes,
        next: AtomicU64::new(0),
        dropped: Mutex::new(Vec::new()),
        film: Mutex::new(film),
        iterations: Mutex::new(BTreeMap::new()),
        failed: Mutex::new(None),
    };
    pool.broadcast(|_| work.run()).into_iter().for_each(|c| counters += c);
    if let Some(error) = work.failed.lock().unwrap_or_else(PoisonError::into_inner).take() {
        return Err(error.into());
    }
    let (film, cancelled) = work.finish();
    Ok(Rendered { film, counters, cancelled, choice, reached })
}

/// Ranges of samples that double in length, so that the first picture is there soon.
fn passes(samples: &Range<u32>) -> Vec<Range<u32>> {
    let (mut start, mut passes) = (samples.start, Vec::new());
    while start < samples.end {
        let length = (start - samples.start).clamp(1, PASS).min(samples.end - start);
        passes.push(start..start + length);
        start += length;
    }
    passes
}

/// One rendering, as its threads share it. Job `j` is tile `j % tiles` in pass `j / tiles`.
struct Work<'a> {
    eye: Eye<'a>,
    progress: &'a dyn Progress,
    tiles: Vec<Window>,
    passes: Vec<Range<u32>>,
    next: AtomicU64,
    /// Jobs that were taken but not finished.
    dropped: Mutex<Vec<u64>>,
    film: Mutex<Film>,
    /// What light paths have left in passes that are not finished.
    iterations: Mutex<BTreeMap<usize, Iterations>>,
    /// Why there is no film.
    failed: Mutex<Option<FilmError>>,
}

impl<'a> Work<'a> {
    /// One thread's share.
    fn run(&self) -> Counters {
        let mut tracer = Tracer::new(self.eye.scene, self.eye.settings.count_work);
        let scale = scale_exponent(self.eye.scene);
        let mut part = Film::part(scale);
        let mut splats = Splats::new(self.eye.settings, self.eye.settings.window(), scale);
        let jobs = (self.tiles.len() * self.passes.len()) as u64;
        loop {
            let job = self.next.fetch_add(1, Ordering::Relaxed);
            if job >= jobs {
                return tracer.counters;
            }
            let tile = self.tiles[job as usize % self.tiles.len()];
            let pass = job as usize / self.tiles.len();
            let samples = self.passes[pass].clone();
            part.restart(tile.intersection(&self.eye.settings.window()));
            let rays_before = tracer.counters.rays;
            if !self.render_tile(tile, samples.clone(), &mut tracer, (&mut part, &mut splats)) {
                self.dropped.lock().unwrap_or_else(PoisonError::into_inner).push(job);
                return tracer.counters;
            }
            self.film.lock().unwrap_or_else(PoisonError::into_inner).absorb(&part);
            if self.eye.integrator.splats()
                && let Err(error) = self.take_splats(pass, &mut splats)
            {
                *self.failed.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
                return tracer.counters;
            }
            let taken = tile.pixels() as u64 * samples.len() as u64;
            self.progress.advance(taken, tracer.counters.rays - rays_before);
        }
    }

    /// False when it was stopped on the way.
    fn render_tile(
        &self,
        tile: Window,
        samples: Range<u32>,
        tracer: &mut Tracer<'a>,
        (part, splats): (&mut Film, &mut Splats),
    ) -> bool {
        for y in tile.y..tile.y + tile.height {
            if self.progress.is_cancelled() {
                return false;
            }
            for x in tile.x..tile.x + tile.width {
                for sample in samples.clone() {
                    let (ray, mut task) = self.eye.sample(tracer, x, y, sample);
                    let is_wanted = part.window().index(x, y).is_some();
                    splats.begin(x, y, sample);
                    let light = self.eye.integrator.sample(&ray, is_wanted, &mut task, splats);
                    part.add(x, y, sample, light);
                }
            }
        }
        true
    }

    /// Keeps what the light paths of a tile have left, and gives it to the film when it is the last of its pass.
    fn take_splats(&self, pass: usize, splats: &mut Splats) -> Result<(), FilmError> {
        let mut all = self.iterations.lock().unwrap_or_else(PoisonError::into_inner);
        let iterations = match all.entry(pass) {
            Entry::Occupied(entry) => entry.into_mut(),
            Entry::Vacant(entry) => {
                entry.insert(Iterations::new(self.eye.settings.window().pixels(), self.tiles.len())?)
            }
        };
        iterations.take(&mut splats.deposits);
        if iterations.tiles_left > 0 {
            return Ok(());
        }
        let Some(iterations) = all.remove(&pass) else { return Ok(()) };
        drop(all);
        let mut film = self.film.lock().unwrap_or_else(PoisonError::into_inner);
        film.add_iterations(&iterations, self.passes[pass].len() as u32)
    }

    /// The film with its coverage, and whether anything is missing.
    fn finish(self) -> (Film, bool) {
        let mut film = self.film.into_inner().unwrap_or_else(PoisonError::into_inner);
        let dropped = self.dropped.into_inner().unwrap_or_else(PoisonError::into_inner);
        if dropped.is_empty() {
            for samples in &self.passes {
                film.cover(self.eye.settings.window(), samples.clone());
            }
            return (film, false);
        }
        let taken = self.next.into_inner();
        let tiles = self.tiles.len() as u64;
        for (pass, samples) in self.passes.iter().enumerate() {
            let first = pass as u64 * tiles;
            let is_done = |job: &u64| *job < taken && !dropped.contains(job);
            if (first..first + tiles).all(|job| is_done(&job)) {
                film.cover(self.eye.settings.window(), samples.clone());
            } else {
                for job in (first..first + tiles).filter(is_done) {
                    let tile = self.tiles[(job - first) as usize];
                    film.cover(tile.intersection(&self.eye.settings.window()), samples.clone());
                }
            }
        }
        (film, true)
    }
}
