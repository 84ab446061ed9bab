//! What is derived from a render besides its light: layers, and the denoised picture.

use crate::settings::Settings;
use crate::{Denoised, Error, Job, JobRequest, Outcome};
use bilux_math::Rgb;
use bilux_pictures::denoise::{DenoiserChoice, Layer, Noisy, Source, Task, denoiser, repainted};
use bilux_pictures::{Picture, PictureError};
use bilux_transport::aovs::Aov;
use bilux_transport::{Film, push_variance};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;

/// The value of the setting `denoise` that lets the kind of picture decide.
const FOR_DISPLAY: &str = "display";

impl JobRequest {
    /// The denoiser that the picture is to have, if any: the one that the setting `denoise` names, or, if the setting leaves
    /// it open, the best one for pictures for a display that noise or time ends.
    pub(crate) fn denoiser_name<'a>(&self, settings: &'a Settings) -> Option<&'a str> {
        let is_open = settings.denoise == FOR_DISPLAY;
        match self.denoised {
            Denoised::No => None,
            _ if settings.denoise == "off" => None,
            Denoised::ForDisplay if is_open => settings.stop.is_any().then_some("auto"),
            Denoised::IfAsked if is_open => None,
            Denoised::IfAsked | Denoised::ForDisplay => Some(&settings.denoise),
        }
    }
}

impl Job {
    /// What denoises the picture, if anything does ([`JobRequest::denoised`]).
    ///
    /// # Errors
    /// If the denoiser that was asked for is not available.
    pub fn denoiser(&self) -> Result<Option<&Arc<DenoiserChoice>>, Error> {
        if let (None, Some(name)) = (self.known.denoiser.get(), self.request.denoiser_name(&self.settings)) {
            let task = Task {
                size: (self.render.width as usize, self.render.height as usize),
                threads: self.settings.threads,
                // Any more of it is better spent on samples.
                time: self.render.stop.time_limit.map(|limit| limit / 4),
                sandboxed: self.request.sandboxed,
            };
            // Another thread may have been faster, with the same result.
            let _ = self.known.denoiser.set(Some(Arc::new(denoiser(name, &task)?)));
        }
        Ok(self.known.denoiser.get().and_then(Option::as_ref))
    }

    /// The time set aside for denoising.
    pub(crate) fn denoising_time(&self) -> Result<Duration, Error> {
        Ok(self.denoiser()?.map_or(Duration::ZERO, |chosen| chosen.time))
    }

    /// Whether albedo and the like are wanted.
    pub(crate) fn keeps_features(&self) -> bool {
        let is_kept = |aov: &Aov| aov.is_feature() || *aov == Aov::Guides;
        self.request.layers.iter().any(is_kept) || self.request.denoiser_name(&self.settings).is_some()
    }
}

impl Outcome {
    /// The picture with the layers that are wanted and were kept ([`JobRequest::layers`]).
    ///
    /// # Errors
    /// If memory is short.
    pub fn layered(&self, wanted: &[Aov]) -> Result<Picture, Error> {
        let mut picture = self.picture()?;
        self.push_layers(&mut picture, wanted)?;
        Ok(picture)
    }

    /// Adds layers to a picture of the film's window.
    ///
    /// # Errors
    /// If memory is short, or the picture already has such layers.
    pub fn push_layers(&self, picture: &mut Picture, wanted: &[Aov]) -> Result<(), Error> {
        if let Some(features) = &self.features {
            let wants = |layer: &str| wanted.iter().any(|aov| aov.layer() == Some(layer));
            features.push_layers(picture, wants)?;
            if let Some(coverage) = self.model_coverage.as_ref().filter(|_| wanted.contains(&Aov::Guides)) {
                picture.push_channel("guides.A", coverage.clone())?;
            }
        }
        if let Some(batches) = self.rendered.batch_means.as_ref().filter(|_| wanted.contains(&Aov::Variance))
        {
            push_variance(picture, &self.rendered.film, batches)?;
        }
        Ok(())
    }

    /// The denoised picture, without layers.
    ///
    /// # Errors
    /// If memory is short, or the denoiser fails.
    pub fn denoised(&self, chosen: &DenoiserChoice) -> Result<Picture, Error> {
        let smooth = chosen.denoiser.denoise(self)?;
        Ok(self.encoded(repainted(self.light()?, &smooth)))
    }
}

impl Source for Outcome {
    fn size(&self) -> (usize, usize) {
        let window = self.rendered.film.window();
        (window.width as usize, window.height as usize)
    }

    fn rows(&self, rows: Range<usize>) -> Result<Noisy, PictureError> {
        let window = self.rendered.film.window();
        let (width, height) = (window.width as usize, rows.len());
        let pixels = rows.start * width..rows.end * width;
        let light = |of: fn(&Film, u32, u32) -> Rgb| {
            let places = pixels.clone().into_par_iter().map(|i| window.position(i));
            places.map(|(x, y)| of(&self.rendered.film, x, y)).collect()
        };
        let [camera, light_paths] =
            match self.rendered.batch_means.as_ref().and_then(|b| b.variance(pixels.clone())) {
                Some(variances) => variances.map(Some),
                None => [None, None],
            };
        let mut layers = vec![Layer { colour: light(Film::pixel), variance: camera }];
        if light_paths.as_ref().is_some_and(|variance| !variance.is_empty()) {
            layers.push(Layer { colour: light(Film::splatted), variance: light_paths });
        }
        let features = self.features.as_ref();
        let coverage = self.model_coverage.as_ref().or(self.coverage.as_ref());
        let (albedo, normal) =
            features.map(|features| features.guides(coverage.is_some(), pixels.clone())).unzip();
        let noisy = Noisy {
            width,
            height,
            layers,
            coverage: coverage.map(|coverage| coverage[pixels.clone()].to_vec()),
            albedo,
            normal,
            depth: features.map(|features| features.mean_depth[pixels.clone()].to_vec()),
            haze: features.and_then(|features| features.haze(coverage.is_some(), pixels)),
        };
        Ok(noisy.separated())
    }
}
