//! Splats: the light of light subpaths, which may arrive anywhere on the film, in fixed point like all sums.
//!
//! One sample of every pixel is one iteration: as many light subpaths as the *whole* film has pixels, whatever part of
//! it is stored. Splats are summed without division; a pixel's mean divides by the iterations that the film holds. An
//! iteration counts only once all of its light subpaths have arrived, since half of them would be half of the light.

use crate::film::error::FilmError;
use crate::film::failures::PixelFailures;
use crate::film::filters::Filter;
use crate::film::window::Window;
use crate::film::{Film, add, to_steps, zeroed};
use crate::schedule::settings::RenderSettings;
use crate::techniques::{Contribution, LightPathVisitor, Tally, Technique};
use bilux_math::hash::hash_words;
use bilux_math::{Rgb, Vec2};
use std::sync::{Mutex, PoisonError};

/// The splats of light subpaths, pixel by pixel.
#[derive(Clone)]
pub struct Splats<'a> {
    filter: &'a Filter,
    anchor: f32,
    size: Vec2,
    window: Window,
    scale_exponent: i32,
    /// The current light subpath, and the number of its splats.
    path: [u64; 2],
    sample: u32,
    pub(crate) deposits: Vec<Deposit>,
}

/// A splat's share in one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Deposit {
    /// The pixel's index in the film's window.
    pub(crate) index: u32,
    pub(crate) steps: [i64; 3],
    pub(crate) failures: PixelFailures,
}

impl<'a> Splats<'a> {
    pub(crate) fn new(settings: &'a RenderSettings, window: Window, scale_exponent: i32) -> Splats<'a> {
        Splats {
            filter: &settings.filter,
            anchor: settings.pixel_anchor.offset(),
            size: Vec2::new(settings.width as f32, settings.height as f32),
            window,
            scale_exponent,
            path: [0; 2],
            sample: 0,
            deposits: Vec::new(),
        }
    }

    /// Begins the splats of the light subpath of a pixel and sample.
    pub(crate) fn begin(&mut self, x: u32, y: u32, sample: u32) {
        self.path = [u64::from(x) << 32 | u64::from(y), u64::from(sample) << 32];
        self.sample = sample;
    }

    /// Adds light at a point of the film's plane (the film is 0..1 on both axes, y downwards), as an estimate of the integral over the
    /// whole film of importance times radiance, the film's area being 1. Each pixel whose filter reaches the point gets
    /// its share.
    pub fn add(&mut self, film: Vec2, light: Rgb) {
        self.path[1] += 1;
        if light.is_black() {
            return;
        }
        let at = film * self.size;
        let reach = self.filter.radius();
        let range = |at: f32| {
            // A pixel reaches its centre ± radius: one more on each side costs little, and makes rounding harmless.
            let first = (at - self.anchor - reach).floor().max(0.0);
            (first as u32, (at - self.anchor + reach).floor().max(0.0) as u32 + 1)
        };
        let ((left, right), (top, bottom)) = (range(at.x), range(at.y));
        for y in top..=bottom {
            let share_y = self.filter.density(at.y - (y as f32 + self.anchor));
            if share_y == 0.0 {
                continue;
            }
            for x in left..=right {
                let share = share_y * self.filter.density(at.x - (x as f32 + self.anchor));
                if share > 0.0 {
                    self.deposit(x, y, light * share);
                }
            }
        }
    }

    fn deposit(&mut self, x: u32, y: u32, light: Rgb) {
        let Some(index) = self.window.index(x, y) else { return };
        let mut deposit = Deposit { index: index as u32, steps: [0; 3], failures: PixelFailures::default() };
        if light.is_finite() {
            let dither = hash_words([self.path[0], self.path[1], u64::from(x) << 32 | u64::from(y)]);
            let (steps, overflowed) = to_steps(light, self.scale_exponent, dither);
            deposit.steps = steps;
            if overflowed {
                deposit.failures = PixelFailures::overflowed_at(self.sample);
            }
        } else {
            deposit.failures = PixelFailures::non_finite_at(self.sample);
        }
        self.deposits.push(deposit);
    }
}

/// The weighted light of a sample: in its own pixel, and as splats.
pub(crate) struct Sum<'a, 's> {
    pub(crate) here: Rgb,
    pub(crate) splats: &'a mut Splats<'s>,
}

impl Tally<1> for Sum<'_, '_> {
    fn add_sample(&mut self, _technique: Technique, found: &Contribution) {
        self.here += found.weighted();
    }
    fn add_splat(&mut self, film: Vec2, _technique: Technique, found: &Contribution) {
        self.splats.add(film, found.weighted());
    }
}

impl<const N: usize> Tally<N> for Splats<'_> {
    fn add_sample(&mut self, _technique: Technique, _found: &Contribution<N>) {}

    fn add_splat(&mut self, film: Vec2, _technique: Technique, found: &Contribution<N>) {
        self.add(film, found.weighted());
    }
}

/// The splats of one iteration's light subpaths, where they are traced before its camera subpaths. They are added to those of the
/// iterations before, so that there is one sum of all, and not another of this iteration.
pub(crate) struct IterationSplats<'a> {
    settings: &'a RenderSettings,
    scale_exponent: i32,
    /// 1, or -1 where they are taken back.
    sign: i64,
    iterations: Mutex<Iterations>,
}

