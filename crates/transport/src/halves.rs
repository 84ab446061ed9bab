//! How far a picture's pixels may be off, as told by its two halves: what its first samples say against what the later ones
//! say. Denoisers go by it.

use crate::error::FilmError;
use crate::film::Film;
use bilux_math::Rgb;
use bilux_pictures::Picture;
use std::ops::Range;

/// The film's window when it had its first samples: what camera paths have brought, and what light paths have left.
#[derive(Clone, Debug, PartialEq)]
pub struct FirstHalf {
    /// Of each pixel, so far: half of all of them, or somewhat more where noise or time ended the picture.
    pub samples: u32,
    layers: [Vec<Rgb>; 2],
}

impl FirstHalf {
    pub(crate) fn of(film: &Film, samples: u32) -> FirstHalf {
        FirstHalf { samples, layers: layers(film, 0..film.window().pixels()) }
    }

    /// The variance of each pixel's mean by camera paths, and of that by light paths, where there are any; of some of the
    /// window's pixels. Of n samples of variance σ² the first m and the others differ by σ² n / (m (n - m)) in the square, on average. One
    /// difference tells little of one pixel: neighbours are to be asked too.
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

/// From the mean of all n, that of the first m differs by (n - m)/n of what the two halves differ by.
fn squared(apart: Rgb, n: u32, m: u32) -> Rgb {
    let scale = if n > m { m as f32 / (n - m) as f32 } else { 0.0 };
    apart * apart * scale
}

/// What camera paths have brought and, where there are any, what light paths have left.
fn layers(film: &Film, pixels: Range<usize>) -> [Vec<Rgb>; 2] {
    let window = film.window();
    let places = || pixels.clone().map(|i| window.position(i));
    [places().map(|(x, y)| film.sampled(x, y)).collect(), splats(film, pixels.clone())]
}

/// What light paths have left; nothing where there are none.
fn splats(film: &Film, pixels: Range<usize>) -> Vec<Rgb> {
    if film.splats.is_empty() {
        return Vec::new();
    }
    pixels.map(|i| film.window().position(i)).map(|(x, y)| film.splatted(x, y)).collect()
}

/// Adds the layer `variance` to a picture of some rows of a film's window, and where light paths have left any, `light` (which is a part
/// of the picture) and `light_variance`.
///
/// # Errors
/// When the picture has another size, or such layers already.
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

/// The film at the last two powers of 2: one of them is half of what there is in the end.
#[derive(Default)]
pub(crate) struct Halves([Option<FirstHalf>; 2]);

impl Halves {
    /// Looks at a film that has so many samples.
    pub(crate) fn look(&mut self, film: &Film, samples: u32) {
        // The older one makes room before there is another.
        self.0[0] = self.0[1].take();
        self.0[1] = Some(FirstHalf::of(film, samples));
    }

    /// The latest that has fewer than these.
    pub(crate) fn before(self, samples: u32) -> Option<FirstHalf> {
        self.0.into_iter().rev().flatten().find(|half| half.samples < samples)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::hash::{hash_words, unit_f32};

    /// Mean of the estimates over many pixels whose samples are even in 0..=1: 1/12 over their number.
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
