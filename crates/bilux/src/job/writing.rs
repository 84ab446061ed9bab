//! Display, description and writing of a job's pictures.

use super::Job;
use crate::output::description::{options, row_vectors};
use crate::output::display::Display;
use crate::output::metadata::{ASKED, FINGERPRINT, IRRADIANCE, MEASURES, PIXEL_SHAPE, SETTINGS, SOFTWARE};
use crate::settings::{Background, Settings};
use crate::{Error, Outcome};
use bilux_pictures::{Picture, WriteOptions};
use std::borrow::Cow;
use std::path::Path;

/// Largest relative difference from a square pixel that is a rounding.
const SQUARE: f64 = 1e-4;

impl Job {
    /// The options for writing a picture of this job, with automatic exposure if the settings ask for it.
    ///
    /// # Errors
    /// If no tone curve has the name.
    pub fn write_options_for(&self, picture: &Picture) -> Result<WriteOptions, Error> {
        let mut options = self.write_options()?;
        if self.settings.auto_exposure {
            options.exposure += bilux_pictures::auto_exposure(picture);
        }
        Ok(options)
    }

    /// The options for writing any picture of this job, whatever it shows.
    ///
    /// # Errors
    /// If no tone curve has the name.
    pub fn write_options(&self) -> Result<WriteOptions, Error> {
        let name = match self.settings.tonemap.as_str() {
            "auto" => self.found.auto_curve,
            name => name,
        };
        let tone_map = bilux_pictures::tonemap::tone_map(name)?;
        let behind = match self.settings.background {
            Background::Colour(colour) => Some(colour),
            Background::Surroundings | Background::Transparent => None,
        };
        let exposure = self.settings.display_exposure();
        Ok(WriteOptions { exposure, tone_map, behind, ..WriteOptions::default() })
    }

    /// Display of its pictures.
    ///
    /// # Errors
    /// If no tone curve has the name.
    pub fn display(&self) -> Result<Display, Error> {
        let WriteOptions { exposure, tone_map, behind, .. } = self.write_options()?;
        let Settings { auto_exposure, linear_transfer: encoded, .. } = self.settings;
        Ok(Display { exposure, auto_exposure, tone_map, behind, encoded })
    }

    /// Writes the picture.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, outcome: &Outcome, path: &Path) -> Result<(), Error> {
        let mut picture = outcome.picture()?;
        self.describe(&mut picture, outcome, None);
        Ok(bilux_pictures::write(path, &picture, &self.write_options_for(&picture)?)?)
    }

    /// The film's exact sums, its coverage and its display, as a picture that an `.exr` can hold and `merge` can merge.
    ///
    /// # Errors
    /// If memory is short.
    pub fn partial(&self, outcome: &Outcome) -> Result<Picture, Error> {
        let mut film = Cow::Borrowed(&outcome.rendered.film);
        if outcome.rendered.spacing.is_some() {
            film.to_mut().keep_covered();
        }
        let mut picture = film.to_partial()?;
        if let Some(coverage) = &outcome.coverage {
            picture.push_channel("A", coverage.clone())?;
        }
        self.display()?.record(&mut picture);
        if let Some(spp) = self.settings.asked_spp() {
            picture.metadata.insert(ASKED.to_owned(), spp.to_string());
        }
        self.describe(&mut picture, outcome, None);
        Ok(picture)
    }

    /// Adds to a picture what it says about itself. `denoiser` is the name of the one that smoothed it, if any did.
    pub fn describe(&self, picture: &mut Picture, outcome: &Outcome, denoiser: Option<&str>) {
        let mut note = |key: &str, value: String| picture.metadata.insert(key.to_owned(), value);
        note(SOFTWARE, concat!("Bilux ", env!("CARGO_PKG_VERSION")).to_owned());
        note(FINGERPRINT, self.fingerprint().to_owned());
        let matrices = self.camera().matrices(self.scene().shutter()[0]);
        note("worldToCamera", row_vectors(&matrices.to_camera));
        if self.camera().receives() {
            note(MEASURES, IRRADIANCE.to_owned());
        }
        if let Some(to_film) = &matrices.to_film {
            note("worldToNDC", row_vectors(to_film));
            // What a metre across is on the film in pixels, and a metre upwards.
            let lens = *to_film * matrices.to_camera.inverse();
            let [across, upwards] = [lens.x_axis.x, lens.y_axis.y].map(f64::from).map(f64::abs);
            let [width, height] = [self.settings().width, self.settings().height].map(f64::from);
            let shape = upwards * height / (across * width);
            if shape.is_normal() && (shape - 1.0).abs() > SQUARE {
                note(PIXEL_SHAPE, format!("{:.4}", shape));
            }
        }
        // What was interrupted cannot be made again, nor what time ended within a pass.
        if !outcome.rendered.cancelled && !outcome.rendered.cut_short {
            let reached = outcome.rendered.reached.map_or(self.settings().spp, |reached| reached.spp);
            note(SETTINGS, options(self.settings(), reached, denoiser));
        }
    }
}
