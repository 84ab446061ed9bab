//! Passes over the film: all its tiles, some samples of each pixel, on all threads.

use crate::bidirectional::{PATHS, QueuedSample, SampleQueue};
use crate::camera_rays::CameraRays;
use crate::checkpoint::{Begun, Observer, OpenPass};
use crate::error::{FilmError, RenderError};
use crate::film::{Film, scale_exponent};
use crate::integrators::path::Path;
use crate::progress::Progress;
use crate::queue::PathQueue;
use crate::rendered::Rendered;
use crate::splats::{Iterations, Splats};
use crate::window::{Coverage, Window};
use bilux_accel::Counters;
use bilux_scene::Tracer;
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, HashSet};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

/// Maximum number of samples of each pixel in one pass over the film.
const PASS: u32 = 32;

/// Who follows the passes.
#[derive(Clone, Copy)]
pub(crate) struct Followers<'a> {
    pub(crate) progress: &'a dyn Progress,
    pub(crate) observer: &'a dyn Observer,
    /// Keeps a checkpoint of the film with these passes.
    pub(crate) keep: &'a (dyn Fn(&mut Film, Begun, Counters) + Sync),
}

/// Passes over all tiles, of which some jobs may be done.
pub(crate) struct Passes {
    /// The side of the tiles, in pixels.
    pub(crate) side: u32,
    pub(crate) ranges: Vec<OpenPass>,
}

impl Passes {
    /// The passes that take these samples, none of which is begun.
    pub(crate) fn of(samples: &Range<u32>, side: u32) -> Passes {
        let open = |samples| OpenPass { samples, done: Vec::new(), splats: None };
        Passes { side, ranges: passes(samples).into_iter().map(open).collect() }
    }
}

