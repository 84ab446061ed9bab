//! Merges the layers of a picture's parts, as their films are merged.

use crate::film::Film;
use crate::film::aovs::Aov;
use crate::film::error::FilmError;
use bilux_pictures::Picture;
use std::collections::BTreeMap;

/// Fraction of a pixel that is not background.
const COVERAGE: &str = "A";
/// The number of samples of each pixel, which are added.
const SAMPLES: &str = "samples.count";
/// The variance of a pixel's mean, which falls as samples are merged.
const VARIANCE: &str = "variance.";

/// The merged layers of all parts, by name.
#[derive(Default)]
pub struct MergedLayers {
    /// Values for each pixel of the whole film.
    floats: BTreeMap<String, Vec<f32>>,
    integers: BTreeMap<String, Vec<u32>>,
    /// Samples of each pixel in the parts so far.
    samples: Vec<u32>,
    has_samples: bool,
    left_out: bool,
}

impl MergedLayers {
    /// Adds the layers of a part; `film` holds its light.
    pub fn add(&mut self, part: &Picture, film: &Film) {
        let (window, size) = (film.window(), film.width() as usize * film.height() as usize);
        let whole = |i: usize| {
            let (x, y) = window.position(i);
            y as usize * film.width() as usize + x as usize
        };
        // Splats belong to the whole film: their layers cannot be divided by pixels.
        let has_light = part.channel("light.R").is_some();
        self.left_out |= has_light;
        self.samples.resize(size, 0);
        for channel in part.channels() {
            let name = channel.name.as_str();
            let is_even = is_even(name);
            self.has_samples |= name == SAMPLES;
            if !is_even && (has_light || !name.starts_with(VARIANCE)) {
                continue;
            }
            let kept = self.floats.entry(name.to_owned()).or_insert_with(|| vec![0.0; size]);
            for (i, &sample) in channel.samples.iter().enumerate() {
                let at = whole(i);
                if is_even {
                    kept[at] = sample;
                    continue;
                }
                // The variance of a mean of means, each weighted by its share of the samples.
                let (x, y) = window.position(i);
                let (before, new) = (self.samples[at] as f32, film.samples(x, y) as f32);
                let all = (before + new).max(1.0);
                let (old, new) = (before / all, new / all);
                kept[at] = kept[at] * old * old + sample * new * new;
            }
        }
        for plane in part.integer_planes().iter().filter(|plane| is_even(&plane.name)) {
            let kept = self.integers.entry(plane.name.clone()).or_insert_with(|| vec![0; size]);
            plane.samples.iter().enumerate().for_each(|(i, &id)| kept[whole(i)] = id);
        }
        for i in 0..window.pixels() {
            let (x, y) = window.position(i);
            self.samples[whole(i)] += film.samples(x, y);
        }
    }

    /// True where parts had layers that cannot be merged.
    pub fn left_out(&self) -> bool {
        self.left_out
    }

    /// Adds the layers to a picture of a film's window.
    ///
    /// # Errors
    /// When the picture has a different size, or already has such layers.
    pub fn push(&self, picture: &mut Picture, film: &Film) -> Result<(), FilmError> {
        for (name, kept) in &self.floats {
            picture.push_channel(name.as_str(), places(film).map(|at| kept[at]).collect())?;
        }
        if self.has_samples {
            picture.push_channel(SAMPLES, places(film).map(|at| self.samples[at] as f32).collect())?;
        }
        for (name, kept) in &self.integers {
            picture.push_integer_plane(name.as_str(), places(film).map(|at| kept[at]).collect())?;
        }
        Ok(())
    }

    /// Adds only the coverage, if the parts have one: all that a format for a display can hold.
    ///
    /// # Errors
    /// As for [`MergedLayers::push`], of a picture of the whole film.
    pub fn push_coverage(&self, picture: &mut Picture) -> Result<(), FilmError> {
        if let Some(kept) = self.floats.get(COVERAGE) {
            picture.push_channel(COVERAGE, kept.clone())?;
        }
        Ok(())
    }
}

/// True for a channel whose values are the same in every part that has the pixel: the coverage, and those of all AOVs but the
/// few that are merged in a way of their own.
fn is_even(name: &str) -> bool {
    let is_of = |aov: Aov| {
        let rest = aov.layer().and_then(|layer| name.strip_prefix(layer));
        // As in "depth.Z", "group_lamp.R" and "CryptoObject00.red".
        rest.is_some_and(|rest| rest.starts_with(|c: char| c == '.' || c == '_' || c.is_ascii_digit()))
    };
    let is_even = |aov: &Aov| !matches!(aov, Aov::Samples | Aov::Variance);
    name == COVERAGE || Aov::layers().filter(is_even).any(is_of)
}

/// Places of the pixels of a film's window in the rows of the whole film.
fn places(film: &Film) -> impl Iterator<Item = usize> {
    let (window, width) = (film.window(), film.width() as usize);
    (0..window.pixels()).map(move |i| {
        let (x, y) = window.position(i);
        y as usize * width + x as usize
    })
}
