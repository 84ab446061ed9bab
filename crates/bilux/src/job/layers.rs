//! Products of a render besides its light: layers, and the denoised picture.

use crate::job::labels;
use crate::{Error, Outcome};
use bilux_math::Rgb;
use bilux_math::parallel::table;
use bilux_pictures::denoise::{DenoiserChoice, Layer, Noisy, Source, repainted};
use bilux_pictures::{Picture, PictureError};
use bilux_transport::aovs::Aov;
use bilux_transport::{Completion, Film, push_variance};
use std::ops::Range;

impl Outcome {
    /// The picture with the layers that are wanted and were kept ([`JobRequest::layers`](crate::JobRequest::layers)).
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
        if let Some(features) = &self.surfaces.features {
            let wants = |layer: &str| wanted.iter().any(|aov| aov.layer() == Some(layer));
            features.push_layers(picture, wants)?;
            if let Some(coverage) = self.model_coverage.as_ref().filter(|_| wanted.contains(&Aov::Guides)) {
                picture.push_channel("guides.A", coverage.clone())?;
            }
        }
        if let Some(own) = &self.surfaces.labels {
            labels::push(own, wanted, picture)?;
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
        let Some(completion) = self.completion() else {
            let smooth = chosen.denoiser.denoise(self)?;
            return Ok(self.encoded(repainted(self.light()?, &smooth)));
        };
        let coverage = self.model_coverage.as_ref().or(self.coverage.as_ref());
        let coverage = coverage.map(|coverage| completion.means(coverage));
        let smooth = chosen.denoiser.denoise(&Points { completion: &completion, coverage })?;
        Ok(self.encoded(self.painted(Some(&completion.completed(&smooth)?))?))
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
            table(pixels.len(), width, |i| {
                let (x, y) = window.position(pixels.start + i);
                of(&self.rendered.film, x, y)
            })
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
        let features = self.surfaces.features.as_ref();
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

/// The points of a lattice from which a picture is completed, as a picture of their own.
struct Points<'a> {
    completion: &'a Completion<'a>,
    coverage: Option<Vec<f32>>,
}

impl Source for Points<'_> {
    fn size(&self) -> (usize, usize) {
        let [width, height] = self.completion.size;
        (width as usize, height as usize)
    }

    fn rows(&self, rows: Range<usize>) -> Result<Noisy, PictureError> {
        let (width, _) = self.size();
        let points = rows.start * width..rows.end * width;
        let features = self.completion.of_points.as_ref();
        let (albedo, normal) =
            features.map(|features| features.guides(self.coverage.is_some(), points.clone())).unzip();
        let noisy = Noisy {
            width,
            height: rows.len(),
            layers: vec![Layer { colour: self.completion.light[points.clone()].to_vec(), variance: None }],
            coverage: self.coverage.as_ref().map(|coverage| coverage[points.clone()].to_vec()),
            albedo,
            normal,
            depth: features.map(|features| features.mean_depth[points.clone()].to_vec()),
            haze: features.and_then(|features| features.haze(self.coverage.is_some(), points)),
        };
        Ok(noisy.separated())
    }
}
