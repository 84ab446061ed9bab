//! Passes over the film: all its tiles, some samples of each pixel, on all threads.

pub(crate) mod completion;
mod ending;
pub(crate) mod features;
pub(crate) mod illumination;
pub(crate) mod layers;
pub(crate) mod light_parts;
mod limit;
pub mod mattes;
pub(crate) mod photon_tracing;
pub(crate) mod receiving;
pub(crate) mod render;
pub(crate) mod replay;
pub(crate) mod shadow_catcher;
pub mod strategies;
pub(crate) mod work;

use crate::checkpoint::{Begun, Observer, OpenPass};
use crate::film::error::{FilmError, RenderError};
use crate::film::failures::SamplePlace;
use crate::film::window::{Tile, Tiling, Window};
use crate::film::{Film, scale_exponent};
use crate::integrators::pixel_integrator::PixelIntegrator;
use crate::passes::ending::Ending;
use crate::passes::limit::{Limit, Limited};
use crate::sampling::camera_rays::CameraRays;
use crate::sampling::sample_queue::{SampleQueue, SampleSink};
use crate::sampling::splats::{Iterations, Splats};
use crate::sampling::task::Task;
use crate::schedule::progress::Progress;
use crate::schedule::rendered::Rendered;
use bilux_accel::Counters;
use bilux_math::parallel::ThreadPool;
use bilux_scene::Tracer;
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, HashSet};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Maximum number of samples of each pixel in one pass over the film.
const PASS: u32 = 32;

/// Followers of the passes.
#[derive(Clone, Copy)]
pub(crate) struct Followers<'a> {
    pub(crate) progress: &'a dyn Progress,
    pub(crate) observer: &'a dyn Observer,
    /// Keeps a checkpoint of the film with these passes.
    pub(crate) keep: &'a (dyn Fn(&mut Film, Begun, Counters) + Sync),
}

/// Passes over all tiles, of which some jobs may be done.
pub(crate) struct Passes {
    pub(crate) tiling: Tiling,
    pub(crate) ranges: Vec<OpenPass>,
    /// When time ends them, wherever they are: but where pixels are spread, not before the coarsest lattice is complete.
    pub(crate) deadline: Option<Instant>,
}

impl Passes {
    /// The passes that take these samples, none of which is begun.
    pub(crate) fn of(samples: &Range<u32>, tiling: Tiling, deadline: Option<Instant>) -> Passes {
        let open = |samples| OpenPass { samples, done: Vec::new(), splats: None };
        Passes { tiling, ranges: passes(samples).into_iter().map(open).collect(), deadline }
    }
}

/// Runs some passes over all tiles of the `sampled` window, on all threads.
pub(crate) fn all_passes(
    pool: &ThreadPool,
    integrator: &dyn PixelIntegrator,
    eye: CameraRays,
    sampled: Window,
    passes: Passes,
    followers: Followers,
    before: Rendered,
) -> Result<Rendered, RenderError> {
    let Rendered { film, mut counters, planning, choice, reached, interval, batch_means, .. } = before;
    let mut work = Work::new(integrator, eye, sampled, passes, followers, film);
    loop {
        pool.broadcast(|_| work.run()).into_iter().for_each(|c| counters += c);
        if let Some(error) = work.failed.lock().unwrap_or_else(PoisonError::into_inner).take() {
            return Err(error.into());
        }
        if work.is_complete() || work.is_late() {
            break;
        }
        work.keep(counters);
        if !*work.is_paused.get_mut() {
            break;
        }
        *work.is_paused.get_mut() = false;
    }
    let End { film, cancelled, cut_short, spacing } = work.finish()?;
    Ok(Rendered {
        film,
        counters,
        cancelled,
        cut_short,
        spacing,
        planning,
        choice,
        reached,
        interval,
        batch_means,
    })
}

/// Ranges of samples that double in length, so that a first picture appears soon.
fn passes(samples: &Range<u32>) -> Vec<Range<u32>> {
    let (mut start, mut passes) = (samples.start, Vec::new());
    while start < samples.end {
        let length = (start - samples.start).clamp(1, PASS).min(samples.end - start);
        passes.push(start..start + length);
        start += length;
    }
    passes
}

/// One render, as its threads share it. Job `j` is tile `j % tiles` in pass `j / tiles`.
struct Work<'a> {
    integrator: &'a dyn PixelIntegrator,
    eye: CameraRays<'a>,
    followers: Followers<'a>,
    tiling: Tiling,
    tiles: Vec<Tile>,
    passes: Vec<Range<u32>>,
    /// Jobs that were done before.
    done: HashSet<u64>,
    next: AtomicU64,
    limit: Option<Limit>,
    /// Whether a checkpoint is due: no thread begins a job.
    is_paused: AtomicBool,
    /// Jobs that were started but not finished.
    dropped: Mutex<Vec<u64>>,
    film: Mutex<Film>,
    /// Splats of passes that are not finished.
    iterations: Mutex<BTreeMap<usize, Iterations>>,
    /// Why there is no film.
    failed: Mutex<Option<FilmError>>,
}

