//! Passes over the film: all its tiles, some samples of each pixel, on all threads.

use crate::bidirectional::{PATHS, QueuedSample, SampleQueue};
use crate::camera_rays::CameraRays;
use crate::error::{FilmError, RenderError};
use crate::film::{Film, scale_exponent};
use crate::integrators::path::Path;
use crate::progress::Progress;
use crate::queue::PathQueue;
use crate::rendered::Rendered;
use crate::splats::{Iterations, Splats};
use crate::window::Window;
use bilux_accel::Counters;
use bilux_scene::Tracer;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

/// Maximum number of samples of each pixel in one pass over the film.
const PASS: u32 = 32;

/// Runs some passes over all tiles, on all threads.
pub(crate) fn all_passes(
    pool: &rayon::ThreadPool,
    eye: CameraRays,
    tiles: Vec<Window>,
    passes: Vec<Range<u32>>,
    progress: &dyn Progress,
    before: Rendered,
) -> Result<Rendered, RenderError> {
    let Rendered { film, mut counters, choice, reached, interval, batch_means, .. } = before;
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
    Ok(Rendered { film, counters, cancelled, choice, reached, interval, batch_means })
}

/// Ranges of samples that double in length, so that a first picture appears soon.
pub(crate) fn passes(samples: &Range<u32>) -> Vec<Range<u32>> {
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
    progress: &'a dyn Progress,
    tiles: Vec<Window>,
    passes: Vec<Range<u32>>,
    next: AtomicU64,
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
        let rows = tile.y..tile.y + tile.height;
        let pixels = rows.flat_map(|y| (tile.x..tile.x + tile.width).map(move |x| (x, y)));
        pixels.flat_map(|(x, y)| samples.clone().map(move |i| (x, y, i))).collect()
    }
}

impl<'a> Work<'a> {
    /// Runs one thread's share of the jobs.
    fn run(&self) -> Counters {
        let mut tracer = Tracer::new(self.eye.scene, self.eye.settings.count_work);
        let scale = scale_exponent(self.eye.scene);
        let mut part = Film::part(scale);
        let mut splats = Splats::new(self.eye.settings, self.eye.settings.window(), scale);
        let (mut path_queue, mut sample_queue) = (PathQueue::default(), self.eye.queue());
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

    /// Takes the samples of a job one after the other; false when it was cancelled on the way.
    fn one_by_one(
        &self,
        JobSamples { tile, samples }: JobSamples,
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

    /// The same for paths from the camera, many at a time.
    fn queue_paths(
        &self,
        path: &Path,
        samples: JobSamples,
        tracer: &mut Tracer<'a>,
        (part, queue): (&mut Film, &mut PathQueue),
    ) -> bool {
        let is_cancelled = || self.progress.is_cancelled();
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
            if self.progress.is_cancelled() {
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
