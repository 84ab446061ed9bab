//! The variance of each pixel's mean, estimated by batch means [Schmeiser 1982]: the samples are cut into batches, and how far the
//! means of the batches differ says how far the mean of all of them may be off. Denoisers need this estimate.
//!
//! Squares of single samples would overstate the error, since samples are stratified over a pixel: a batch keeps what its
//! stratification gains. The film does not have to store squares, and light paths, which have no samples of a pixel of
//! their own, are treated like camera paths.

use crate::film::Film;
use crate::film::bytes::{Rest, put_counts, put_floats};
use crate::film::error::FilmError;
use bilux_math::Rgb;
use bilux_pictures::Picture;
use std::ops::Range;

/// Factor on the weight of a batch for each batch after it. Later batches are larger, so that their means show more of
/// what stratification gains.
const DECAY: f32 = 0.7;

/// The batches of a film so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BatchMeans {
    /// Samples per pixel in all batches.
    samples: u32,
    /// The sum of the weights of all differences.
    weights: f32,
    /// Light of camera paths, and of light paths.
    layers: [Layer; 2],
}

/// Light of one kind. A large picture holds it while it is rendered, so nothing is stored before it is needed, or after.
#[derive(Clone, Debug, Default, PartialEq)]
struct Layer {
    counts: Counts,
    /// The mean of each pixel; empty once there are no more batches to come.
    means: Vec<Rgb>,
    /// The weighted sum of each pixel's squared differences, each scaled to the variance of one sample; empty up to the second batch.
    squares: Vec<Rgb>,
}

/// Samples in the mean of each pixel.
#[derive(Clone, Debug, PartialEq)]
enum Counts {
    /// One number for every pixel, as long as no sample is bad.
    Same(u32),
    Each(Vec<u32>),
}

impl Default for Counts {
    fn default() -> Counts {
        Counts::Same(0)
    }
}

impl Counts {
    fn of(counts: &[u32]) -> Counts {
        match counts {
            [first, rest @ ..] if rest.iter().any(|count| count != first) => Counts::Each(counts.to_vec()),
            _ => Counts::Same(counts.first().copied().unwrap_or(0)),
        }
    }

    fn at(&self, pixel: usize) -> u32 {
        match self {
            Counts::Same(count) => *count,
            Counts::Each(counts) => counts[pixel],
        }
    }
}

impl Layer {
    /// Adds a batch, given the means of all samples with it and their numbers [Chan 1983].
    fn add(&mut self, means: impl ExactSizeIterator<Item = Rgb>, counts: &[u32]) {
        let counts = Counts::of(counts);
        if self.means.is_empty() {
            self.means.extend(means);
        } else {
            self.squares.resize(means.len(), Rgb::BLACK);
            let sums = self.means.iter_mut().zip(&mut self.squares).enumerate();
            for ((i, (old, squares)), mean) in sums.zip(means) {
                let (before, after) = (self.counts.at(i), counts.at(i));
                let batch = after.saturating_sub(before);
                let scale = if batch > 0 { before as f32 * after as f32 / batch as f32 } else { 0.0 };
                let apart = mean - *old;
                *squares = *squares * DECAY + apart * apart * scale;
                *old = mean;
            }
        }
        self.counts = counts;
    }
}

impl BatchMeans {
    /// True when a batch ends with this many samples per pixel: after each of the first four, and then twice an octave.
    pub fn ends_at(samples: u32) -> bool {
        samples <= 4
            || samples.is_power_of_two()
            || samples.is_multiple_of(3) && (samples / 3).is_power_of_two()
    }

    /// Closes a batch: the film now has this many samples per pixel.
    pub fn close(&mut self, film: &Film, samples: u32) {
        if samples <= self.samples {
            return;
        }
        let is_first = self.samples == 0;
        self.layers[0].add(sampled(film), &film.counts);
        self.layers[1].add(splatted(film), &film.iterations);
        self.weights = if is_first { 0.0 } else { self.weights * DECAY + 1.0 };
        self.samples = samples;
    }

    /// Bytes of memory that the batches take.
    #[cfg(test)]
    fn bytes(&self) -> usize {
        let of_layer = |layer: &Layer| {
            let counts = if let Counts::Each(counts) = &layer.counts { size_of_val(&counts[..]) } else { 0 };
            size_of::<Rgb>() * (layer.means.capacity() + layer.squares.capacity()) + counts
        };
        self.layers.iter().map(of_layer).sum()
    }

    /// Frees what only more batches would need.
    pub(crate) fn finish(&mut self) {
        self.layers.iter_mut().for_each(|layer| layer.means = Vec::new());
    }

    /// The variance of the mean that camera paths give some pixels of the film's window, and of the mean that light paths give, where there are
    /// any. `None` as long as there are fewer than two batches.
    pub fn variance(&self, pixels: Range<usize>) -> Option<[Vec<Rgb>; 2]> {
        (self.weights > 0.0).then(|| {
            [0, 1].map(|layer| {
                let Layer { counts, squares, .. } = &self.layers[layer];
                let share = |i: usize| 1.0 / (self.weights * counts.at(i).max(1) as f32);
                let some = squares.get(pixels.clone()).unwrap_or(&[]);
                pixels.clone().zip(some).map(|(i, squares)| *squares * share(i)).collect()
            })
        })
    }
}

