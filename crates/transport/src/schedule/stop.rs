//! When a picture is good enough, or has taken long enough. Both are checked between passes over the whole film.

use crate::film::bytes::{Rest, put_counts, put_floats};
use crate::film::error::FilmError;
use crate::film::{Film, MAX_SAMPLES};
use crate::schedule::settings::{RenderSettings, Stop};
use std::ops::Range;
use std::time::{Duration, Instant};

/// The state of a picture that may end early.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reached {
    /// Samples per pixel; where time ended the picture within a pass ([`crate::Rendered::cut_short`]), those of complete passes, but at least one.
    pub spp: u32,
    /// The remaining noise, where a target was set: the standard error of a pixel relative to the light around it, as a
    /// mean over blocks of 8 × 8 pixels. Light darker than 0.3 of the picture's mean counts as that bright.
    pub noise: Option<f32>,
    /// Upper bound of the bias that arises because the samples that measure the noise are in the mean: in standard
    /// errors of a pixel, as a root mean square over pixels.
    ///
    /// Let eₙ be a pixel's error after n samples, σₙ its standard deviation, T the number of samples at which the
    /// picture ends. The bias is Σₙ E[eₙ·1(T = n)], and 1(T = n) is the same for all pixels. Errors of different pixels
    /// are independent, so by Bessel's inequality the squares of their correlations with 1(T = n) add up to at most 1
    /// over all N pixels, and the bias in units of σ is at most Σₙ √(P(T = n)(1 - P(T = n)) / N), which is 2/√N for
    /// five n that are equally likely, and less for fewer. The bound assumes nothing about how the samples of one pixel
    /// depend on each other. Where pixels see the same light paths, N is the number of pixels that see different ones.
    pub bias: Option<f32>,
}

/// The fraction of the picture's mean below which noise is not visible.
pub(crate) const DARK: f32 = 0.3;

/// Side of a block that has one noise value, in pixels.
const BLOCK: u32 = 8;

/// The part of a sample's time that has to be left for one more. The first samples take longer than the later ones, since
/// caches are cold.
const NEARLY_ONE: f64 = 0.9;

/// Watches a film as samples are added.
pub(crate) struct StopMonitor {
    stop: Stop,
    begun: Instant,
    /// The time that was spent on samples before that, by a render that this one continues.
    earlier: Duration,
    samples: Range<u32>,
    /// Number of these samples that the film holds.
    pub(crate) done: u32,
    meter: NoiseMeter,
    pub(crate) reached: Option<Reached>,
}

/// State that a monitor keeps of the films that it has seen.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct NoiseMemory {
    pub(crate) meter: NoiseMeter,
    reached: Option<Reached>,
}

impl StopMonitor {
    /// `spent` is the time that passed before the first sample.
    pub(crate) fn new(settings: &RenderSettings, spent: Duration) -> StopMonitor {
        let samples = settings.samples.clone();
        let time_limit = settings.stop.time_limit.map(|limit| limit.saturating_sub(spent));
        let stop = Stop { time_limit, ..settings.stop };
        StopMonitor {
            stop,
            begun: Instant::now(),
            earlier: Duration::ZERO,
            samples,
            done: 0,
            meter: NoiseMeter::default(),
            reached: None,
        }
    }

    /// Goes on where another monitor was after so many samples, which took so long.
    pub(crate) fn go_on(&mut self, done: u32, earlier: Duration, memory: NoiseMemory) {
        (self.done, self.earlier) = (done, earlier);
        (self.reached, self.meter) = (memory.reached, memory.meter);
    }

    /// True if time may end the picture.
    pub(crate) fn has_clock(&self) -> bool {
        self.stop.time_limit.is_some()
    }

    /// When time ends the picture.
    pub(crate) fn deadline(&self) -> Option<Instant> {
        let limit = self.stop.time_limit?;
        self.begun.checked_add(limit.saturating_sub(self.earlier))
    }

    /// Notes that time ended the picture within a pass: within the first one, some pixels have one sample and the others none.
    pub(crate) fn cut_short(&mut self) {
        self.reached.get_or_insert(Reached { spp: 1, noise: None, bias: None });
    }

    fn elapsed(&self) -> Duration {
        self.earlier + self.begun.elapsed()
    }

