//! The film: fixed-point sums that do not depend on the order in which samples arrive.
//!
//! A sample is rounded to a multiple of 2⁻ᵏ and added to a 64-bit integer, so sums do not depend on threads, tiles or
//! parts. The scale `k` depends on the scene alone ([`scale_exponent`]). A hash of pixel and sample decides whether to
//! round up or down, so that sums are right on average even for light far below one step.
//!
//! Nothing is hidden: a sample that is infinite or NaN is left out of the mean, a sample beyond the scale is clamped,
//! and both are counted and located, pixel by pixel.

pub mod aovs;
pub(crate) mod batch_means;
pub(crate) mod bytes;
pub(crate) mod error;
pub(crate) mod exposure;
pub(crate) mod failures;
pub mod filters;
pub mod interval;
pub mod limits;
pub(crate) mod merged_layers;
pub mod partial;
pub(crate) mod plain_bytes;
pub(crate) mod splat_bounds;
pub mod window;

use crate::film::error::FilmError;
use crate::film::failures::{PixelFailures, SampleFailures, SamplePlace};
use crate::film::limits::SAMPLE_BITS;
use crate::film::window::{Coverage, Window};
use bilux_math::Rgb;
use bilux_math::hash::hash_words;
use bilux_scene::Scene;
use std::ops::Range;

pub use crate::film::limits::{MAX_SAMPLES, MAX_SIDE};

/// A film, or a window of one. All coordinates are those of the whole film.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    width: u32,
    height: u32,
    window: Window,
    scale_exponent: i32,
    pub(crate) sums: Vec<[i64; 3]>,
    pub(crate) counts: Vec<u32>,
    /// Splats and the number of their iterations, pixel by pixel; empty as long as there are none.
    pub(crate) splats: Vec<[i64; 3]>,
    pub(crate) iterations: Vec<u32>,
    /// Bad samples, pixel by pixel; empty as long as there are none.
    pub(crate) failures: Vec<PixelFailures>,
    pub(crate) coverage: Coverage,
    /// Identifies what the film shows: any text from the caller that differs where scene or settings differ. Films with
    /// different fingerprints do not merge.
    pub fingerprint: String,
}

/// The scale for a scene, a pure function of it: the top of the range is 2⁶ times the maximum radiance that anything
/// emits, or 2¹⁶ times all that lights bring to the middle of the scene, whichever is larger.
pub fn scale_exponent(scene: &Scene) -> i32 {
    let brightest = scene.brightest_radiance() * 64.0;
    let typical = scene.classic_brightness() * 65_536.0;
    match brightest.max(typical) {
        reach if reach.is_normal() => SAMPLE_BITS - 1 - ilog2(reach),
        _ => SAMPLE_BITS - 16,
    }
}

/// The exponent of a normal number.
fn ilog2(x: f32) -> i32 {
    (x.to_bits() >> 23 & 0xff) as i32 - 127
}

impl Film {
    /// An empty film of `width` × `height` pixels with steps of 2^-`scale_exponent`.
    ///
    /// # Errors
    /// When a side is zero or beyond [`MAX_SIDE`], or there is not enough memory.
    pub fn new(width: u32, height: u32, scale_exponent: i32) -> Result<Film, FilmError> {
        Film::windowed(width, height, Window::whole(width, height), scale_exponent)
    }

    /// A film that stores only a window.
    ///
    /// # Errors
    /// As [`Film::new`]; and when the window is empty or not within the film.
    pub fn windowed(width: u32, height: u32, window: Window, scale_exponent: i32) -> Result<Film, FilmError> {
        let fits = |side: u32| (1..=MAX_SIDE).contains(&side);
        if !fits(width) || !fits(height) {
            return Err(FilmError::Size { width, height });
        }
        if window.is_empty() || !Window::whole(width, height).contains(&window) {
            return Err(FilmError::Window { window, width, height });
        }
        let pixels = window.pixels();
        let (sums, counts) = (zeroed(pixels)?, zeroed(pixels)?);
        Ok(Film { width, height, window, sums, counts, ..Film::part(scale_exponent) })
    }

    /// An empty piece of a film: [`Film::restart`] sets its window, and [`Film::absorb`] adds it to a film.
    pub(crate) fn part(scale_exponent: i32) -> Film {
        Film {
            width: 0,
            height: 0,
            window: Window::default(),
            scale_exponent: scale_exponent.clamp(-1000, 1000),
            sums: Vec::new(),
            counts: Vec::new(),
            splats: Vec::new(),
            iterations: Vec::new(),
            failures: Vec::new(),
            coverage: Coverage::default(),
            fingerprint: String::new(),
        }
    }

