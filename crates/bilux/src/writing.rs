//! How a job's pictures are written.

use crate::settings::{Background, Settings};
use crate::{Error, Job, Outcome};
use bilux_pictures::{Picture, WriteOptions};
use bilux_scene::SceneBuilder;
use std::path::Path;

/// The tone curve if the studio lights a model.
const STUDIO_TONEMAP: &str = "neutral";

/// The tone curve that `auto` means for a scene that the studio has completed, and what to tell the user about it.
pub(crate) fn auto_curve(
    scene: &SceneBuilder,
    completed: &SceneBuilder,
    settings: &Settings,
) -> (&'static str, Option<String>) {
    if completed.lights.len() == scene.lights.len() || settings.integrator.classic {
        return ("none", None);
    }
    if !bilux_scene::presets::is_unlit(scene) {
        return (STUDIO_TONEMAP, None);
    }
    let note = "the whole model is unlit, so its colours are shown as they are (--tonemap neutral adds the curve of \
                the studio)";
    ("none", (settings.tonemap == "auto").then(|| note.to_owned()))
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
            "auto" => self.auto_curve,
            name => name,
        };
        let tone_map = bilux_pictures::tonemap::tone_map(name)?;
        let behind = match self.settings.background {
            Background::Colour(colour) => Some(colour),
            Background::Surroundings | Background::Transparent => None,
        };
        Ok(WriteOptions { exposure: self.settings.exposure, tone_map, behind, ..WriteOptions::default() })
    }

    /// Writes the picture.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, outcome: &Outcome, path: &Path) -> Result<(), Error> {
        let picture = outcome.picture()?;
        Ok(bilux_pictures::write(path, &picture, &self.write_options_for(&picture)?)?)
    }
}
