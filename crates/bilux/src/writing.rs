//! How pictures of a job are written.

use crate::settings::Background;
use crate::{Error, Job, Outcome};
use bilux_pictures::{Picture, WriteOptions};
use std::path::Path;

/// The curve where the studio lights a model.
const STUDIO_TONEMAP: &str = "neutral";

impl Job {
    /// How a picture of this job is written, exposed as it asks for where that is wanted.
    ///
    /// # Errors
    /// When no tone curve has the name.
    pub fn write_options_for(&self, picture: &Picture) -> Result<WriteOptions, Error> {
        let mut options = self.write_options()?;
        if self.settings.auto_exposure {
            options.exposure += bilux_pictures::auto_exposure(picture);
        }
        Ok(options)
    }

    /// How pictures of this job are written, whatever they show.
    ///
    /// # Errors
    /// When no tone curve has the name.
    pub fn write_options(&self) -> Result<WriteOptions, Error> {
        let name = match self.settings.tonemap.as_str() {
            "auto" if self.studio_lit => STUDIO_TONEMAP,
            "auto" => "none",
            name => name,
        };
        let tone_map = bilux_pictures::tonemap::tone_map(name)?;
        let behind = match self.settings.background {
            Background::Colour(colour) => Some(colour),
            Background::Surroundings | Background::Transparent => None,
        };
        Ok(WriteOptions { exposure: self.settings.exposure, tone_map, behind, ..WriteOptions::default() })
    }

    /// Writes the picture, or for a partial one its film.
    ///
    /// # Errors
    /// When the file cannot be written, or its format cannot hold a partial film.
    pub fn write(&self, outcome: &Outcome, path: &Path) -> Result<(), Error> {
        let picture = outcome.picture()?;
        Ok(bilux_pictures::write(path, &picture, &self.write_options_for(&picture)?)?)
    }
}
