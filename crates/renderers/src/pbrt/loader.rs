//! Values that parameters refer to: colours, spectra and pictures, many of them in files of their own.

use super::lexer::number_of;
use super::parameters::{Kind, Parameter, ParameterList, Values};
use super::spectra::{self, Named};
use bilux_import::FormatError;
use bilux_import::appearance::spectra::colours::{ColourSpace, from_xyz};
use bilux_import::appearance::spectra::metals;
use bilux_import::appearance::spectra::{Spectrum, blackbody};
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::names::unknown;
use bilux_import::input::reading::{self, Reading};
use bilux_math::Rgb;
use bilux_scene::{Span, Texture};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Evaluates parameters, opens the files that they name, and notes what is odd about either.
pub(super) struct Loader<'o, 'r> {
    pub(super) reading: &'r mut Reading<'o>,
    /// The folder of the first file, which all names are relative to.
    pub(super) folder: Option<PathBuf>,
    pub(super) diagnostics: Diagnostics,
    /// Spectra loaded from files.
    spectra: HashMap<PathBuf, Arc<Spectrum>>,
}

/// The quantity that a spectrum describes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SpectrumType {
    /// A reflectance.
    Surface,
    /// Numbers of any magnitude.
    Number,
    /// An emission: colours as they are, other spectra with a luminance of 1.
    Light,
}

impl<'o, 'r> Loader<'o, 'r> {
    pub(super) fn new(reading: &'r mut Reading<'o>, folder: Option<PathBuf>) -> Loader<'o, 'r> {
        Loader { reading, folder, diagnostics: Diagnostics::default(), spectra: HashMap::new() }
    }

    /// Counts something odd.
    pub(super) fn note(&mut self, what: &str, at: impl FnOnce() -> Span) {
        self.diagnostics.note(what, at);
    }

    /// The colour of a parameter, if it is given and not a texture.
    pub(super) fn spectrum(
        &mut self,
        list: &ParameterList,
        name: &'static str,
        meaning: SpectrumType,
    ) -> Result<Option<Rgb>, FormatError> {
        match list.find_where(name, |p| p.kind != Kind::Texture) {
            Some(parameter) => self.colour_of(parameter, meaning).map(Some),
            None => Ok(None),
        }
    }

    /// The colour of a spectrum parameter.
    pub(super) fn colour_of(
        &mut self,
        parameter: &Parameter,
        meaning: SpectrumType,
    ) -> Result<Rgb, FormatError> {
        let at = &parameter.at;
        let wrong = |wanted: &str| {
            let message = format!("'{}' must be {wanted}", parameter.name);
            Err(FormatError::malformed(message, at.clone()))
        };
        let colour = match (parameter.kind, &parameter.values) {
            (Kind::Rgb | Kind::Xyz, Values::Numbers(c)) if c.len() == 3 => {
                of_space(parameter, Rgb::new(c[0], c[1], c[2]), meaning)
            }
            (Kind::Rgb | Kind::Xyz, _) => return wrong("three numbers"),
            (Kind::Float, Values::Numbers(c)) if c.len() == 1 => Rgb::grey(c[0]),
            (Kind::Blackbody, Values::Numbers(c)) => match c.as_slice() {
                [kelvin] => blackbody(*kelvin),
                // Version 3 adds a factor.
                [kelvin, factor] => blackbody(*kelvin) * *factor,
                _ => return wrong("a temperature in kelvin"),
            },
            (Kind::Spectrum, Values::Numbers(c)) => {
                let spectrum = samples(c, parameter)?;
                of_samples(&spectrum, meaning)
            }
            (Kind::Spectrum, Values::Texts(_)) => self.of_name(parameter, meaning)?,
            _ => return wrong("a colour or a spectrum"),
        };
        if !colour.is_finite() || colour.to_array().iter().any(|c| *c < 0.0) {
            let what = "colours have negative numbers or NaN: these are set to 0";
            self.note(what, || at.clone());
        }
        let held = colour.map(|c| if c.is_finite() { c.max(0.0) } else { 0.0 });
        if meaning == SpectrumType::Surface && held.max_channel() > 1.0 {
            self.note("a reflectance is above 1: it is limited to 1", || at.clone());
        }
        Ok(if meaning == SpectrumType::Surface { held.clamp(0.0, 1.0) } else { held })
    }

    /// A spectrum by its name, or from the file with that name.
    fn of_name(&mut self, parameter: &Parameter, meaning: SpectrumType) -> Result<Rgb, FormatError> {
        let Some(name) = parameter.text() else {
            let message = format!("'{}' must be one spectrum", parameter.name);
            return Err(FormatError::malformed(message, parameter.at.clone()));
        };
        Ok(match spectra::named(name) {
            Some(Named::Light(colour)) => colour,
            Some(Named::Glass { index, .. }) => {
                Rgb::grey(if meaning == SpectrumType::Light { 1.0 } else { index })
            }
            Some(Named::Even(index)) => Rgb::grey(if meaning == SpectrumType::Light { 1.0 } else { index }),
            Some(Named::Metal { metal, is_extinction }) => {
                let [eta, k] = metals::indices(metal);
                if is_extinction { k } else { eta }
            }
            None => of_samples(&self.spectrum_file(name, parameter)?, meaning),
        })
    }

