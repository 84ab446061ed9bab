//! Exposure of written pictures, and what formats lose.

use crate::Error;
use crate::settings::Settings;
use bilux_math::Rgb;
use bilux_pictures::Picture;
use bilux_scene::{Span, Warning};
use std::path::Path;

/// A warning, if a picture is transparent and the format of the file cannot be. `behind` is the colour behind the picture.
///
/// # Errors
/// If no picture format has the file's extension.
pub fn lost_alpha(picture: &Picture, path: &Path, behind: Option<Rgb>) -> Result<Option<Warning>, Error> {
    let is_transparent = picture.channel("A").is_some_and(|alpha| alpha.iter().any(|&alpha| alpha < 1.0));
    lost_transparency(is_transparent, path, behind)
}

/// Warning of [`lost_alpha`] for any picture, by whether it is transparent.
///
/// # Errors
/// If no picture is written in a format of this name.
pub fn lost_transparency(
    is_transparent: bool,
    path: &Path,
    behind: Option<Rgb>,
) -> Result<Option<Warning>, Error> {
    let format = bilux_pictures::format_of_path(path)?;
    if !is_transparent || format.holds_alpha || behind.is_some() && format.for_display {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A colour behind the picture is in files for displays; light has no background.
    #[test]
    fn transparency_that_a_format_loses_is_said() {
        let said = |is_transparent: bool, name: &str, behind: Option<Rgb>| {
            let lost = lost_transparency(is_transparent, Path::new(name), behind).unwrap();
            lost.map(|warning| warning.message)
        };
        let red = Some(Rgb::new(1.0, 0.0, 0.0));
        for (name, behind, is_said) in [
            ("a.jpg", None, true),
            ("a.jpg", red, false),
            ("a.pfm", None, true),
            ("a.pfm", red, true),
            ("a.png", None, false),
            ("a.exr", red, false),
        ] {
            assert_eq!(said(true, name, behind).is_some(), is_said, "{name} {behind:?}");
            assert_eq!(said(false, name, behind), None);
        }
        assert!(said(true, "a.pfm", red).unwrap().contains("black"));
    }
}