    /// The next samples to take; `None` when the picture is done.
    pub(crate) fn next(&mut self) -> Option<Range<u32>> {
        let left = self.samples.len() as u32 - self.done;
        // In quarters of a power of 2, so that few more samples are taken than needed.
        let mut length =
            (self.done.next_power_of_two() / if self.done.is_power_of_two() { 4 } else { 8 }).max(1);
        if let Some(limit) = self.stop.time_limit
            && self.done > 0
        {
            let elapsed = self.elapsed();
            let each = elapsed.as_secs_f64() / f64::from(self.done);
            let fits = limit.saturating_sub(elapsed).as_secs_f64() / each.max(1e-9);
            let last = u32::from(fits >= NEARLY_ONE);
            length = length.min((fits as u32).max(last));
        }
        let is_fine =
            matches!((self.noise(), self.stop.noise), (Some(noise), Some(enough)) if noise <= enough);
        length = if is_fine { 0 } else { length.min(left) };
        let start = self.samples.start + self.done;
        (length > 0).then(|| start..start + length)
    }

    /// Inspects the film after some more samples.
    pub(crate) fn look(&mut self, film: &Film, samples: &Range<u32>) {
        self.done += samples.len() as u32;
        let mut noise = None;
        if self.stop.noise.is_some() {
            noise = self.meter.look(film, self.done);
        }
        let pixels = film.window().pixels() as f64;
        let bias = noise.map(|_| (2.0 / pixels.sqrt()) as f32);
        self.reached = Some(Reached { spp: self.done, noise, bias });
    }

    fn noise(&self) -> Option<f32> {
        self.reached?.noise
    }

    /// Estimates the final number of samples per pixel.
    pub(crate) fn expected(&self) -> u32 {
        let most = self.samples.len() as u32;
        if self.done == 0 {
            return most;
        }
        let done = f64::from(self.done);
        let by_time = self.stop.time_limit.map_or(f64::INFINITY, |limit| {
            done * limit.as_secs_f64() / self.elapsed().as_secs_f64().max(1e-9)
        });
        let by_noise = match (self.noise(), self.stop.noise) {
            (Some(noise), Some(enough)) => {
                let above = (f64::from(noise) / f64::from(enough)).max(1.0);
                done * above * above
            }
            _ => f64::INFINITY,
        };
        by_time.min(by_noise).clamp(done, f64::from(most)) as u32
    }
}

/// Measures the noise of a film that gets more samples of all its pixels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NoiseMeter {
    /// Sample counts and luminances of the film at the last two looks, each at twice as many samples as the one before: the
    /// change since then separates later samples from earlier ones.
    snapshots: [Option<(u32, Vec<f32>)>; 2],
}

impl NoiseMeter {
    /// The noise of a film with `done` samples of each pixel ([`Reached::noise`]); `None` at the first look.
    pub fn look(&mut self, film: &Film, done: u32) -> Option<f32> {
        let light: Vec<f32> = film.to_rgb().into_iter().map(|pixel| pixel.luminance()).collect();
        let noise = self.measure(&light, film, done);
        if self.snapshots[1].as_ref().is_none_or(|(last, _)| done >= 2 * last) {
            self.snapshots.swap(0, 1);
            self.snapshots[1] = Some((done, light));
        }
        noise
    }

    /// Measures the noise: the squared difference between the mean of n samples and that of the first m of them is
    /// σ²(1/m - 1/n); the squared error of the mean itself is σ²/n.
    fn measure(&self, now: &[f32], film: &Film, done: u32) -> Option<f32> {
        let (m, before) = self.snapshots.iter().flatten().find(|(m, _)| *m < done)?;
        let to_own = f64::from(*m) / f64::from(done - m);
        let mean = now.iter().map(|&x| f64::from(x)).sum::<f64>() / now.len() as f64;
        let dark = (f64::from(DARK) * mean).max(f64::MIN_POSITIVE);
        let (mut sum, mut blocks) = (0.0, 0u32);
        for tile in film.window().tiles(BLOCK) {
            let (mut light, mut squares) = (0.0, 0.0);
            for (x, y) in (0..tile.pixels()).map(|i| tile.position(i)) {
                let Some(i) = film.window().index(x, y) else { continue };
                let (a, b) = (f64::from(before[i]), f64::from(now[i]));
                light += b;
                squares += (b - a) * (b - a);
            }
            let pixels = tile.pixels() as f64;
            let (light, variance) = (light / pixels, squares / pixels * to_own);
            sum += (variance / (light * light + dark * dark)).sqrt();
            blocks += 1;
        }
        Some((sum / f64::from(blocks.max(1))) as f32)
    }
}

