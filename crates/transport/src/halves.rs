//! How far a picture's pixels may be off, estimated from its two halves: its first samples against the later ones.
//! Denoisers use this estimate.

use crate::error::FilmError;
use crate::film::Film;
use bilux_math::Rgb;
use bilux_pictures::Picture;
use std::ops::Range;

/// The film's window after its first samples: the light of camera subpaths, and splats.
#[derive(Clone, Debug, PartialEq)]
pub struct FirstHalf {
    /// Samples per pixel at that time: half of the total, or somewhat more where noise or time ended the picture.
    pub samples: u32,
    layers: [Vec<Rgb>; 2],
}

impl FirstHalf {
    pub(crate) fn of(film: &Film, samples: u32) -> FirstHalf {
        FirstHalf { samples, layers: layers(film, 0..film.window().pixels()) }
    }

    /// For some of the window's pixels, the variance of each pixel's mean over camera subpaths, and that of its splats,
    /// where there are any.
    ///
    /// Of n samples of variance σ², the mean of the first m and that of the others differ by σ² n / (m (n - m)) in the
    /// square, on average. A single difference says little about one pixel: neighbours are needed too.
    pub fn variance(&self, film: &Film, pixels: Range<usize>) -> [Vec<Rgb>; 2] {
        let mut now = layers(film, pixels.clone());
        for (layer, counts) in [&film.counts, &film.iterations].into_iter().enumerate() {
            for (now, i) in now[layer].iter_mut().zip(pixels.clone()) {
                *now = squared(*now - self.layers[layer][i], counts[i], self.samples);
            }
        }
        now
    }
}

/// The mean of the first m differs from that of all n by (n - m)/n of the difference between the two halves.
fn squared(apart: Rgb, n: u32, m: u32) -> Rgb {
    let scale = if n > m { m as f32 / (n - m) as f32 } else { 0.0 };
    apart * apart * scale
}

/// The light of camera subpaths and, where there are any, splats.
fn layers(film: &Film, pixels: Range<usize>) -> [Vec<Rgb>; 2] {
    let window = film.window();
    let places = || pixels.clone().map(|i| window.position(i));
    [places().map(|(x, y)| film.sampled(x, y)).collect(), splats(film, pixels.clone())]
}

/// The splats; empty where there are none.
fn splats(film: &Film, pixels: Range<usize>) -> Vec<Rgb> {
    if film.splats.is_empty() {
        return Vec::new();
    }
    pixels.map(|i| film.window().position(i)).map(|(x, y)| film.splatted(x, y)).collect()
}

/// Adds the layer `variance` to a picture of some rows of a film's window, and where there are splats, `light` (a part
/// of the picture's light) and `light_variance`.
///
/// # Errors
/// When the picture has a different size, or already has such layers.
pub fn push_variance(
    picture: &mut Picture,
    rows: Range<usize>,
    film: &Film,
    first: &FirstHalf,
) -> Result<(), FilmError> {
    let width = film.window().width as usize;
    let pixels = rows.start * width..rows.end * width;
    let [camera, light] = first.variance(film, pixels.clone());
    picture.push_rgb("variance", &camera)?;
    if !light.is_empty() {
        picture.push_rgb("light", &splats(film, pixels))?;
        picture.push_rgb("light_variance", &light)?;
    }
    Ok(())
}

/// The film at the last two powers of 2: one of them is half of the final number of samples.
#[derive(Default)]
pub(crate) struct Halves([Option<FirstHalf>; 2]);

impl Halves {
    /// Records a film that has this many samples.
    pub(crate) fn look(&mut self, film: &Film, samples: u32) {
        // Drops the older one before storing another.
        self.0[0] = self.0[1].take();
        self.0[1] = Some(FirstHalf::of(film, samples));
    }

    /// The latest one with fewer samples than this.
    pub(crate) fn before(self, samples: u32) -> Option<FirstHalf> {
        self.0.into_iter().rev().flatten().find(|half| half.samples < samples)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::hash::{hash_words, unit_f32};

    /// Mean of the estimates over many pixels whose samples are uniform in 0..=1: 1/12 over their number.
    fn estimated(first: u32, all: u32) -> f64 {
        let mut film = Film::new(128, 128, 30).unwrap();
        let mut half = None;
        for sample in 0..all {
            if sample == first {
                half = Some(FirstHalf::of(&film, first));
            }
            for (x, y) in (0..128 * 128).map(|i| (i % 128, i / 128)) {
                let light = unit_f32(hash_words([u64::from(x), u64::from(y), u64::from(sample)]) as u32);
                film.add(x, y, sample, Rgb::grey(light));
            }
        }
        let [camera, light] = half.unwrap().variance(&film, 0..128 * 128);
        assert!(light.is_empty());
        camera.iter().map(|v| f64::from(v.g)).sum::<f64>() / camera.len() as f64
    }

    #[test]
    fn halves_tell_the_variance_of_the_mean_whichever_is_longer() {
        for (first, all) in [(4, 8), (4, 5), (8, 14), (1, 2)] {
            let ratio = estimated(first, all) * 12.0 * f64::from(all);
            // 16,384 squares of one difference each: a standard error of about √2/128.
            assert!((ratio - 1.0).abs() < 0.05, "{first} of {all}: {ratio}");
        }
    }

    #[test]
    fn the_latest_half_that_is_one_is_kept() {
        let film = Film::new(1, 1, 0).unwrap();
        let after = |looks: &[u32], done| {
            let mut halves = Halves::default();
            looks.iter().for_each(|&n| halves.look(&film, n));
            halves.before(done).map(|half| half.samples)
        };
        assert_eq!(after(&[1, 2, 4, 8], 8), Some(4));
        assert_eq!(after(&[1, 2, 4, 8], 10), Some(8));
        assert_eq!(after(&[1], 1), None);
    }
}