    /// A spectrum from a file of its own: pairs of numbers.
    pub(super) fn spectrum_file(
        &mut self,
        name: &str,
        parameter: &Parameter,
    ) -> Result<Spectrum, FormatError> {
        let unknown = || {
            let names: Vec<String> = spectra::names().collect();
            unknown("spectrum or file", name, names.iter().map(String::as_str), &parameter.at)
        };
        let path = match self.reading.locator.locate(self.folder.as_deref(), name, &parameter.at) {
            Ok(path) => path,
            Err(error @ FormatError::Outside { .. }) => return Err(error),
            Err(_) => return Err(unknown()),
        };
        if let Some(known) = self.spectra.get(&path) {
            return Ok((**known).clone());
        }
        let bytes = self.reading.load_text(&path)?;
        let file = path.display().to_string();
        self.reading.budget.take::<f32>(bytes.len() / 2, &file)?;
        let mut numbers = Vec::new();
        for line in bytes.split(|b| matches!(b, b'\n' | b'\r')) {
            let line = line.split(|b| *b == b'#').next().unwrap_or_default();
            for word in line.split(|b| b.is_ascii_whitespace()).filter(|word| !word.is_empty()) {
                match number_of(word) {
                    Some(number) => numbers.push(number),
                    None => {
                        let message = format!("'{name}' is not a spectrum: it needs pairs of numbers");
                        return Err(FormatError::malformed(message, parameter.at.clone()));
                    }
                }
            }
        }
        let spectrum = samples(&numbers, parameter)?;
        self.reading.budget.release(2 * (bytes.len() / 2 * size_of::<f32>()) as u64);
        self.reading.release(bytes);
        self.spectra.insert(path, Arc::new(spectrum.clone()));
        Ok(spectrum)
    }

    /// The full spectrum of a parameter, if it is one and not a colour.
    pub(super) fn whole_spectrum(&mut self, parameter: &Parameter) -> Result<Option<Spectrum>, FormatError> {
        match (parameter.kind, &parameter.values) {
            (Kind::Spectrum, Values::Numbers(numbers)) => samples(numbers, parameter).map(Some),
            (Kind::Spectrum, Values::Texts(_)) => match parameter.text() {
                Some(name) if spectra::named(name).is_none() => self.spectrum_file(name, parameter).map(Some),
                _ => Ok(None),
            },
            _ => Ok(None),
        }
    }

    /// An image from a file; a magenta checker, with a warning, if it cannot be read.
    pub(super) fn file(
        &mut self,
        name: &str,
        holds: reading::Texels,
        at: &Span,
    ) -> Result<Texture, FormatError> {
        self.file_or(name, holds, at, "a magenta checker", Texture::missing)
    }

    /// The image of a light; a uniform grey, with a warning, if it cannot be read: any colour would tint the whole
    /// scene.
    pub(super) fn light_file(&mut self, name: &str, at: &Span) -> Result<Texture, FormatError> {
        self.file_or(name, reading::Texels::Colours, at, "a uniform grey of 0.5", Texture::missing_light)
    }

    fn file_or(
        &mut self,
        name: &str,
        holds: reading::Texels,
        at: &Span,
        stands_in: &str,
        make: fn(&str) -> Texture,
    ) -> Result<Texture, FormatError> {
        match self.reading.texture(self.folder.as_deref(), name, holds, at) {
            Ok(texture) => Ok((*texture).clone()),
            Err(error @ FormatError::TooLarge { .. }) => Err(error),
            Err(error) => {
                let reason = error.without_place();
                let what = format!("a texture is replaced by {stands_in}: {reason}");
                self.note(&what, || at.clone());
                Ok(make(name))
            }
        }
    }
}

fn of_space(parameter: &Parameter, colour: Rgb, meaning: SpectrumType) -> Rgb {
    if parameter.kind == Kind::Xyz {
        let c = colour.to_array().map(f64::from);
        return Rgb::from_array(from_xyz(c.into()).as_vec3().to_array());
    }
    match (parameter.space, meaning) {
        // The caller warns about values that are out of range.
        (ColourSpace::Srgb, _) | (_, SpectrumType::Number) => colour,
        (space, SpectrumType::Light) => space.light(colour),
        (space, SpectrumType::Surface) => space.surface(colour),
    }
}

/// A spectrum from pairs of wavelengths and values.
fn samples(numbers: &[f32], parameter: &Parameter) -> Result<Spectrum, FormatError> {
    let wrong = |message: String| Err(FormatError::malformed(message, parameter.at.clone()));
    if !numbers.len().is_multiple_of(2) || numbers.is_empty() {
        let message = format!(
            "the spectrum '{}' has {} numbers: it takes pairs of a wavelength in nm and a value",
            parameter.name,
            numbers.len()
        );
        return wrong(message);
    }
    let pairs: Vec<[f64; 2]> =
        numbers.chunks_exact(2).map(|pair| [f64::from(pair[0]), f64::from(pair[1])]).collect();
    if !pairs.as_flattened().iter().all(|x| x.is_finite()) {
        return wrong(format!("the spectrum '{}' has numbers that are not finite", parameter.name));
    }
    if let Some(pair) = pairs.windows(2).find(|pair| pair[0][0] >= pair[1][0]) {
        let message = format!(
            "the wavelengths of the spectrum '{}' must increase, but {} is followed by {}",
            parameter.name, pair[0][0], pair[1][0]
        );
        return wrong(message);
    }
    Ok(Spectrum(pairs))
}

fn of_samples(spectrum: &Spectrum, meaning: SpectrumType) -> Rgb {
    if meaning == SpectrumType::Light { spectrum.light() } else { spectrum.surface() }
}
