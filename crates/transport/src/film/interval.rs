//! The 95% confidence interval of a pixel's light, by Student's t. [Student 1908]
//!
//! Samples of one sequence are evenly distributed, each where the others are not, so their variance says little about
//! the error of their mean. Where an interval is wanted, samples are taken in turn from [`REPLICATES`] sequences that
//! are scrambled independently: the sequences' means *are* independent, and their spread gives the error of the overall
//! mean, with whatever even distribution gains within each. [Owen 1997] Splats belong to the replicate of their
//! iteration, as camera subpaths do, so a pixel's interval covers all of its light; what pixels have in common shows in
//! the interval of a block.

use crate::film::bytes::{Rest, put_counts, put_floats};
use crate::film::error::FilmError;
use crate::film::window::Window;
use crate::film::{Film, zeroed};
use bilux_math::Rgb;
use bilux_math::hash::hash_words;
use bilux_pictures::Picture;

/// Number of sample sequences that are scrambled independently. Sample `i` is number `i / REPLICATES` of sequence
/// `i % REPLICATES`, so a range of samples does not depend on any other.
pub const REPLICATES: u32 = 8;

const COUNT: usize = REPLICATES as usize;

/// Half-width of a 95% interval in standard errors, by degrees of freedom from 1 on. [Student 1908]
const QUANTILES: [f64; COUNT - 1] =
    [12.706_205, 4.302_653, 3.182_446, 2.776_445, 2.570_582, 2.446_912, 2.364_624];

/// Half-width of an interval in standard errors, by its degrees of freedom; infinite for none.
pub(crate) fn quantile(degrees_of_freedom: u32) -> f64 {
    degrees_of_freedom.checked_sub(1).map_or(f64::INFINITY, |i| QUANTILES[i as usize])
}

/// The seed of a sample's sequence, and the sample's index there.
#[inline]
pub(crate) fn replicate(seed: u64, sample: u32) -> (u64, u32) {
    const KEY: u64 = 0x7265_706c_6963_6174;
    (hash_words([seed ^ KEY, u64::from(sample % REPLICATES)]), sample / REPLICATES)
}

/// The light of each replicate, and the intervals that follow from it.
#[derive(Clone, Debug, PartialEq)]
pub struct Interval {
    window: Window,
    /// Samples per pixel in each replicate.
    counts: [u32; COUNT],
    /// The mean light of each replicate, pixel by pixel. A running mean stays exact where a sum would lose values much
    /// smaller than itself.
    means: Vec<[[f32; 3]; COUNT]>,
}

/// A mean, and the half-width of its interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The mean.
    pub mean: f64,
    /// Half-width of the 95% interval.
    pub half_width: f64,
}

impl Interval {
    pub(crate) fn new(window: Window) -> Result<Interval, FilmError> {
        Ok(Interval { window, counts: [0; COUNT], means: zeroed(window.pixels())? })
    }

    /// Bytes of memory that the intervals of this many pixels take during rendering.
    pub const fn memory_bytes(pixels: u64) -> u64 {
        pixels.saturating_mul(size_of::<[[f32; 3]; COUNT]>() as u64)
    }

    /// Adds one sample of every pixel, which is all that the film holds. Light that is not finite counts as black,
    /// which makes the interval wider.
    pub(crate) fn add(&mut self, sample: u32, film: &Film) {
        let replicate = (sample % REPLICATES) as usize;
        self.counts[replicate] += 1;
        let share = 1.0 / self.counts[replicate] as f32;
        for (i, means) in self.means.iter_mut().enumerate() {
            let (x, y) = self.window.position(i);
            let light = Some(film.pixel(x, y)).filter(|light| light.is_finite()).unwrap_or(Rgb::BLACK);
            for (mean, light) in means[replicate].iter_mut().zip(light.to_array()) {
                *mean += (light - *mean) * share;
            }
        }
    }

    /// Appends the replicates so far.
    pub(crate) fn put(&self, bytes: &mut Vec<u8>) {
        put_counts(bytes, &self.counts);
        self.means.iter().for_each(|means| put_floats(bytes, means.as_flattened()));
    }

    /// Reads the replicates of the pixels of a window.
    pub(crate) fn read(rest: &mut Rest, window: Window) -> Result<Interval, FilmError> {
        let counts = rest.numbers()?;
        let floats = rest.floats(window.pixels().saturating_mul(3 * COUNT))?;
        let pixels = floats.as_chunks::<3>().0.as_chunks::<COUNT>().0;
        Ok(Interval { window, counts, means: pixels.to_vec() })
    }

    /// The pixels that have an interval.
    pub fn window(&self) -> Window {
        self.window
    }

    /// Samples per pixel.
    pub fn samples(&self) -> u32 {
        self.counts.iter().sum()
    }

    /// One less than the number of replicates with samples.
    pub fn degrees_of_freedom(&self) -> u32 {
        (self.counts.iter().filter(|&&count| count > 0).count() as u32).saturating_sub(1)
    }