/// State of a render's work at its end.
struct End {
    film: Film,
    cancelled: bool,
    cut_short: bool,
    spacing: Option<u32>,
}

/// Some samples of each pixel of a tile.
fn places(tile: Tile, samples: &Range<u32>) -> Vec<SamplePlace> {
    let mut all = Vec::with_capacity(tile.pixels() * samples.len());
    for (x, y) in tile.positions() {
        all.extend(samples.clone().map(|sample| SamplePlace { x, y, sample }));
    }
    all
}

/// One sample after the other.
struct OneByOne<'i>(&'i dyn PixelIntegrator);

impl SampleQueue for OneByOne<'_> {
    fn take<'a>(
        &mut self,
        rays: &CameraRays<'a>,
        tracer: &mut Tracer<'a>,
        places: &[SamplePlace],
        sink: &mut SampleSink,
    ) -> bool {
        for row in places.chunk_by(|a, b| a.y == b.y) {
            if sink.is_cancelled() {
                return false;
            }
            for &place in row {
                let (ray, mut state) = rays.sample(place);
                let mut task = Task { context: &rays.context, tracer: &mut *tracer, sample: &mut state };
                let is_wanted = sink.is_wanted(place);
                let light = self.0.sample(&ray, is_wanted, rays.photons, &mut task, sink.splats(place));
                sink.add(place, light);
            }
        }
        true
    }
}

