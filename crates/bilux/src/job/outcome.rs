//! The result of a render, and its pictures.

use crate::Error;
use bilux_math::Rgb;
use bilux_pictures::Picture;
use bilux_pictures::denoise::repainted;
use bilux_transport::{Completion, Features, Reached, Rendered};
use std::time::Duration;

/// Features and labels of the visible surfaces, as far as asked for ([`layers`](crate::JobRequest::layers)).
#[derive(Clone, Default)]
pub struct Surfaces {
    /// Means over samples.
    pub features: Option<Features>,
    /// Labels: channels of a picture of the film's window, and the names of their numbers as its metadata.
    pub labels: Option<Picture>,
    /// The time that they took.
    pub time: Duration,
}

/// Outcome of a render, with whatever else the picture needs.
#[derive(Clone)]
pub struct Outcome {
    /// The render: the film, the work that it took, how far it got.
    pub rendered: Rendered,
    /// Features and labels of the visible surfaces.
    pub surfaces: Surfaces,
    /// The alpha of each pixel, in rows of the film's window, if the picture has an alpha channel.
    pub coverage: Option<Vec<f32>>,
    /// The fraction of each pixel that shows the model, if alpha has the shadow on an invisible ground besides.
    pub(crate) model_coverage: Option<Vec<f32>>,
    pub(crate) linear_transfer: bool,
}

impl Outcome {
    /// The picture so far; for a crop, only its window.
    ///
    /// # Errors
    /// If memory is short.
    pub fn picture(&self) -> Result<Picture, Error> {
        Ok(self.encoded(self.light()?))
    }

    /// The number of samples that each pixel has; their mean where not all have the same, as in a picture that was
    /// interrupted.
    pub fn samples_per_pixel(&self) -> f64 {
        let film = &self.rendered.film;
        if self.rendered.spacing.is_some() {
            let samples: u64 = film.counts().iter().map(|count| u64::from(*count)).sum();
            return samples as f64 / film.window().pixels() as f64;
        }
        let pieces = film.coverage().pieces().iter();
        let samples = pieces.map(|(window, samples)| window.pixels() as u64 * samples.len() as u64);
        samples.sum::<u64>() as f64 / film.window().pixels() as f64
    }

    /// Completion of a picture that time ended within its first pass, from the pixels that have a sample.
    pub(crate) fn completion(&self) -> Option<Completion<'_>> {
        let spacing = self.rendered.spacing?;
        Some(Completion::new(&self.rendered.film, spacing, self.surfaces.features.as_ref()))
    }

    /// The light in the film's window.
    pub(crate) fn light(&self) -> Result<Picture, Error> {
        let completion = self.completion();
        let completed = completion.map(|completion| completion.completed(&completion.light)).transpose()?;
        self.painted(completed.as_deref())
    }

    /// The picture of the film's window, with other light if that is given.
    pub(crate) fn painted(&self, light: Option<&[Rgb]>) -> Result<Picture, Error> {
        let film = &self.rendered.film;
        let mut picture = film.window_to_picture(film.window())?;
        if let Some(light) = light {
            picture = repainted(picture, light);
        }
        if let Some(coverage) = &self.coverage {
            picture.push_channel("A", coverage.clone())?;
        }
        self.record_stop(&mut picture);
        Ok(picture)
    }

    /// The picture in the colour space in which it is written.
    pub(crate) fn encoded(&self, mut picture: Picture) -> Picture {
        if self.linear_transfer {
            // Marked as already encoded, its samples become bytes unchanged.
            picture.colour_space = bilux_pictures::ColourSpace::Srgb;
        }
        picture
    }

    /// Records in the picture's metadata how the stopping rule affected it.
    fn record_stop(&self, picture: &mut Picture) {
        let Some(Reached { spp, noise: Some(noise), bias: Some(bias) }) = self.rendered.reached else {
            return;
        };
        let mut note = |key: &str, value: String| picture.metadata.insert(format!("bilux.noise{key}"), value);
        note("", noise.to_string());
        note(".samples", spp.to_string());
        note(".noise_samples", "in the mean".to_owned());
        note(".bias_at_most", format!("{bias} standard errors of a pixel, root mean square"));
    }
}