    /// Half-width of an interval in standard errors; infinite where there is only one sample.
    pub fn quantile(&self) -> f64 {
        quantile(self.degrees_of_freedom())
    }

    /// The mean luminance of a block of one or more pixels, and its interval: what pixels have in common (a light path
    /// that several of them see) does not average out, and is included.
    pub fn luminance(&self, block: &Window) -> Estimate {
        self.estimate(block, |light| f64::from(Rgb::from_array(light).luminance()))
    }

    /// Mean red, green or blue of a block, and its interval: `channel` 0, 1 or 2.
    pub fn channel(&self, block: &Window, channel: usize) -> Estimate {
        self.estimate(block, |light| f64::from(light[channel]))
    }

    /// Mean value of a block, and its interval. Where replicates have different numbers of samples n, the variance of a mean is
    /// assumed to be σ²/n.
    fn estimate(&self, block: &Window, value: impl Fn([f32; 3]) -> f64) -> Estimate {
        let block = block.intersection(&self.window);
        let mut means = [0.0; COUNT];
        for (x, y) in (0..block.pixels()).map(|i| block.position(i)) {
            let Some(index) = self.window.index(x, y) else { continue };
            for (mean, light) in means.iter_mut().zip(self.means[index]) {
                *mean += value(light) / block.pixels() as f64;
            }
        }
        let (samples, freedom) = (f64::from(self.samples().max(1)), self.degrees_of_freedom());
        let replicates = || means.iter().zip(self.counts).map(|(mean, count)| (mean, f64::from(count)));
        let mean = replicates().map(|(mean, count)| mean * count).sum::<f64>() / samples;
        if freedom == 0 {
            return Estimate { mean, half_width: f64::INFINITY };
        }
        let squares = replicates().map(|(own, count)| count * (own - mean) * (own - mean)).sum::<f64>();
        let error = (squares / (f64::from(freedom) * samples)).sqrt();
        Estimate { mean, half_width: self.quantile() * error }
    }

    /// The half-widths of the pixels' intervals as a linear picture of the window: red, green, blue, and luminance as
    /// an extra channel.
    ///
    /// # Errors
    /// When there is not enough memory.
    pub fn to_picture(&self) -> Result<Picture, FilmError> {
        let pixels = || (0..self.window.pixels()).map(|i| self.window.position(i)).map(Window::pixel);
        let half = |estimate: Estimate| estimate.half_width as f32;
        let colour = pixels().map(|at| Rgb::from_array([0, 1, 2].map(|c| half(self.channel(&at, c)))));
        let (width, height) = (self.window.width as usize, self.window.height as usize);
        let mut picture = Picture::from_rgb(width, height, colour.collect())?;
        picture.push_channel("luminance", pixels().map(|at| half(self.luminance(&at))).collect())?;
        let mut note =
            |key: &str, value: String| picture.metadata.insert(format!("bilux.interval.{key}"), value);
        note("confidence", "0.95".to_owned());
        note("half_width_in_standard_errors", self.quantile().to_string());
        note("degrees_of_freedom", self.degrees_of_freedom().to_string());
        note("samples", self.samples().to_string());
        Ok(picture)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::distribution::{ContinuousCDF, StudentsT};

    #[test]
    fn quantiles_are_those_of_students_t() {
        for (i, quantile) in QUANTILES.into_iter().enumerate() {
            let inside = 1.0 - 2.0 * StudentsT::new(0.0, 1.0, i as f64 + 1.0).unwrap().sf(quantile);
            assert!((inside - 0.95).abs() < 1e-6, "{quantile}: {inside}");
        }
    }

    fn film(values: [f32; 2]) -> Film {
        let mut film = Film::new(2, 1, 30).unwrap();
        (0..2).for_each(|x| film.add(x, 0, 0, Rgb::grey(values[x as usize])));
        film
    }

    #[test]
    fn the_standard_error_of_two_samples_is_half_their_difference() {
        let mut interval = Interval::new(Window::whole(2, 1)).unwrap();
        interval.add(0, &film([1.0, 3.0]));
        assert_eq!(interval.channel(&Window::whole(2, 1), 1).half_width, f64::INFINITY);
        interval.add(1, &film([2.0, 2.0]));
        let left = interval.channel(&Window::pixel((0, 0)), 0);
        assert_eq!((left.mean, left.half_width), (1.5, 0.5 * QUANTILES[0]));
        // What one pixel gains the other loses: their mean is certain.
        let both = interval.channel(&Window::whole(2, 1), 2);
        assert_eq!((both.mean, both.half_width), (2.0, 0.0));
    }

    #[test]
    fn a_nan_sample_widens_the_interval() {
        let mut interval = Interval::new(Window::whole(2, 1)).unwrap();
        for sample in 0..REPLICATES {
            interval.add(sample, &film([1.0, if sample == 3 { f32::NAN } else { 1.0 }]));
        }
        let [sound, bad] = [0, 1].map(|x| interval.channel(&Window::pixel((x, 0)), 0).half_width);
        assert!(sound == 0.0 && bad > 0.1, "{sound} {bad}");
    }
}
