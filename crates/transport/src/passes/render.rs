//! The tile loop: every sample of every pixel, on all cores, into one film.

use crate::checkpoint::{Begun, Checkpoint, Observer, Standing, Unkept, Unobserved};
use crate::film::error::RenderError;
use crate::film::failures::PixelFailures;
use crate::film::interval::Interval;
use crate::film::window::{TILE, Tiling, Window};
use crate::film::{Film, scale_exponent};
use crate::integrators::pixel_integrator::{PixelIntegrator, Plan};
use crate::passes::photon_tracing::iterations;
use crate::passes::{Followers, Passes, all_passes};
use crate::photons::{Merging, Photons};
use crate::sampling::camera_rays::CameraRays;
use crate::sampling::splats::IterationSplats;
use crate::schedule::Schedule;
use crate::schedule::progress::Progress;
use crate::schedule::rendered::Rendered;
use crate::schedule::settings::{RenderSettings, Stop, threads};
use bilux_accel::Counters;
use bilux_math::parallel::{ThreadPool, install};
use bilux_scene::{Camera, Scene};
use std::ops::Range;
use std::time::{Duration, Instant};

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

/// Plan of an integrator that chooses its strategies, for a picture; `None` for the others. The plan's integrator
/// renders as the one that chose it, without choosing again: for pictures that are rendered in several ranges of
/// samples.
///
/// # Errors
/// As for [`render()`].
pub fn plan(
    scene: &Scene,
    camera: &dyn Camera,
    integrator: &dyn PixelIntegrator,
    settings: &RenderSettings,
) -> Result<Option<Plan>, RenderError> {
    settings.check()?;
    let pool = threads(settings)?;
    Ok(install(&pool, || integrator.plan(scene, camera, &settings.for_planning())))
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
    render_from(None, scene, camera, integrator, settings, progress, &Unobserved)
}

/// Renders the requested samples, of which a checkpoint may have some, while an observer sees the film. The film is that
/// of [`render()`], bit for bit, unless time ends it.
///
/// # Errors
/// As for [`render()`]; and when the checkpoint belongs to another picture or has more samples than are requested.
pub fn render_from(
    from: Option<Checkpoint>,
    scene: &Scene,
    camera: &dyn Camera,
    integrator: &dyn PixelIntegrator,
    settings: &RenderSettings,
    progress: &dyn Progress,
    observer: &dyn Observer,
) -> Result<Rendered, RenderError> {
    settings.check()?;
    let begun = Instant::now();
    let scale = scale_exponent(scene);
    let film = Film::windowed(settings.width, settings.height, settings.window(), scale)?;
    let pool = threads(settings)?;
    let stop = if from.is_none() { settings.stop } else { Stop::default() };
    let film_of_plan = RenderSettings { stop, ..settings.for_planning() };
    let plan = install(&pool, || integrator.plan(scene, camera, &film_of_plan));
    // A render that went on from here would choose with all of a pilot's samples.
    let unkept = Unkept(observer);
    let observer = if plan.as_ref().is_some_and(|plan| plan.is_hurried) { &unkept } else { observer };
    let (choice, planned, counters) = match plan {
        Some(Plan { choice, integrator, counters, .. }) => (Some(choice), Some(integrator), counters),
        None => (None, None, Counters::default()),
    };
    let integrator = planned.as_deref().unwrap_or(integrator);
    if settings.interval && !integrator.is_random() {
        return Err(RenderError::IntervalOfPattern);
    }
    if scene.scatters() && !integrator.follows_media(scene) {
        return Err(RenderError::Media);
    }
    if scene.has_glowing_media() && !integrator.sees_glow() {
        return Err(RenderError::Glow);
    }
    if camera.receives() && !integrator.receives() {
        return Err(RenderError::Receives);
    }
    progress.begin(settings.sample_count(integrator));
    let interval = settings.interval.then(|| Interval::new(settings.window())).transpose()?;
    let empty = Rendered {
        film,
        counters,
        cancelled: false,
        cut_short: false,
        spacing: None,
        planning: begun.elapsed(),
        choice,
        reached: None,
        interval,
        batch_means: None,
    };
    let run = Run { scene, camera, integrator, settings, progress, observer, pool, scale };
    run.take_all(from, empty, begun)
}

/// Everything that stays the same while a picture is rendered.
struct Run<'a> {
    scene: &'a Scene,
    camera: &'a dyn Camera,
    integrator: &'a dyn PixelIntegrator,
    settings: &'a RenderSettings,
    progress: &'a dyn Progress,
    observer: &'a dyn Observer,
    pool: ThreadPool,
    scale: i32,
}