    /// Bytes of memory that a film of this many pixels takes.
    pub const fn memory_bytes(pixels: u64) -> u64 {
        pixels.saturating_mul((size_of::<[i64; 3]>() + size_of::<u32>()) as u64)
    }

    /// Width of the whole film in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height of the whole film in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The part of the film that is stored.
    pub fn window(&self) -> Window {
        self.window
    }

    /// The sums count steps of 2 to the power of minus this.
    pub fn scale_exponent(&self) -> i32 {
        self.scale_exponent
    }

    /// Which samples of which pixels the film holds.
    pub fn coverage(&self) -> &Coverage {
        &self.coverage
    }

    /// Records that the film holds these samples of these pixels; [`Film::merge`] relies on it.
    pub fn cover(&mut self, window: Window, samples: Range<u32>) {
        self.coverage.insert(window, samples);
    }

    /// Adds a sample of radiance to a pixel within the window; outside it nothing happens.
    #[inline]
    pub fn add(&mut self, x: u32, y: u32, sample: u32, radiance: Rgb) {
        let Some(index) = self.window.index(x, y) else { return };
        if !radiance.is_finite() {
            return self.note_non_finite(index, sample);
        }
        let dither = hash_words([u64::from(x) << 32 | u64::from(y), u64::from(sample)]);
        let (steps, overflowed) = to_steps(radiance, self.scale_exponent, dither);
        for (sum, steps) in self.sums[index].iter_mut().zip(steps) {
            *sum += steps;
        }
        self.counts[index] += 1;
        if overflowed {
            self.note_overflowed(index, sample);
        }
    }

    #[cold]
    fn note_non_finite(&mut self, index: usize, sample: u32) {
        let failures = self.failures_at(index);
        failures.absorb(&PixelFailures::non_finite_at(sample));
    }

    #[cold]
    fn note_overflowed(&mut self, index: usize, sample: u32) {
        let failures = self.failures_at(index);
        failures.absorb(&PixelFailures::overflowed_at(sample));
    }

    pub(crate) fn failures_at(&mut self, index: usize) -> &mut PixelFailures {
        if self.failures.is_empty() {
            self.failures = vec![PixelFailures::default(); self.window.pixels()];
        }
        &mut self.failures[index]
    }

    /// Adds another film's samples. The sums are the same in whatever order films are merged.
    ///
    /// # Errors
    /// When the films have different sizes, scales or fingerprints, when both hold the same sample, or when a pixel
    /// would get more than [`MAX_SAMPLES`].
    pub fn merge(&mut self, other: &Film) -> Result<(), FilmError> {
        if (self.width, self.height) != (other.width, other.height) {
            let size = |film: &Film| [film.width, film.height];
            return Err(FilmError::OtherSize { first: size(self), second: size(other) });
        }
        if self.fingerprint != other.fingerprint || self.scale_exponent != other.scale_exponent {
            return Err(FilmError::OtherPicture);
        }
        if let Some((window, samples)) = self.coverage.overlap(&other.coverage) {
            return Err(FilmError::Overlap { window, samples });
        }
        self.check_counts(other)?;
        self.grow_to(self.window.union(&other.window))?;
        if !other.splats.is_empty() {
            self.make_room_for_splats()?;
        }
        self.absorb(other);
        self.coverage.extend(&other.coverage);
        Ok(())
    }

    fn check_counts(&self, other: &Film) -> Result<(), FilmError> {
        let most = |film: &Film| film.counts.iter().chain(&film.iterations).copied().max().unwrap_or(0);
        let total = u64::from(most(self)) + u64::from(most(other));
        if total > u64::from(MAX_SAMPLES) {
            Err(FilmError::TooManySamples { samples: total })
        } else {
            Ok(())
        }
    }

    /// Makes room for a larger window.
    fn grow_to(&mut self, window: Window) -> Result<(), FilmError> {
        if window == self.window {
            return Ok(());
        }
        let mut larger = Film::windowed(self.width, self.height, window, self.scale_exponent)?;
        if !self.splats.is_empty() {
            larger.make_room_for_splats()?;
        }
        larger.absorb(self);
        (larger.coverage, larger.fingerprint) =
            (std::mem::take(&mut self.coverage), std::mem::take(&mut self.fingerprint));
        *self = larger;
        Ok(())
    }

    /// Prepares for splats, which most films have none of.
    pub(crate) fn make_room_for_splats(&mut self) -> Result<(), FilmError> {
        if self.splats.is_empty() {
            self.splats = zeroed(self.window().pixels())?;
            self.iterations = zeroed(self.window().pixels())?;
        }
        Ok(())
    }