impl<'a> Work<'a> {
    fn new(
        integrator: &'a dyn PixelIntegrator,
        eye: CameraRays<'a>,
        sampled: Window,
        Passes { tiling, ranges, deadline }: Passes,
        followers: Followers<'a>,
        film: Film,
    ) -> Work<'a> {
        let tiles = sampled.divided(tiling);
        let (mut done, mut iterations) = (HashSet::new(), BTreeMap::new());
        let mut passes = Vec::with_capacity(ranges.len());
        for (pass, open) in ranges.into_iter().enumerate() {
            let jobs = (pass * tiles.len()) as u64..;
            done.extend(jobs.zip(open.done).filter(|(_, is_done)| *is_done).map(|(job, _)| job));
            iterations.extend(open.splats.map(|splats| (pass, splats)));
            passes.push(open.samples);
        }
        let coarsest = tiles.first().map_or(1, |tile| tile.step);
        let least = tiles.iter().filter(|tile| tile.step == coarsest && coarsest > 1).count() as u64;
        Work {
            integrator,
            eye,
            followers,
            tiling,
            limit: deadline.map(|at| Limit::new(at, least)),
            tiles,
            passes,
            done,
            next: AtomicU64::new(0),
            is_paused: AtomicBool::new(false),
            dropped: Mutex::new(Vec::new()),
            film: Mutex::new(film),
            iterations: Mutex::new(iterations),
            failed: Mutex::new(None),
        }
    }

    fn jobs(&self) -> u64 {
        (self.tiles.len() * self.passes.len()) as u64
    }

    /// Takes the next job; `None` when there is none, or none is to be begun.
    fn next_job(&self) -> Option<u64> {
        loop {
            if self.is_paused.load(Ordering::Relaxed) {
                return None;
            }
            if self.followers.observer.wants_checkpoint() {
                self.is_paused.store(true, Ordering::Relaxed);
                return None;
            }
            let job = self.next.fetch_add(1, Ordering::Relaxed);
            if job >= self.jobs() {
                return None;
            }
            if self.limit.as_ref().is_some_and(|limit| limit.is_over_for(job)) {
                self.drop_job(job);
                return None;
            }
            if !self.done.contains(&job) {
                return Some(job);
            }
        }
    }

    /// Runs one thread's share of the jobs.
    fn run(&self) -> Counters {
        let mut tracer = Tracer::new(self.eye.context.scene, self.eye.settings.count_work);
        let scale = scale_exponent(self.eye.context.scene);
        let mut part = Film::part(scale);
        let mut splats = Splats::new(self.eye.settings, self.eye.settings.window(), scale);
        let one_by_one = || Box::new(OneByOne(self.integrator)) as Box<dyn SampleQueue>;
        let mut queue = self.integrator.queue(&self.eye.context, self.eye.photons).unwrap_or_else(one_by_one);
        while let Some(job) = self.next_job() {
            let tile = self.tiles[job as usize % self.tiles.len()];
            let pass = job as usize / self.tiles.len();
            let samples = self.passes[pass].clone();
            part.restart(tile.window.intersection(&self.eye.settings.window()));
            let rays_before = tracer.counters.rays;
            let limited = Limited { progress: self.followers.progress, limit: self.limit.as_ref(), job };
            let mut sink = SampleSink::new(&mut part, &mut splats, &limited);
            if !queue.take(&self.eye, &mut tracer, &places(tile, &samples), &mut sink) {
                self.drop_job(job);
                return tracer.counters;
            }
            self.add(&part);
            if self.integrator.splats()
                && let Err(error) = self.take_splats(pass, &mut splats)
            {
                *self.failed.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
                return tracer.counters;
            }
            let taken = (tile.pixels() * samples.len()) as u64;
            self.followers.progress.advance(taken, tracer.counters.rays - rays_before);
        }
        tracer.counters
    }

    fn drop_job(&self, job: u64) {
        self.dropped.lock().unwrap_or_else(PoisonError::into_inner).push(job);
    }

    /// Adds the samples of a job to the film, and shows it.
    fn add(&self, part: &Film) {
        let mut film = self.film.lock().unwrap_or_else(PoisonError::into_inner);
        film.absorb(part);
        // An iteration whose photons are splatted has the film's splats.
        if film.splats.len() == film.iterations.len() && self.followers.observer.wants_film() {
            self.followers.observer.show(&film);
        }
    }

    /// Collects the splats of a tile, and adds them to the film after the last tile of its pass.
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
        film.add_iterations(iterations, self.passes[pass].len() as u32)
    }

    /// Whether each job that was begun is complete, and there are no others.
    fn is_complete(&mut self) -> bool {
        let dropped = self.dropped.get_mut().unwrap_or_else(PoisonError::into_inner);
        dropped.is_empty() && *self.next.get_mut() >= (self.tiles.len() * self.passes.len()) as u64
    }

    /// Which tiles of a pass are done, once no thread works.
    fn tiles_done(&mut self, pass: usize) -> Vec<bool> {
        let first = (pass * self.tiles.len()) as u64;
        let taken = *self.next.get_mut();
        let dropped = self.dropped.get_mut().unwrap_or_else(PoisonError::into_inner);
        let is_done = |job: u64| self.done.contains(&job) || job < taken && !dropped.contains(&job);
        (first..first + self.tiles.len() as u64).map(is_done).collect()
    }

    /// Has a checkpoint kept.
    fn keep(&mut self, counters: Counters) {
        let last = (0..self.passes.len()).rev().find(|&pass| self.tiles_done(pass).contains(&true));
        let mut begun = Begun { tiling: self.tiling, ..Begun::default() };
        for pass in 0..=last.unwrap_or(0) {
            let (samples, done) = (self.passes[pass].clone(), self.tiles_done(pass));
            if done.contains(&false) {
                let all = self.iterations.get_mut().unwrap_or_else(PoisonError::into_inner);
                begun.open.push(OpenPass { samples, done, splats: all.get(&pass).cloned() });
            } else {
                begun.complete.push(samples);
            }
        }
        let film = self.film.get_mut().unwrap_or_else(PoisonError::into_inner);
        (self.followers.keep)(film, begun, counters);
    }

    /// Whether time is up.
    fn is_late(&self) -> bool {
        self.limit.as_ref().is_some_and(Limit::is_late)
    }

    /// The film with its coverage.
    fn finish(mut self) -> Result<End, FilmError> {
        let is_complete = self.is_complete();
        let cut_short = !is_complete && self.is_late() && !self.followers.progress.is_cancelled();
        let window = self.eye.settings.window();
        let done: Vec<Vec<bool>> = (0..self.passes.len()).map(|pass| self.tiles_done(pass)).collect();
        let ending = |pass: usize| Ending { tiling: self.tiling, tiles: &self.tiles, done: &done[pass] };
        let mut film = self.film.into_inner().unwrap_or_else(PoisonError::into_inner);
        for (pass, samples) in self.passes.iter().enumerate() {
            film.coverage.extend(&ending(pass).covered(window, samples));
        }
        let first = ending(0);
        let begun = self.iterations.into_inner().unwrap_or_else(PoisonError::into_inner).remove(&0);
        let is_first = film.iterations.iter().all(|count| *count == 0);
        if let Some(splats) = begun.filter(|_| cut_short && is_first) {
            film.add_part_of_iteration(splats, first.arrived())?;
        }
        if first.is_too_short() {
            film.keep_covered();
        }
        let (cancelled, spacing) = (!is_complete && !cut_short, first.spacing());
        Ok(End { film, cancelled, cut_short, spacing })
    }
}
