//! Surface parameters that are either a constant or a texture.

use crate::FormatError;
use crate::input::images::mean;
use crate::input::reading::Reading;
use bilux_math::{Rgb, Vec2};
use bilux_scene::texture::{Image, Texels};
use bilux_scene::{Spec, Texture, Value};
use std::sync::Arc;

/// Deeper nesting of procedural textures is baked, so that chains of references cost no time.
const MAX_PARTS: usize = 16;

/// A constant or a texture.
#[derive(Clone, Debug)]
pub enum TextureOrValue {
    Colour(Rgb),
    Picture(Arc<Texture>),
}

impl TextureOrValue {
    /// Multiplies it by a colour.
    pub fn scaled(self, by: Rgb) -> TextureOrValue {
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
    pub fn mean(&self) -> Rgb {
        match self {
            TextureOrValue::Colour(colour) => *colour,
            TextureOrValue::Picture(picture) => mean(picture),
        }
    }

    /// Value at texture coordinates.
    pub fn at(&self, uv: Vec2) -> Rgb {
        match self {
            TextureOrValue::Colour(colour) => *colour,
            TextureOrValue::Picture(picture) => picture.at(uv),
        }
    }

    pub fn is_black(&self) -> bool {
        matches!(self, TextureOrValue::Colour(colour) if colour.is_black())
    }

    /// Applies a function to each texel, or to the constant.
    pub fn mapped(
        self,
        rule: impl Fn(Rgb) -> Rgb,
        reading: &mut Reading,
    ) -> Result<TextureOrValue, FormatError> {
        match self {
            TextureOrValue::Colour(colour) => Ok(TextureOrValue::Colour(rule(colour))),
            TextureOrValue::Picture(picture) => {
                let texels = picture.texels().map(rule).collect();
                let made = reading.picture(&picture.name, [picture.width(), picture.height()], texels)?;
                Ok(TextureOrValue::Picture(Arc::new(Texture {
                    wrap: picture.wrap,
                    filter: picture.filter,
                    transform: picture.transform,
                    ..made
                })))
            }
        }
    }
}

/// A procedural texture of these parts; bakes `rule` if the kind does not accept these values, or has too many
/// parts.
pub fn by_formula<const N: usize>(
    kind: &str,
    sources: [(&str, &TextureOrValue); N],
    numbers: &[(&str, f32)],
    rule: impl Fn(Vec2) -> Rgb,
    reading: &mut Reading,
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
        _ => baked(kind, &sources.map(|(_, source)| source), rule, reading),
    }
}

/// Bakes a function of the parts into an image over texture coordinates from 0 to 1.
fn baked(
    name: &str,
    parts: &[&TextureOrValue],
    rule: impl Fn(Vec2) -> Rgb,
    reading: &mut Reading,
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
    reading.budget.take_bytes((width * height * size_of::<Rgb>()) as u64, name)?;
    let at = |i: usize| {
        let (x, y) = ((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
        rule(Vec2::new(x / width as f32, 1.0 - y / height as f32))
    };
    let texels = (0..width * height).map(at).collect();
    reading.budget.release((width * height * size_of::<Rgb>()) as u64);
    Ok(TextureOrValue::Picture(Arc::new(reading.picture(name, [width, height], texels)?)))
}

impl Reading<'_> {
    /// A texture from rows of texels, the top one first, charged for good.
    pub fn picture(
        &mut self,
        name: &str,
        [width, height]: [usize; 2],
        colours: Vec<Rgb>,
    ) -> Result<Texture, FormatError> {
        let image = Image { width, height, texels: Texels::Floats { colours, alpha: Vec::new() } };
        self.charge_image(&image, name)?;
        Ok(Texture::of(name, Arc::new(image), true))
    }
}