/// Runs some passes over all tiles of the `sampled` window, on all threads.
pub(crate) fn all_passes(
    pool: &rayon::ThreadPool,
    eye: CameraRays,
    sampled: Window,
    passes: Passes,
    followers: Followers,
    before: Rendered,
) -> Result<Rendered, RenderError> {
    let Rendered { film, mut counters, choice, reached, interval, batch_means, .. } = before;
    let mut work = Work::new(eye, sampled, passes, followers, film);
    loop {
        pool.broadcast(|_| work.run()).into_iter().for_each(|c| counters += c);
        if let Some(error) = work.failed.lock().unwrap_or_else(PoisonError::into_inner).take() {
            return Err(error.into());
        }
        if work.is_complete() {
            break;
        }
        work.keep(counters);
        if !*work.is_paused.get_mut() {
            break;
        }
        *work.is_paused.get_mut() = false;
    }
    let (film, cancelled) = work.finish();
    Ok(Rendered { film, counters, cancelled, choice, reached, interval, batch_means })
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
    eye: CameraRays<'a>,
    followers: Followers<'a>,
    side: u32,
    tiles: Vec<Window>,
    passes: Vec<Range<u32>>,
    /// Jobs that were done before.
    done: HashSet<u64>,
    next: AtomicU64,
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

/// The samples of a job: some of each pixel of a tile.
struct JobSamples {
    tile: Window,
    samples: Range<u32>,
}

impl JobSamples {
    /// Column, row and index of each.
    fn all(&self) -> Vec<(u32, u32, u32)> {
        let JobSamples { tile, samples } = self;
        let mut all = Vec::with_capacity(tile.width as usize * tile.height as usize * samples.len());
        for y in tile.y..tile.y + tile.height {
            for x in tile.x..tile.x + tile.width {
                all.extend(samples.clone().map(|i| (x, y, i)));
            }
        }
        all
    }
}

impl<'a> Work<'a> {
    fn new(
        eye: CameraRays<'a>,
        sampled: Window,
        Passes { side, ranges }: Passes,
        followers: Followers<'a>,
        film: Film,
    ) -> Work<'a> {
        let tiles = sampled.tiles(side);
        let (mut done, mut iterations) = (HashSet::new(), BTreeMap::new());
        let mut passes = Vec::with_capacity(ranges.len());
        for (pass, open) in ranges.into_iter().enumerate() {
            let jobs = (pass * tiles.len()) as u64..;
            done.extend(jobs.zip(open.done).filter(|(_, is_done)| *is_done).map(|(job, _)| job));
            iterations.extend(open.splats.map(|splats| (pass, splats)));
            passes.push(open.samples);
        }
        Work {
            eye,
            followers,
            side,
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
            if !self.done.contains(&job) {
                return Some(job);
            }
        }
    }

    /// Runs one thread's share of the jobs.
    fn run(&self) -> Counters {
        let mut tracer = Tracer::new(self.eye.scene, self.eye.settings.count_work);
        let scale = scale_exponent(self.eye.scene);
        let mut part = Film::part(scale);
        let mut splats = Splats::new(self.eye.settings, self.eye.settings.window(), scale);
        let (mut path_queue, mut sample_queue) = (PathQueue::default(), self.eye.queue());
        while let Some(job) = self.next_job() {
            let tile = self.tiles[job as usize % self.tiles.len()];
            let pass = job as usize / self.tiles.len();
            let samples = self.passes[pass].clone();
            part.restart(tile.intersection(&self.eye.settings.window()));
            let rays_before = tracer.counters.rays;
            let job_samples = JobSamples { tile, samples: samples.clone() };
            let finished = match (PathQueue::integrator(&self.eye), &mut sample_queue) {
                (Some(path), _) => {
                    self.queue_paths(path, job_samples, &mut tracer, (&mut part, &mut path_queue))
                }
                (None, Some(queue)) => {
                    self.queue_samples(&mut **queue, job_samples, &mut tracer, (&mut part, &mut splats))
                }
                (None, None) => self.one_by_one(job_samples, &mut tracer, (&mut part, &mut splats)),
            };
            if !finished {
                self.dropped.lock().unwrap_or_else(PoisonError::into_inner).push(job);
                return tracer.counters;
            }
            self.add(&part);
            if self.eye.integrator.splats()
                && let Err(error) = self.take_splats(pass, &mut splats)
            {
                *self.failed.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
                return tracer.counters;
            }
            let taken = tile.pixels() as u64 * samples.len() as u64;
            self.followers.progress.advance(taken, tracer.counters.rays - rays_before);
        }
        tracer.counters
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

    /// Takes the samples of a job one after the other; false when it was cancelled on the way.
    fn one_by_one(
        &self,
        JobSamples { tile, samples }: JobSamples,
        tracer: &mut Tracer<'a>,
        (part, splats): (&mut Film, &mut Splats),
    ) -> bool {
        for y in tile.y..tile.y + tile.height {
            if self.followers.progress.is_cancelled() {
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

    /// The same for paths from the camera, many at a time.
    fn queue_paths(
        &self,
        path: &Path,
        samples: JobSamples,
        tracer: &mut Tracer<'a>,
        (part, queue): (&mut Film, &mut PathQueue),
    ) -> bool {
        let is_cancelled = || self.followers.progress.is_cancelled();
        queue.take(path, &self.eye, tracer, &samples.all(), is_cancelled, |(x, y, sample), light| {
            part.add(x, y, sample, light)
        })
    }

    /// The same for samples of other integrators.
    fn queue_samples(
        &self,
        queue: &mut dyn SampleQueue,
        samples: JobSamples,
        tracer: &mut Tracer<'a>,
        (part, splats): (&mut Film, &mut Splats),
    ) -> bool {
        for samples in samples.all().chunks(PATHS) {
            if self.followers.progress.is_cancelled() {
                return false;
            }
            let queued: Vec<_> = samples
                .iter()
                .map(|&(x, y, sample)| {
                    let (ray, task) = self.eye.sample(tracer, x, y, sample);
                    QueuedSample::new(ray, &task, part.window().index(x, y).is_some())
                })
                .collect();
            let Some(&(x, y, sample)) = samples.first() else { continue };
            // Its tools serve all samples; each has its own random numbers and wavelength.
            let (_, mut task) = self.eye.sample(tracer, x, y, sample);
            let mut current = None;
            let light = queue.take(&queued, &mut task, &mut |i, film, light| {
                if current != Some(i) {
                    let (x, y, sample) = samples[i];
                    splats.begin(x, y, sample);
                    current = Some(i);
                }
                splats.add(film, light);
            });
            for (&(x, y, sample), light) in samples.iter().zip(light) {
                part.add(x, y, sample, light);
            }
        }
        true
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
        let mut begun = Begun { side: self.side, ..Begun::default() };
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

    /// The film with its coverage, and whether anything is missing.
    fn finish(mut self) -> (Film, bool) {
        let is_complete = self.is_complete();
        let window = self.eye.settings.window();
        let mut covered = Coverage::default();
        for pass in 0..self.passes.len() {
            let samples = self.passes[pass].clone();
            if is_complete {
                covered.insert(window, samples);
                continue;
            }
            let done = self.tiles_done(pass);
            if !done.contains(&false) {
                covered.insert(window, samples);
                continue;
            }
            for (tile, _) in self.tiles.iter().zip(done).filter(|(_, is_done)| *is_done) {
                covered.insert(tile.intersection(&window), samples.clone());
            }
        }
        let mut film = self.film.into_inner().unwrap_or_else(PoisonError::into_inner);
        film.coverage.extend(&covered);
        (film, !is_complete)
    }
}
