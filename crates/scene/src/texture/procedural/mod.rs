//! Procedural textures, evaluated where they are looked up. To add one: a file with its `ENTRY`, and a line in the
//! table.

mod checker;
mod mix;
mod noise;
mod place;
mod ramp;
mod scale;

use super::image::{ComputedTexels, centre};
use super::{ColourMap, Filter, Image, NumberMap, Texels, Texture};
use crate::{Reader, SceneError, Spec};
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::{Rgb, Vec2};
use std::any::Any;
use std::fmt::Debug;
use std::sync::Arc;

/// All kinds of procedural textures.
pub static TEXTURES: &[TextureEntry] = &[checker::ENTRY, ramp::ENTRY, noise::ENTRY, mix::ENTRY, scale::ENTRY];

/// A row of [`TEXTURES`].
#[derive(Clone, Copy, Debug)]
pub struct TextureEntry {
    /// Name, summary, source, parameters.
    pub entry: Entry,
    /// Makes one from its parameters and the textures to which these refer by index.
    pub build: BuildPattern,
}

/// Builds a texture from its parameters and the textures among these.
pub type BuildPattern = fn(&Reader, &Parts) -> Result<Arc<dyn Pattern>, SceneError>;

/// A pattern over texture coordinates.
pub trait Pattern: Debug + Send + Sync {
    /// The colour at texture coordinates, v upwards.
    fn at(&self, uv: Vec2) -> Rgb;
    /// The identical image, if there is one.
    fn picture(&self) -> Option<Texture> {
        None
    }
}

/// A procedural texture: its description, and the pattern built from it.
#[derive(Clone, Debug)]
pub struct Formula {
    spec: Spec,
    parts: Vec<Arc<Texture>>,
    pattern: Arc<dyn Pattern>,
    cost: usize,
}

impl ComputedTexels for Formula {
    fn at(&self, uv: Vec2) -> Rgb {
        self.pattern.at(uv)
    }

    fn is_same(&self, other: &dyn ComputedTexels) -> bool {
        (other as &dyn Any).downcast_ref() == Some(self)
    }
}

impl PartialEq for Formula {
    fn eq(&self, other: &Formula) -> bool {
        (&self.spec, &self.parts) == (&other.spec, &other.parts)
    }
}

/// The maximum number of nested procedural textures: more than anybody writes, but few enough to stay fast.
const MAX_FORMULAS: usize = 256;
/// The minimum and maximum side of an image of a procedural texture, in texels.
const SIDES: [usize; 2] = [1024, 4096];

impl Formula {
    /// Builds what a spec describes. A texture in it is an index into `parts`.
    ///
    /// # Errors
    /// When no row has its kind, a parameter is wrong, or it contains hundreds of procedural textures.
    pub fn new(spec: Spec, parts: Vec<Arc<Texture>>) -> Result<Formula, SceneError> {
        let names = TEXTURES.iter().map(|row| row.entry.name);
        let row = TEXTURES.iter().find(|row| row.entry.name == spec.kind);
        let row = row.ok_or_else(|| SceneError::unknown("texture", &spec.kind, names, &spec.span))?;
        let formulas = parts.iter().filter_map(|part| part.formula());
        let cost = formulas.fold(1, |cost: usize, formula| cost.saturating_add(formula.cost));
        if cost > MAX_FORMULAS {
            let message = format!("a procedural texture is made of more than {MAX_FORMULAS} other textures");
            return Err(SceneError::invalid(message, &spec.span));
        }
        let pattern = (row.build)(&Reader::new(&spec, &row.entry)?, &Parts(&parts))?;
        Ok(Formula { spec, parts, pattern, cost })
    }

    /// Description of the texture; other textures are indices into its parts.
    pub fn spec(&self) -> &Spec {
        &self.spec
    }

    /// The textures that it uses.
    pub fn parts(&self) -> impl Iterator<Item = &Arc<Texture>> {
        self.parts.iter()
    }

    /// One of the textures that it uses.
    pub fn part(&self, index: usize) -> Option<&Arc<Texture>> {
        self.parts.get(index)
    }

