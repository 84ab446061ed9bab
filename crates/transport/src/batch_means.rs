//! The variance of each pixel's mean, estimated by batch means [Schmeiser 1982]: the samples are cut into batches, and how far the
//! means of the batches differ says how far the mean of all of them may be off. Denoisers need this estimate.
//!
//! Squares of single samples would overstate the error, since samples are stratified over a pixel: a batch keeps what its
//! stratification gains. The film does not have to store squares, and light paths, which have no samples of a pixel of
//! their own, are treated like camera paths.

use crate::error::FilmError;
use crate::film::Film;
use bilux_math::Rgb;
use bilux_pictures::Picture;
use std::ops::Range;

/// How much of its weight a batch loses with each batch after it. Later batches are larger, so that their means show more of
/// what stratification gains.
const DECAY: f32 = 0.7;

/// The batches of a film so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BatchMeans {
    /// Samples per pixel in all batches.
    samples: u32,
    /// The sum of the weights of all differences.
    weights: f32,
    /// Light that camera paths have brought, and light that light paths have left.
    layers: [Vec<Pixel>; 2],
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Pixel {
    count: u32,
    mean: Rgb,
    /// The weighted sum of squared differences, each scaled to the variance of one sample.
    squares: Rgb,
}

impl Pixel {
    /// Adds a batch, given the mean of all samples with it [Chan 1983].
    fn add(&mut self, mean: Rgb, count: u32) {
        let batch = count.saturating_sub(self.count);
        let apart = mean - self.mean;
        let scale = if batch > 0 { self.count as f32 * count as f32 / batch as f32 } else { 0.0 };
        self.squares = self.squares * DECAY + apart * apart * scale;
        (self.mean, self.count) = (mean, count);
    }
}

impl BatchMeans {
    /// True when a batch ends with this many samples per pixel: after each of the first four, and then twice an octave.
    pub(crate) fn ends_at(samples: u32) -> bool {
        samples <= 4
            || samples.is_power_of_two()
            || samples.is_multiple_of(3) && (samples / 3).is_power_of_two()
    }

    /// Closes a batch: the film now has this many samples per pixel.
    pub(crate) fn close(&mut self, film: &Film, samples: u32) {
        if samples <= self.samples {
            return;
        }
        let is_first = self.samples == 0;
        let pixels = film.window().pixels();
        for layer in [0, 1] {
            let means = means(film, layer, 0..pixels);
            self.layers[layer].resize(means.len(), Pixel::default());
            for (pixel, (mean, count)) in self.layers[layer].iter_mut().zip(means) {
                pixel.add(mean, count);
            }
        }
        self.weights = if is_first { 0.0 } else { self.weights * DECAY + 1.0 };
        self.samples = samples;
    }

    /// The variance of the mean that camera paths give some pixels of the film's window, and of the mean that light paths give, where there are
    /// any. `None` as long as there are fewer than two batches.
    pub fn variance(&self, pixels: Range<usize>) -> Option<[Vec<Rgb>; 2]> {
        (self.weights > 0.0).then(|| {
            [0, 1].map(|layer| {
                let some = self.layers[layer].get(pixels.clone()).unwrap_or(&[]);
                some.iter().map(|p| p.squares * (1.0 / (self.weights * p.count.max(1) as f32))).collect()
            })
        })
    }
}

/// The mean of each pixel's samples and their number, by camera paths or by light paths; nothing where there are no light paths.
fn means(film: &Film, layer: usize, pixels: Range<usize>) -> impl ExactSizeIterator<Item = (Rgb, u32)> + '_ {
    let pixels = if layer == 1 && film.splats.is_empty() { 0..0 } else { pixels };
    pixels.map(move |i| {
        let (x, y) = film.window().position(i);
        match layer {
            0 => (film.sampled(x, y), film.counts[i]),
            _ => (film.splatted(x, y), film.iterations[i]),
        }
    })
}

/// Adds the layer `variance` to a picture of some rows of a film's window, and where light paths have left any light, `light` (which is a
/// part of the picture) and `light_variance`. Adds nothing as long as there are fewer than two batches.
///
/// # Errors
/// When the picture has another size, or has such layers already.
pub fn push_variance(
    picture: &mut Picture,
    rows: Range<usize>,
    film: &Film,
    batches: &BatchMeans,
) -> Result<(), FilmError> {
    let width = film.window().width as usize;
    let pixels = rows.start * width..rows.end * width;
    let Some([camera, light]) = batches.variance(pixels.clone()) else { return Ok(()) };
    picture.push_rgb("variance", &camera)?;
    if !light.is_empty() {
        let splats: Vec<Rgb> = means(film, 1, pixels).map(|(mean, _)| mean).collect();
        picture.push_rgb("light", &splats)?;
        picture.push_rgb("light_variance", &light)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::hash::{hash_words, unit_f32};

    const PIXELS: u32 = 128 * 128;

    /// The estimated variance of each pixel's mean, where samples are uniform in 0..=1.
    fn estimated(ends: &[u32]) -> Vec<f64> {
        let mut film = Film::new(128, 128, 30).unwrap();
        let mut batches = BatchMeans::default();
        for sample in 0..*ends.last().unwrap() {
            for (x, y) in (0..PIXELS).map(|i| (i % 128, i / 128)) {
                let light = unit_f32(hash_words([u64::from(x), u64::from(y), u64::from(sample)]) as u32);
                film.add(x, y, sample, Rgb::grey(light));
            }
            if ends.contains(&(sample + 1)) {
                batches.close(&film, sample + 1);
            }
        }
        let [camera, light] = batches.variance(0..PIXELS as usize).unwrap();
        assert!(light.is_empty());
        camera.iter().map(|v| f64::from(v.g)).collect()
    }

    /// 1/12 over the number of samples, whichever batches they come in.
    #[test]
    fn batches_give_the_variance_of_the_mean() {
        for ends in [&[4, 8][..], &[4, 5], &[8, 14], &[1, 2], &[1, 2, 3, 4], &[1, 2, 3, 4, 6, 8, 11]] {
            let estimates = estimated(ends);
            let mean = estimates.iter().sum::<f64>() / estimates.len() as f64;
            let ratio = mean * 12.0 * f64::from(*ends.last().unwrap());
            // The mean over 16,384 pixels of one squared difference has a standard error of about √2/128.
            assert!((ratio - 1.0).abs() < 0.05, "{ends:?}: {ratio}");
        }
    }

    /// With one difference, a chi-squared variable of one degree of freedom, the relative spread is √2; six batches halve it.
    #[test]
    fn more_batches_spread_less() {
        let spread = |ends: &[u32]| {
            let estimates = estimated(ends);
            let mean = estimates.iter().sum::<f64>() / estimates.len() as f64;
            let square =
                estimates.iter().map(|e| (e - mean) * (e - mean)).sum::<f64>() / estimates.len() as f64;
            square.sqrt() / mean
        };
        assert!(spread(&[4, 8]) > 1.3);
        assert!(spread(&[1, 2, 3, 4, 6, 8]) < 0.75);
    }

    #[test]
    fn one_batch_says_nothing() {
        let mut batches = BatchMeans::default();
        batches.close(&Film::new(1, 1, 0).unwrap(), 1);
        assert_eq!(batches.variance(0..1), None);
    }
}