impl BatchMeans {
    /// Appends the batches so far.
    pub(crate) fn put(&self, bytes: &mut Vec<u8>) {
        put_counts(bytes, &[self.samples, self.weights.to_bits()]);
        for Layer { counts, means, squares } in &self.layers {
            match counts {
                Counts::Same(count) => put_counts(bytes, &[0, *count]),
                Counts::Each(counts) => {
                    put_counts(bytes, &[1, counts.len() as u32]);
                    put_counts(bytes, counts);
                }
            }
            for pixels in [means, squares] {
                put_counts(bytes, &[pixels.len() as u32]);
                pixels.iter().for_each(|pixel| put_floats(bytes, &pixel.to_array()));
            }
        }
    }

    /// Reads the batches of a film of so many pixels.
    pub(crate) fn read(rest: &mut Rest, pixels: usize) -> Result<BatchMeans, FilmError> {
        let wrong =
            || FilmError::NotAFilm { what: "its batches of samples are not those of its pixels".to_owned() };
        let [samples, weights] = rest.numbers()?;
        let mut batches = BatchMeans { samples, weights: f32::from_bits(weights), ..BatchMeans::default() };
        for layer in &mut batches.layers {
            let [kind, count] = rest.numbers()?;
            layer.counts = match kind {
                0 => Counts::Same(count),
                1 if count as usize == pixels => {
                    let mut counts = crate::film::zeroed(pixels)?;
                    rest.counts(&mut counts)?;
                    Counts::Each(counts)
                }
                _ => return Err(wrong()),
            };
            for kept in [&mut layer.means, &mut layer.squares] {
                let [length] = rest.numbers()?;
                if length != 0 && length as usize != pixels {
                    return Err(wrong());
                }
                let floats = rest.floats(3 * length as usize)?;
                *kept = floats.as_chunks::<3>().0.iter().map(|rgb| Rgb::from_array(*rgb)).collect();
            }
            if !layer.squares.is_empty() && layer.means.is_empty() {
                return Err(wrong());
            }
        }
        Ok(batches)
    }
}

/// The mean of each pixel's own samples.
fn sampled(film: &Film) -> impl ExactSizeIterator<Item = Rgb> + '_ {
    let place = |i| film.window().position(i);
    (0..film.window().pixels()).map(place).map(|(x, y)| film.sampled(x, y))
}

/// The light of each pixel that light paths have left; nothing where there are no light paths.
fn splatted(film: &Film) -> impl ExactSizeIterator<Item = Rgb> + '_ {
    let place = |i| film.window().position(i);
    (0..film.splats.len()).map(place).map(|(x, y)| film.splatted(x, y))
}

/// Adds the layer `variance` to a picture of a film's window, and where light paths have left any light, `light` (which is a part of
/// the picture) and `light_variance`. Adds nothing as long as there are fewer than two batches.
///
/// # Errors
/// When the picture has another size, or has such layers already.
pub fn push_variance(picture: &mut Picture, film: &Film, batches: &BatchMeans) -> Result<(), FilmError> {
    let pixels = 0..film.window().pixels();
    let Some([camera, light]) = batches.variance(pixels) else { return Ok(()) };
    picture.push_rgb("variance", &camera)?;
    if !light.is_empty() {
        let splats: Vec<Rgb> = splatted(film).collect();
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

    /// The memory of a picture of 1920 × 1080 while it is rendered depends on this.
    #[test]
    fn only_what_is_needed_is_stored() {
        let mut film = Film::new(8, 8, 20).unwrap();
        film.make_room_for_splats().unwrap();
        let mut batches = BatchMeans::default();
        let mut take = |batches: &mut BatchMeans, samples: u32| {
            film.counts.fill(samples);
            film.iterations.fill(samples);
            batches.close(&film, samples);
            batches.bytes()
        };
        let both_layers = 2 * 64 * size_of::<Rgb>();
        assert_eq!(take(&mut batches, 1), both_layers);
        assert_eq!([2, 3, 4].map(|samples| take(&mut batches, samples)), [2 * both_layers; 3]);
        batches.finish();
        assert_eq!(batches.bytes(), both_layers);
        assert!(batches.variance(0..64).is_some());
        // One batch says nothing, so it leaves nothing.
        let mut one = BatchMeans::default();
        take(&mut one, 1);
        one.finish();
        assert_eq!((one.bytes(), one.variance(0..64)), (0, None));
    }

    /// A bad sample makes the numbers of samples differ.
    #[test]
    fn a_bad_sample_does_not_count() {
        let film = |bad: Option<u32>, samples: u32| {
            let mut film = Film::new(2, 1, 20).unwrap();
            for sample in 0..samples {
                let light = Rgb::grey(if bad == Some(sample) { f32::NAN } else { sample as f32 });
                film.add(0, 0, sample, light);
                film.add(1, 0, sample, Rgb::grey(sample as f32));
            }
            film
        };
        let variances = |bad| {
            let mut batches = BatchMeans::default();
            [2, 5].into_iter().for_each(|samples| batches.close(&film(bad, samples), samples));
            batches.finish();
            batches.variance(0..2).unwrap()[0].iter().map(|v| v.g).collect::<Vec<_>>()
        };
        // The mean of 0 and 1 is 0.5; of 0 to 4 it is 2, with or without 2, and 1.75 without 3.
        let expected =
            |mean: f32, count: f32| (mean - 0.5) * (mean - 0.5) * 2.0 * count / (count - 2.0) / count;
        for (bad, mean, count) in [(None, 2.0, 5.0), (Some(2), 2.0, 4.0), (Some(3), 1.75, 4.0)] {
            let found = variances(bad);
            assert!((found[0] - expected(mean, count)).abs() < 1e-4, "{bad:?}: {found:?}");
            assert!((found[1] - expected(2.0, 5.0)).abs() < 1e-4, "{bad:?}: {found:?}");
        }
    }
}