    /// Adds the sums of a film whose window lies within this one's; the coverage stays as it is.
    pub(crate) fn absorb(&mut self, part: &Film) {
        for (row, y) in (part.window.y..part.window.y + part.window.height).enumerate() {
            let Some(start) = self.window.index(part.window.x, y) else { continue };
            let from = row * part.window.width as usize;
            for i in 0..part.window.width as usize {
                self.counts[start + i] += part.counts[from + i];
                for channel in 0..3 {
                    self.sums[start + i][channel] += part.sums[from + i][channel];
                }
                if let Some(splats) = part.splats.get(from + i) {
                    add(&mut self.splats[start + i], *splats);
                    self.iterations[start + i] += part.iterations[from + i];
                }
                if let Some(failures) = part.failures.get(from + i).filter(|t| t.is_any()) {
                    self.failures_at(start + i).absorb(failures);
                }
            }
        }
    }

    /// Clears the piece and moves its window.
    pub(crate) fn restart(&mut self, window: Window) {
        self.window = window;
        let pixels = window.pixels();
        self.sums.clear();
        self.sums.resize(pixels, [0; 3]);
        self.counts.clear();
        self.counts.resize(pixels, 0);
        self.failures.clear();
    }

    /// The bad samples of all pixels together.
    pub fn sample_failures(&self) -> SampleFailures {
        let mut total = SampleFailures::default();
        for (index, pixel) in self.failures.iter().enumerate() {
            let at = |sample| {
                let (x, y) = self.window.position(index);
                SamplePlace { x, y, sample }
            };
            total.non_finite += u64::from(pixel.non_finite);
            total.overflowed += u64::from(pixel.overflowed);
            if pixel.non_finite > 0 {
                total.first_non_finite.get_or_insert_with(|| at(pixel.first_non_finite));
            }
            if pixel.overflowed > 0 {
                total.first_overflowed.get_or_insert_with(|| at(pixel.first_overflowed));
            }
        }
        total
    }

    /// The number of samples in the mean of each pixel of its window, row by row.
    pub fn counts(&self) -> &[u32] {
        &self.counts
    }

    /// The number of samples in a pixel's mean.
    pub fn samples(&self, x: u32, y: u32) -> u32 {
        self.window.index(x, y).map_or(0, |index| self.counts[index])
    }

    /// The light of a pixel: the mean of its samples plus its splats; black where there is nothing, NaN where all
    /// samples were bad.
    pub fn pixel(&self, x: u32, y: u32) -> Rgb {
        let step = exp2(-self.scale_exponent);
        let light = |index| self.mean(index) + self.splat_mean(index, step);
        self.window.index(x, y).map_or(Rgb::BLACK, light)
    }

    /// The mean of a pixel's own samples, without splats.
    pub fn sampled(&self, x: u32, y: u32) -> Rgb {
        self.window.index(x, y).map_or(Rgb::BLACK, |index| self.mean(index))
    }

    /// The splats of a pixel.
    pub fn splatted(&self, x: u32, y: u32) -> Rgb {
        let step = exp2(-self.scale_exponent);
        self.window.index(x, y).map_or(Rgb::BLACK, |index| self.splat_mean(index, step))
    }

    fn mean(&self, index: usize) -> Rgb {
        let bad = self.failures.get(index).is_some_and(|t| t.non_finite > 0);
        match self.counts[index] {
            0 if bad => Rgb::grey(f32::NAN),
            0 => Rgb::BLACK,
            count => {
                let step = exp2(-self.scale_exponent) / f64::from(count);
                Rgb::from_array(self.sums[index].map(|sum| (sum as f64 * step) as f32))
            }
        }
    }

    /// A pixel's light from splats.
    fn splat_mean(&self, index: usize, step: f64) -> Rgb {
        match self.iterations.get(index) {
            None | Some(0) => Rgb::BLACK,
            Some(&count) => {
                Rgb::from_array(self.splats[index].map(|sum| (sum as f64 * (step / f64::from(count))) as f32))
            }
        }
    }

    /// The light of the whole film in rows, the top row first; black outside the window.
    pub fn to_rgb(&self) -> Vec<Rgb> {
        let whole = Window::whole(self.width, self.height);
        (0..whole.pixels()).map(|i| whole.position(i)).map(|(x, y)| self.pixel(x, y)).collect()
    }
}

/// Sums saturate here, but overflow is reported long before.
pub(crate) fn add(sum: &mut [i64; 3], more: [i64; 3]) {
    for (sum, more) in sum.iter_mut().zip(more) {
        *sum = sum.saturating_add(more);
    }
}