    /// The number of procedural textures evaluated per look-up, including itself.
    pub fn cost(&self) -> usize {
        self.cost
    }

    /// The colour at texture coordinates, v upwards.
    pub fn at(&self, uv: Vec2) -> Rgb {
        self.pattern.at(uv)
    }

    /// The number of texels per side that show all of its detail.
    fn side(&self) -> usize {
        let sides = self.parts.iter().map(|part| part.width().max(part.height()));
        sides.max().unwrap_or(0).clamp(SIDES[0], SIDES[1])
    }
}

impl Texture {
    /// A procedural texture.
    ///
    /// # Errors
    /// As [`Formula::new`].
    pub fn by_formula(spec: Spec, parts: Vec<Arc<Texture>>, is_data: bool) -> Result<Texture, SceneError> {
        let formula = Formula::new(spec, parts)?;
        let (name, side) = (formula.spec.kind.clone(), formula.side());
        let image = Image { width: side, height: side, texels: Texels::Formula(Arc::new(formula)) };
        Ok(Texture::of(&name, Arc::new(image), is_data))
    }

    /// Formula of a procedural texture; `None` for an image.
    pub fn formula(&self) -> Option<&Formula> {
        match &self.image.texels {
            Texels::Formula(formula) => (&**formula as &dyn Any).downcast_ref(),
            _ => None,
        }
    }

    /// An image of a procedural texture, and whether it is identical everywhere; `None` for an image.
    ///
    /// It can be identical if the image may be placed elsewhere than from 0 to 1 (`may_move`).
    pub fn baked(&self, may_move: bool) -> Option<(Texture, bool)> {
        let formula = self.formula()?;
        let kept = |picture: Texture| Texture {
            name: self.name.clone(),
            is_data: self.is_data,
            factor: self.factor,
            channel: self.channel,
            threshold: self.threshold,
            second_uv: self.second_uv,
            ..picture
        };
        if let Some(picture) = formula.pattern.picture().filter(|_| may_move && self.transform.is_none()) {
            return Some((kept(picture), true));
        }
        Some((Texture { transform: self.transform, ..kept(self.sampled(formula)) }, false))
    }

    /// Values at `side` by `side` uniformly spaced positions from 0 to 1, for sums and extremes of procedural textures.
    ///
    /// Those have more texels than such uses need.
    pub fn spread(&self, side: usize) -> impl Iterator<Item = Rgb> + '_ {
        (0..side * side).map(move |i| self.at_one(centre(i, side, side)))
    }

    fn sampled(&self, formula: &Formula) -> Texture {
        let (width, height) = (self.width(), self.height());
        let texels = (0..width * height).map(|i| formula.at(centre(i, width, height))).collect();
        Texture { filter: Filter::Linear, ..Texture::new(&self.name, width, height, texels, self.is_data) }
    }
}

/// The textures to which the parameters of a procedural texture refer by index.
#[derive(Clone, Copy, Debug)]
pub struct Parts<'a>(&'a [Arc<Texture>]);

impl Parts<'_> {
    /// The texture under a key, if one is given.
    fn texture(&self, reader: &Reader, key: &str) -> Option<Arc<Texture>> {
        reader.texture(key).and_then(|index| self.0.get(index)).cloned()
    }

    /// The colour or texture under a key.
    fn colour(&self, reader: &Reader, key: &str) -> ColourMap {
        ColourMap { colour: reader.colour(key), texture: self.texture(reader, key) }
    }

    /// The number or texture under a key.
    fn number(&self, reader: &Reader, key: &str) -> NumberMap {
        let range = reader.range(key).map(|x| x as f32);
        NumberMap { number: reader.number(key), range, texture: self.texture(reader, key) }
    }
}

/// A colour of a procedural texture, or another texture.
const fn tone(name: &'static str, summary: &'static str, default: &'static str) -> Parameter {
    Parameter { name, summary, unit: "", kind: ParameterKind::ColourTexture { min: 0.0, max: 1e12 }, default }
}

#[cfg(test)]
mod tests;