/// Place of a range of samples in the picture, for its checkpoints.
struct Place<'a> {
    schedule: &'a Schedule,
    /// With an interval: the samples before these, and their replicates.
    before: Option<(&'a Film, &'a Interval)>,
    /// When the first sample was begun.
    first: Instant,
    /// The time that renders took that this one continues.
    earlier: Duration,
}

impl<'a> Run<'a> {
    fn eye(&self) -> CameraRays<'a> {
        self.integrator.camera_rays(self.scene, self.camera, self.settings)
    }

    /// Takes all samples, or those that a checkpoint lacks, until the schedule ends.
    fn take_all(
        &self,
        from: Option<Checkpoint>,
        mut rendered: Rendered,
        begun: Instant,
    ) -> Result<Rendered, RenderError> {
        let settings = self.settings;
        let sampled = settings.sampled_window(self.integrator);
        let (mut schedule, mut open, mut earlier) =
            (Schedule::new(settings, begun.elapsed()), None, Duration::ZERO);
        if let Some(from) = from {
            from.check(settings, self.scale, sampled)?;
            let Checkpoint { film, before, interval, memory, begun: open_passes, counters, rendering } = from;
            schedule = Schedule::going_on(settings, begun.elapsed(), memory, rendering)?;
            rendered.counters += counters;
            (rendered.film, rendered.interval) = (before.unwrap_or_else(|| film.clone()), interval);
            if settings.interval {
                open = Some((open_passes, Some(film)));
            } else {
                rendered.film = film;
                open = Some((open_passes, None));
            }
            earlier = rendering;
            let samples = rendered.film.counts.iter().map(|&count| u64::from(count)).sum::<u64>();
            let every = sampled.pixels() as u64 / settings.window().pixels().max(1) as u64;
            self.progress.advance(samples * every, 0);
        }
        let first = Instant::now();
        while !rendered.cancelled
            && let Some(samples) = schedule.next_from(open.as_ref().and_then(|(open, _)| open.end()))?
        {
            let open = open.take();
            let place = Place { schedule: &schedule, before: None, first, earlier };
            rendered = if settings.interval {
                self.take_each(&samples, open, rendered, &place)?
            } else {
                self.take(&samples, open.map(|(open, _)| open), rendered, &place)?
            };
            if rendered.cut_short {
                schedule.cut_short();
                break;
            }
            if !rendered.cancelled {
                schedule.look(&rendered.film, &samples);
                if let Some(expected) = schedule.expected() {
                    self.progress.begin(sampled.pixels() as u64 * u64::from(expected));
                }
            }
        }
        let (reached, batch_means) = schedule.end(Some(&rendered.film).filter(|_| !rendered.cancelled));
        Ok(Rendered { reached, batch_means, ..rendered })
    }

    /// Adds some samples of every pixel; `begun` are those of them that the film has.
    fn take(
        &self,
        samples: &Range<u32>,
        begun: Option<Begun>,
        mut rendered: Rendered,
        place: &Place,
    ) -> Result<Rendered, RenderError> {
        let window = self.settings.sampled_window(self.integrator);
        let large = MANY_TILES * self.pool.current_num_threads() * (LARGE_TILE * LARGE_TILE) as usize;
        let side = if window.pixels() >= large { LARGE_TILE } else { TILE };
        // Replicates have whole samples.
        let deadline = place.schedule.deadline().filter(|_| !self.settings.interval);
        let is_first = samples.start == self.settings.samples.start;
        let tiling =
            if deadline.is_some() && is_first { Tiling::Spread(side) } else { Tiling::Squares(side) };
        let mut rest = samples.clone();
        if let Some(Begun { tiling, complete, open, splatted }) = begun {
            let all = open.iter().map(|pass| &pass.samples).chain(&complete);
            rest.start = all.map(|samples| samples.end).max().unwrap_or(rest.start);
            complete.into_iter().for_each(|done| rendered.film.cover(self.settings.window(), done));
            if let Some(first) = open.first() {
                let iteration = first.samples.start;
                // What was begun is completed, whatever time it is.
                let passes = Passes { tiling, ranges: open, deadline: None };
                rendered = self.take_passes(iteration, passes, splatted, rendered, place)?;
            }
        }
        for samples in iterations(self.integrator, &rest) {
            if rendered.cancelled || rendered.cut_short {
                break;
            }
            let passes = Passes::of(&samples, tiling, deadline);
            rendered = self.take_passes(samples.start, passes, None, rendered, place)?;
        }
        Ok(rendered)
    }

    /// Takes some passes: of an iteration, where there are photons. `splatted` says that the film has their splats.
    fn take_passes(
        &self,
        iteration: u32,
        passes: Passes,
        splatted: Option<Vec<(u32, PixelFailures)>>,
        mut rendered: Rendered,
        place: &Place,
    ) -> Result<Rendered, RenderError> {
        let (pool, settings) = (&self.pool, self.settings);
        let window = settings.sampled_window(self.integrator);
        let whole = Window::whole(settings.width, settings.height).tiles(TILE);
        let splats_photons = self.integrator.merging().is_some_and(Merging::splats_photons);
        let film = &mut rendered.film;
        let splats = splats_photons.then(|| IterationSplats::of_film(film, settings, whole.len()));
        let mut splats = splats.transpose()?;
        // The first iteration of a picture whose time is short: half of that for photons, and half for what the camera sees.
        let now = Instant::now();
        let is_new = iteration == settings.samples.start && splatted.is_none();
        let left = passes.deadline.filter(|_| is_new).map(|at| at.saturating_duration_since(now));
        let half = left.map(|left| now + left / 2);
        let trace = |splats: Option<&IterationSplats>| {
            install(pool, || {
                Photons::of_iteration(self.integrator, &self.eye(), &whole, iteration, splats, half)
            })
        };
        let photons = trace(splats.as_ref().filter(|_| splatted.is_none()));
        if let Some(failures) = splatted {
            splats = splats.map(|splats| splats.going_on(failures));
        }
        let mut eye = self.eye();
        if let Some((photons, counters)) = &photons {
            if let (Some(part), Some(splats)) = (photons.part, &splats) {
                splats.scale_up(part);
            }
            rendered.counters += *counters;
            eye.photons = Some(photons);
        }
        let keep = |film: &mut Film, mut begun: Begun, counters| match &splats {
            Some(splats) => splats.lend(film, |film, failures| {
                begun.splatted = Some(failures.to_vec());
                self.keep(film, &begun, counters, place);
            }),
            None => self.keep(film, &begun, counters, place),
        };
        let followers = Followers { progress: self.progress, observer: self.observer, keep: &keep };
        rendered = all_passes(pool, self.integrator, eye, window, passes, followers, rendered)?;
        match splats {
            Some(splats) if rendered.cancelled => {
                splats.take_back(&mut rendered.film, whole.len(), |splats| drop(trace(Some(splats))));
            }
            Some(splats) => splats.complete(&mut rendered.film),
            None => {}
        }
        if !rendered.cancelled && photons.is_some() && self.observer.wants_film() {
            self.observer.show(&rendered.film);
        }
        Ok(rendered)
    }

    /// Adds samples as [`Run::take`] does, but one after the other, so that each goes into its replicate.
    fn take_each(
        &self,
        samples: &Range<u32>,
        open: Option<(Begun, Option<Film>)>,
        mut rendered: Rendered,
        place: &Place,
    ) -> Result<Rendered, RenderError> {
        let (mut next, mut open) = (samples.start, open);
        if let Some((begun, _)) = &open {
            next = begun.open.first().map(|pass| pass.samples.start).or(begun.end()).unwrap_or(next);
        }
        for sample in next..samples.end {
            let (settings, window) = (self.settings, self.settings.window());
            let empty = Film::windowed(settings.width, settings.height, window, self.scale)?;
            let (begun, one) = open.take().unzip();
            let one = one.flatten().unwrap_or(empty);
            let before = std::mem::replace(&mut rendered.film, one);
            let Some(mut interval) = rendered.interval.take() else { break };
            let place = Place { before: Some((&before, &interval)), ..*place };
            rendered = self.take(&(sample..sample + 1), begun, rendered, &place)?;
            let one = std::mem::replace(&mut rendered.film, before);
            rendered.film.merge(&one)?;
            if !rendered.cancelled {
                interval.add(sample, &one);
            }
            rendered.interval = Some(interval);
            if rendered.cancelled {
                break;
            }
        }
        Ok(rendered)
    }

    /// Has a checkpoint kept.
    fn keep(&self, film: &Film, begun: &Begun, counters: Counters, place: &Place) {
        let (before, interval) = place.before.unzip();
        let rendering = place.earlier + place.first.elapsed();
        let schedule = place.schedule;
        self.observer.keep(&Standing { film, before, interval, begun, schedule, counters, rendering });
    }
}