/// Light in steps of the film, stochastically rounded, and whether it was more than the film can hold.
#[inline]
pub(crate) fn to_steps(light: Rgb, scale_exponent: i32, dither: u64) -> ([i64; 3], bool) {
    const LIMIT: i64 = 1 << SAMPLE_BITS;
    let scale = exp2(scale_exponent);
    let (mut all, mut overflowed) = ([0; 3], false);
    for (channel, value) in light.to_array().into_iter().enumerate() {
        let up = (dither >> (21 * channel) & 0x1f_ffff) as f64 * (1.0 / 2_097_152.0);
        let steps = floor((f64::from(value) * scale + up).clamp(-(LIMIT as f64), LIMIT as f64));
        overflowed |= steps.abs() >= LIMIT;
        all[channel] = steps.clamp(1 - LIMIT, LIMIT - 1);
    }
    (all, overflowed)
}

/// The greatest integer ≤ `x`, for `x` within ±2⁶². At old instruction-set levels `f64::floor` is a function call.
#[inline]
fn floor(x: f64) -> i64 {
    let towards_zero = x as i64;
    towards_zero - i64::from((towards_zero as f64) > x)
}

/// 2 to the power of `exponent`, exact, for exponents within ±1000.
fn exp2(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

/// This many zeros, or an error where there is not enough memory.
pub(crate) fn zeroed<T: Clone + Default>(count: usize) -> Result<Vec<T>, FilmError> {
    let mut buffer = Vec::new();
    buffer.try_reserve_exact(count).map_err(|_| FilmError::NoRoom { pixels: count as u64 })?;
    buffer.resize(count, T::default());
    Ok(buffer)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_do_not_depend_on_the_order() {
        let samples: Vec<Rgb> =
            (0..100).map(|i| Rgb::new(i as f32 * 1e-9, 1.0 / (i + 1) as f32, 3e4)).collect();
        let mut forwards = Film::new(2, 1, 24).unwrap();
        let mut backwards = forwards.clone();
        for (i, &sample) in samples.iter().enumerate() {
            forwards.add(1, 0, i as u32, sample);
        }
        for (i, &sample) in samples.iter().enumerate().rev() {
            backwards.add(1, 0, i as u32, sample);
        }
        assert_eq!(forwards, backwards);
        assert_eq!(forwards.samples(1, 0), 100);
    }

    #[test]
    fn light_far_below_a_step_is_right_on_average() {
        let mut film = Film::new(64, 64, 10).unwrap();
        let faint = 0.05 / 1024.0;
        for (x, y, sample) in (0..64 * 64 * 16).map(|i| (i % 64, i / 64 % 64, i / 4096)) {
            film.add(x, y, sample, Rgb::grey(faint));
        }
        let mean = film.to_rgb().iter().map(|c| f64::from(c.g)).sum::<f64>() / 4096.0;
        assert!((mean / f64::from(faint) - 1.0).abs() < 0.08, "{mean} for {faint}");
    }

    #[test]
    fn non_finite_samples_are_counted_located_and_not_black() {
        let mut film = Film::new(3, 2, 20).unwrap();
        film.add(2, 1, 7, Rgb::new(0.0, f32::NAN, 0.0));
        film.add(1, 1, 5, Rgb::grey(f32::INFINITY));
        film.add(1, 1, 4, Rgb::grey(f32::NEG_INFINITY));
        film.add(1, 1, 6, Rgb::WHITE);
        film.add(0, 0, 9, Rgb::grey(1e30));
        let failures = film.sample_failures();
        assert_eq!(failures.non_finite, 3);
        assert_eq!(failures.first_non_finite, Some(SamplePlace { x: 1, y: 1, sample: 4 }));
        assert_eq!(failures.first_overflowed, Some(SamplePlace { x: 0, y: 0, sample: 9 }));
        assert!(film.pixel(2, 1).r.is_nan());
        assert_eq!(film.pixel(1, 1), Rgb::WHITE);
        assert!(film.pixel(0, 0).r > 1e5);
    }

    #[test]
    fn senseless_sizes_are_refused() {
        assert!(matches!(Film::new(0, 5, 0), Err(FilmError::Size { .. })));
        assert!(matches!(Film::new(5, u32::MAX, 0), Err(FilmError::Size { .. })));
        let outside = Window { x: 4, y: 0, width: 2, height: 1 };
        assert!(matches!(Film::windowed(5, 5, outside, 0), Err(FilmError::Window { .. })));
    }
}
