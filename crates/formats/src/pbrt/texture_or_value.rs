//! Surface parameters that are either a constant or a texture.

use super::colours::ColourSpace;
use super::parameters::{Kind, Parameter, ParameterList, Values};
use super::reader::Pbrt;
use super::spectra::{self, Named, Spectrum};
use super::unknown;
use crate::FormatError;
use bilux_math::{Rgb, Vec2};
use bilux_scene::texture::{Image, Texels};
use bilux_scene::{Spec, Texture, Value};
use std::sync::Arc;

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

/// Deeper nesting of procedural textures is baked, so that chains of references cost no time.
const MAX_PARTS: usize = 16;

/// A constant or a texture.
#[derive(Clone, Debug)]
pub(super) enum TextureOrValue {
    Colour(Rgb),
    Picture(Arc<Texture>),
}

impl TextureOrValue {
    /// Multiplies it by a colour.
    pub(super) fn scaled(self, by: Rgb) -> TextureOrValue {
        match self {
            TextureOrValue::Colour(colour) => TextureOrValue::Colour(colour * by),
            TextureOrValue::Picture(picture) if by == Rgb::WHITE => TextureOrValue::Picture(picture),
            TextureOrValue::Picture(picture) => TextureOrValue::Picture(Arc::new(Texture {
                factor: picture.factor * by,
                ..(*picture).clone()
            })),
        }
    }

    /// The constant, or the mean of the texture.
    pub(super) fn mean(&self) -> Rgb {
        match self {
            TextureOrValue::Colour(colour) => *colour,
            TextureOrValue::Picture(picture) => {
                let all: Vec<Rgb> = if picture.formula().is_some() {
                    picture.spread(64).collect()
                } else {
                    picture.texels().collect()
                };
                let count = all.len().max(1);
                let sums = all
                    .iter()
                    .fold([0f64; 3], |sums, texel| std::array::from_fn(|c| sums[c] + f64::from(texel[c])));
                Rgb::from_array(sums.map(|sum| (sum / count as f64) as f32))
            }
        }
    }

    /// Its value at texture coordinates.
    pub(super) fn at(&self, uv: Vec2) -> Rgb {
        match self {
            TextureOrValue::Colour(colour) => *colour,
            TextureOrValue::Picture(picture) => picture.at(uv),
        }
    }

    pub(super) fn is_black(&self) -> bool {
        matches!(self, TextureOrValue::Colour(colour) if colour.is_black())
    }
}

impl Pbrt<'_, '_> {
    /// Applies a function to each texel, or to the constant.
    pub(super) fn mapped(
        &mut self,
        source: TextureOrValue,
        rule: impl Fn(Rgb) -> Rgb,
    ) -> Result<TextureOrValue, FormatError> {
        match source {
            TextureOrValue::Colour(colour) => Ok(TextureOrValue::Colour(rule(colour))),
            TextureOrValue::Picture(picture) => {
                let texels = picture.texels().map(rule).collect();
                let made = self.picture(&picture.name, [picture.width(), picture.height()], texels)?;
                Ok(TextureOrValue::Picture(Arc::new(Texture {
                    wrap: picture.wrap,
                    filter: picture.filter,
                    transform: picture.transform,
                    ..made
                })))
            }
        }
    }

    /// A texture from rows of texels, the top one first.
    pub(super) fn picture(
        &mut self,
        name: &str,
        [width, height]: [usize; 2],
        colours: Vec<Rgb>,
    ) -> Result<Texture, FormatError> {
        let image = Image { width, height, texels: Texels::Floats { colours, alpha: Vec::new() } };
        self.reading.charge_image(&image, name)?;
        Ok(Texture::of(name, Arc::new(image), true))
    }

    /// A procedural texture of these parts; bakes `rule` if the kind does not accept these values, or has too many
    /// parts.
    pub(super) fn by_formula<const N: usize>(
        &mut self,
        kind: &str,
        sources: [(&str, &TextureOrValue); N],
        numbers: &[(&str, f32)],
        rule: impl Fn(Vec2) -> Rgb,
    ) -> Result<TextureOrValue, FormatError> {
        let mut spec = Spec::new("", kind);
        let mut parts = Vec::new();
        for (key, source) in sources {
            let value = match source {
                TextureOrValue::Colour(colour) if key == "amount" => colour.r.into(),
                TextureOrValue::Colour(colour) => (*colour).into(),
                TextureOrValue::Picture(picture) => {
                    parts.push(picture.clone());
                    Value::Texture(parts.len() - 1)
                }
            };
            spec.parameters.set(key, value);
        }
        numbers.iter().for_each(|(key, number)| spec.parameters.set(key, *number));
        match Texture::by_formula(spec, parts, true) {
            Ok(texture) if texture.formula().is_some_and(|formula| formula.cost() <= MAX_PARTS) => {
                Ok(TextureOrValue::Picture(Arc::new(texture)))
            }
            _ => self.baked(kind, &sources.map(|(_, source)| source), rule),
        }
    }