impl StopMonitor {
    /// Appends what it remembers.
    pub(crate) fn put_memory(&self, bytes: &mut Vec<u8>) {
        let (spp, [noise, bias]) = self.reached.map_or((0, [None; 2]), |r| (r.spp, [r.noise, r.bias]));
        put_counts(bytes, &[u32::from(self.reached.is_some()), spp]);
        for number in [noise, bias] {
            put_counts(bytes, &[u32::from(number.is_some()), number.unwrap_or_default().to_bits()]);
        }
        for snapshot in &self.meter.snapshots {
            let (done, light) = snapshot.as_ref().map_or((0, &[][..]), |(done, light)| (*done, light));
            put_counts(bytes, &[done, light.len() as u32]);
            put_floats(bytes, light);
        }
    }
}

impl NoiseMemory {
    /// Reads what the monitor of a film with so many pixels remembered.
    pub(crate) fn read(rest: &mut Rest, pixels: usize) -> Result<NoiseMemory, FilmError> {
        let [is_reached, spp] = rest.numbers()?;
        let mut optional = || {
            let [is_there, bits] = rest.numbers()?;
            Ok::<_, FilmError>((is_there == 1).then_some(f32::from_bits(bits)))
        };
        let (noise, bias) = (optional()?, optional()?);
        let reached = (is_reached == 1).then_some(Reached { spp, noise, bias });
        let mut meter = NoiseMeter::default();
        for snapshot in &mut meter.snapshots {
            let [done, length] = rest.numbers()?;
            if length != 0 && (length as usize != pixels || !(1..=MAX_SAMPLES).contains(&done)) {
                return Err(FilmError::NotAFilm {
                    what: "its measured noise is not that of its pixels".to_owned(),
                });
            }
            *snapshot = (length != 0).then_some((done, rest.floats(length as usize)?));
        }
        Ok(NoiseMemory { meter, reached })
    }
}

impl NoiseMeter {
    /// True after the first look.
    pub(crate) fn has_looked(&self) -> bool {
        self.snapshots[1].is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_before_the_first_sample_counts() {
        let stop = Stop { noise: None, time_limit: Some(Duration::from_secs(1000)) };
        let settings = RenderSettings { stop, ..RenderSettings::new(1, 1, 40) };
        for (spent, more) in [(0, true), (1000, false)] {
            let mut watch = StopMonitor::new(&settings, Duration::from_secs(spent));
            watch.done = 1;
            assert_eq!(watch.next().is_some(), more, "{spent} s before");
        }
    }

    /// Noise falls with the root of the number of samples: a third of it takes nine times as many.
    #[test]
    fn samples_are_expected_by_the_square_of_the_noise() {
        let stop = Stop { noise: Some(0.02), time_limit: None };
        let settings = RenderSettings { stop, ..RenderSettings::new(1, 1, 1000) };
        let mut watch = StopMonitor::new(&settings, Duration::ZERO);
        assert_eq!(watch.expected(), 1000);
        watch.done = 16;
        for (noise, expected) in [(0.06, 144), (0.02, 16), (0.01, 16), (0.5, 1000)] {
            watch.reached = Some(Reached { spp: 16, noise: Some(noise), bias: None });
            assert!(watch.expected().abs_diff(expected) <= 1, "{noise}: {}", watch.expected());
        }
    }

    #[test]
    fn passes_come_in_quarters_of_a_power_of_two() {
        let settings = RenderSettings::new(1, 1, 40);
        let mut watch = StopMonitor::new(&settings, Duration::ZERO);
        let mut ends = Vec::new();
        while let Some(samples) = watch.next() {
            watch.done += samples.len() as u32;
            ends.push(samples.end);
        }
        assert_eq!(ends, [1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40]);
    }
}