impl<'a> IterationSplats<'a> {
    /// Takes the splats of a film, to which those of an iteration will be added; they have to be returned.
    pub(crate) fn of_film(
        film: &mut Film,
        settings: &'a RenderSettings,
        tiles: usize,
    ) -> Result<IterationSplats<'a>, FilmError> {
        film.make_room_for_splats()?;
        let (sums, failures) = (std::mem::take(&mut film.splats), Vec::new());
        let iterations = Mutex::new(Iterations { sums, failures, tiles_left: tiles });
        Ok(IterationSplats { settings, scale_exponent: film.scale_exponent(), sign: 1, iterations })
    }

    /// Scales them up, where they are of so many of all light subpaths of a first iteration.
    pub(crate) fn scale_up(&self, part: [usize; 2]) {
        scale_up(&mut self.iterations.lock().unwrap_or_else(PoisonError::into_inner).sums, part);
    }

    /// Goes on with an iteration whose splats the film has already, and so many of which failed.
    pub(crate) fn going_on(self, failures: Vec<(u32, PixelFailures)>) -> IterationSplats<'a> {
        let mut iterations = self.iterations.into_inner().unwrap_or_else(PoisonError::into_inner);
        iterations.failures = failures;
        IterationSplats { iterations: Mutex::new(iterations), ..self }
    }

    /// Lends them to the film, with what failed, as long as `look` looks at it.
    pub(crate) fn lend(&self, film: &mut Film, look: impl FnOnce(&mut Film, &[(u32, PixelFailures)])) {
        let mut iterations = self.iterations.lock().unwrap_or_else(PoisonError::into_inner);
        std::mem::swap(&mut film.splats, &mut iterations.sums);
        look(film, &iterations.failures);
        std::mem::swap(&mut film.splats, &mut iterations.sums);
    }

    /// Returns them to the film: the iteration is complete.
    pub(crate) fn complete(self, film: &mut Film) {
        let Iterations { sums, failures, .. } =
            self.iterations.into_inner().unwrap_or_else(PoisonError::into_inner);
        film.splats = sums;
        film.count_iterations(failures, 1);
    }

    /// Returns them to the film without the iteration, whose light subpaths `trace` traces once more: sums of integers are exact.
    pub(crate) fn take_back(self, film: &mut Film, tiles: usize, trace: impl FnOnce(&Self)) {
        let mut iterations = self.iterations.into_inner().unwrap_or_else(PoisonError::into_inner);
        if film.iterations.iter().all(|count| *count == 0) {
            film.iterations = Vec::new();
            return;
        }
        iterations.tiles_left = tiles;
        let negative = IterationSplats { sign: -1, iterations: Mutex::new(iterations), ..self };
        trace(&negative);
        film.splats = negative.iterations.into_inner().unwrap_or_else(PoisonError::into_inner).sums;
    }
}

impl<'a, const N: usize> LightPathVisitor<N> for IterationSplats<'a> {
    type Tally = Splats<'a>;

    fn tally(&self) -> Splats<'a> {
        Splats::new(self.settings, self.settings.window(), self.scale_exponent)
    }

    fn begin(splats: &mut Splats<'a>, x: u32, y: u32, sample: u32) {
        splats.begin(x, y, sample);
    }

    fn take(&self, _tile: usize, mut splats: Splats<'a>) {
        splats.deposits.iter_mut().for_each(|deposit| deposit.steps = deposit.steps.map(|n| self.sign * n));
        self.iterations.lock().unwrap_or_else(PoisonError::into_inner).take(&mut splats.deposits);
    }
}

/// The splats of some iterations as they arrive.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Iterations {
    pub(crate) sums: Vec<[i64; 3]>,
    pub(crate) failures: Vec<(u32, PixelFailures)>,
    /// Tiles of the film whose light subpaths have not arrived yet.
    pub(crate) tiles_left: usize,
}

impl Iterations {
    pub(crate) fn new(pixels: usize, tiles: usize) -> Result<Iterations, FilmError> {
        Ok(Iterations { sums: zeroed(pixels)?, failures: Vec::new(), tiles_left: tiles })
    }

    /// Takes over the splats of one tile.
    pub(crate) fn take(&mut self, deposits: &mut Vec<Deposit>) {
        for deposit in deposits.drain(..) {
            add(&mut self.sums[deposit.index as usize], deposit.steps);
            if deposit.failures.is_any() {
                self.failures.push((deposit.index, deposit.failures));
            }
        }
        self.tiles_left -= 1;
    }
}

/// Scales sums of a part to those of all.
fn scale_up(sums: &mut [[i64; 3]], [part, all]: [usize; 2]) {
    let scaled = |sum: i64| i128::from(sum) * all as i128 / (part as i128).max(1);
    let within = |sum: i128| sum.clamp(i128::from(i64::MIN), i128::from(i64::MAX)) as i64;
    sums.iter_mut().for_each(|sums| *sums = sums.map(|sum| within(scaled(sum))));
}

impl Film {
    /// Adds whole iterations.
    pub(crate) fn add_iterations(&mut self, splats: Iterations, iterations: u32) -> Result<(), FilmError> {
        if self.splats.is_empty() {
            (self.splats, self.iterations) = (splats.sums, zeroed(self.window().pixels())?);
        } else {
            for (sum, more) in self.splats.iter_mut().zip(splats.sums) {
                add(sum, more);
            }
        }
        self.count_iterations(splats.failures, iterations);
        Ok(())
    }

    /// Adds an iteration of which so many of all light subpaths have arrived, scaled up to all of them.
    pub(crate) fn add_part_of_iteration(
        &mut self,
        mut splats: Iterations,
        [arrived, all]: [usize; 2],
    ) -> Result<(), FilmError> {
        scale_up(&mut splats.sums, [arrived, all]);
        self.add_iterations(splats, 1)
    }

    fn count_iterations(&mut self, failures: Vec<(u32, PixelFailures)>, iterations: u32) {
        self.iterations.iter_mut().for_each(|count| *count += iterations);
        for (index, failures) in failures {
            self.failures_at(index as usize).absorb(&failures);
        }
    }
}