    /// Bakes a function of the parts into an image over texture coordinates from 0 to 1.
    pub(super) fn baked(
        &mut self,
        name: &str,
        parts: &[&TextureOrValue],
        rule: impl Fn(Vec2) -> Rgb,
    ) -> Result<TextureOrValue, FormatError> {
        /// Limits on the sides of the image.
        const MIN: usize = 256;
        const MAX: usize = 2048;
        let side = |of: fn(&Texture) -> usize| {
            let sides = parts.iter().map(|source| match source {
                TextureOrValue::Picture(picture) if picture.formula().is_none() => of(picture),
                _ => 0,
            });
            sides.max().unwrap_or(0).clamp(MIN, MAX)
        };
        let (width, height) = (side(Texture::width), side(Texture::height));
        self.reading.budget.take_bytes((width * height * size_of::<Rgb>()) as u64, name)?;
        let at = |i: usize| {
            let (x, y) = ((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
            rule(Vec2::new(x / width as f32, 1.0 - y / height as f32))
        };
        let texels = (0..width * height).map(at).collect();
        self.reading.budget.release((width * height * size_of::<Rgb>()) as u64);
        Ok(TextureOrValue::Picture(Arc::new(self.picture(name, [width, height], texels)?)))
    }

    /// The value of a Bilux parameter.
    pub(super) fn value(&mut self, source: TextureOrValue) -> Value {
        match source {
            TextureOrValue::Colour(colour) => colour.into(),
            TextureOrValue::Picture(picture) => self.texture_value(picture),
        }
    }

    /// The value of a Bilux parameter that is a single number.
    pub(super) fn number_value(&mut self, source: TextureOrValue, [min, max]: [f32; 2]) -> Value {
        match source {
            TextureOrValue::Colour(colour) => colour.r.clamp(min, max).into(),
            TextureOrValue::Picture(picture) => self.texture_value(picture),
        }
    }

    /// Adds a texture to the scene once.
    fn texture_value(&mut self, picture: Arc<Texture>) -> Value {
        let index = *self.placed_textures.entry(Arc::as_ptr(&picture)).or_insert_with(|| {
            self.scene.textures.push(picture);
            self.scene.textures.len() - 1
        });
        Value::Texture(index)
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
                self.of_space(parameter, Rgb::new(c[0], c[1], c[2]), meaning)
            }
            (Kind::Rgb | Kind::Xyz, _) => return wrong("three numbers"),
            (Kind::Float, Values::Numbers(c)) if c.len() == 1 => Rgb::grey(c[0]),
            (Kind::Blackbody, Values::Numbers(c)) => match c.as_slice() {
                [kelvin] => spectra::blackbody(*kelvin),
                // Version 3 adds a factor.
                [kelvin, factor] => spectra::blackbody(*kelvin) * *factor,
                _ => return wrong("a temperature in kelvin"),
            },
            (Kind::Spectrum, Values::Numbers(c)) => {
                let spectrum = self.samples(c, parameter)?;
                of_samples(&spectrum, meaning)
            }
            (Kind::Spectrum, Values::Texts(_)) => self.of_name(parameter, meaning)?,
            _ => return wrong("a colour or a spectrum"),
        };
        if !colour.is_finite() || colour.to_array().iter().any(|c| *c < 0.0) {
            let what = "colours have negative numbers or NaN: these are set to 0";
            self.oddities.note(what, || at.clone());
        }
        let held = colour.map(|c| if c.is_finite() { c.max(0.0) } else { 0.0 });
        if meaning == SpectrumType::Surface && held.max_channel() > 1.0 {
            self.oddities.note("a reflectance is above 1: it is limited to 1", || at.clone());
        }
        Ok(if meaning == SpectrumType::Surface { held.clamp(0.0, 1.0) } else { held })
    }

    fn of_space(&self, parameter: &Parameter, colour: Rgb, meaning: SpectrumType) -> Rgb {
        if parameter.kind == Kind::Xyz {
            let c = colour.to_array().map(f64::from);
            return Rgb::from_array(super::colours::from_xyz(c.into()).as_vec3().to_array());
        }
        match (parameter.space, meaning) {
            // The caller warns about values that are out of range.
            (ColourSpace::Srgb, _) | (_, SpectrumType::Number) => colour,
            (space, SpectrumType::Light) => space.light(colour),
            (space, SpectrumType::Surface) => space.surface(colour),
        }
    }

    /// A spectrum from pairs of wavelengths and values.
    fn samples(&mut self, numbers: &[f32], parameter: &Parameter) -> Result<Spectrum, FormatError> {
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
                let [eta, k] = super::metals::indices(metal);
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
        let path = match self.reading.locate(self.folder.as_deref(), name, &parameter.at) {
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
                match super::lexer::number_of(word) {
                    Some(number) => numbers.push(number),
                    None => {
                        let message = format!("'{name}' is not a spectrum: it needs pairs of numbers");
                        return Err(FormatError::malformed(message, parameter.at.clone()));
                    }
                }
            }
        }
        let spectrum = self.samples(&numbers, parameter)?;
        self.reading.budget.release(2 * (bytes.len() / 2 * size_of::<f32>()) as u64);
        self.reading.release(bytes);
        self.spectra.insert(path, Arc::new(spectrum.clone()));
        Ok(spectrum)
    }

    /// The full spectrum of a parameter, if it is one and not a colour.
    pub(super) fn whole_spectrum(&mut self, parameter: &Parameter) -> Result<Option<Spectrum>, FormatError> {
        match (parameter.kind, &parameter.values) {
            (Kind::Spectrum, Values::Numbers(numbers)) => self.samples(numbers, parameter).map(Some),
            (Kind::Spectrum, Values::Texts(_)) => match parameter.text() {
                Some(name) if spectra::named(name).is_none() => self.spectrum_file(name, parameter).map(Some),
                _ => Ok(None),
            },
            _ => Ok(None),
        }
    }
}

fn of_samples(spectrum: &Spectrum, meaning: SpectrumType) -> Rgb {
    if meaning == SpectrumType::Light { spectrum.light() } else { spectrum.surface() }
}
