//! How a job's pictures are written.

use crate::display::Display;
use crate::metadata::ASKED;
use crate::settings::{Background, Settings};
use crate::{Error, Job, Outcome};
use bilux_math::Rgb;
use bilux_pictures::{Picture, WriteOptions};
use bilux_scene::{Span, Warning};
use std::path::Path;

/// A warning, if a picture is transparent and the format of the file cannot be. `behind` is the colour behind the picture.
///
/// # Errors
/// If no picture format has the file's extension.
pub fn lost_alpha(picture: &Picture, path: &Path, behind: Option<Rgb>) -> Result<Option<Warning>, Error> {
    let format = bilux_pictures::format_of_path(path)?;
    let transparent = picture.channel("A").is_some_and(|alpha| alpha.iter().any(|&alpha| alpha < 1.0));
    if !transparent || format.holds_alpha || behind.is_some() && format.for_display {
        return Ok(None);
    }
    let instead = if format.for_display { "white" } else { "black" };
    let message = format!(
        "{}: {} does not support transparency and gets {instead} there: write a .png or an .exr to keep it",
        path.display(),
        format.entry.name
    );
    Ok(Some(Warning { message, at: Span::default() }))
}

impl Settings {
    /// Whether pictures for a display are exposed by the scene's own light: nobody says how, and the shading is radiometric.
    pub(crate) fn is_exposed_by_own_light(&self) -> bool {
        !(self.states_exposure || self.auto_exposure || self.linear_transfer || self.integrator.classic)
    }

    /// The exposure of pictures for a display, in stops, without what automatic exposure adds.
    pub fn display_exposure(&self) -> f32 {
        let own = self.own_light.filter(|_| self.is_exposed_by_own_light());
        self.exposure + own.map_or(0.0, |judged| judged.exposure())
    }
}

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

    /// How its pictures are to be shown.
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
        let mut picture = outcome.rendered.film.to_partial()?;
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
}
