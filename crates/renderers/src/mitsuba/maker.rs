//! Maker of parts of the scene from plugins, with what all kinds share: colours, textures, and what the scene has so far.

use super::document::{Document, Files};
use super::plugin::{Plugin, Value as Given};
use super::values::GivenColour;
use bilux_import::FormatError;
use bilux_import::appearance::texture_or_value::TextureOrValue;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::Reading;
use bilux_math::Rgb;
use bilux_scene::{Span, Spec, Texture, Value};
use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

/// Meaning of a colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Meaning {
    /// A reflectance.
    Surface,
    /// Numbers of any magnitude.
    Number,
    /// An emission.
    Light,
}

/// Functions that look up plugins of each kind in their table, so that these may contain one another.
#[derive(Clone, Copy)]
pub(super) struct Tables {
    pub(super) texture: fn(&mut Maker, &Plugin, Meaning) -> Result<TextureOrValue, FormatError>,
    /// `None` for a boundary that is invisible.
    pub(super) material: fn(&mut Maker, &Rc<Plugin>) -> Result<Option<Spec>, FormatError>,
}

/// Makes parts of the scene.
pub(super) struct Maker<'p, 'o> {
    pub(super) reading: &'p mut Reading<'o>,
    pub(super) document: &'p Document,
    tables: Tables,
    pub(super) diagnostics: Diagnostics,
    /// The textures of the scene, and their indices.
    pub(super) in_scene: Vec<Arc<Texture>>,
    placed: HashMap<*const Texture, usize>,
    /// Textures made so far.
    made: HashMap<(*const Plugin, Meaning), TextureOrValue>,
    /// The materials of the scene.
    pub(super) materials: Vec<Spec>,
    /// Length of one unit of each texture coordinate on the shape whose material is made.
    pub(super) extent: [f32; 2],
    /// The number of plugins around the one that is being made.
    depth: usize,
}

/// Deeper nesting of plugins is refused: they may refer to themselves.
const MAX_DEPTH: usize = 32;

/// The largest value of a light.
pub(super) const MAX_LIGHT: f32 = 1e11;

impl<'p, 'o> Maker<'p, 'o> {
    pub(super) fn new(
        reading: &'p mut Reading<'o>,
        document: &'p Document,
        tables: Tables,
        diagnostics: Diagnostics,
    ) -> Maker<'p, 'o> {
        Maker {
            reading,
            document,
            tables,
            diagnostics,
            in_scene: Vec::new(),
            placed: HashMap::new(),
            made: HashMap::new(),
            materials: Vec::new(),
            extent: [1.0; 2],
            depth: 0,
        }
    }

    /// Counts something odd.
    pub(super) fn note(&mut self, what: &str, at: &Span) {
        self.diagnostics.note(what, || at.clone());
    }

    /// Names something that the picture does not show.
    pub(super) fn not_shown(&mut self, plugin: &Plugin) {
        self.diagnostics.not_shown(&plugin.named(), || plugin.at.clone());
    }

    /// The files of the scene.
    pub(super) fn files(&self) -> &'p Files {
        &self.document.files
    }

    /// Makes something within something else, unless that goes on for too long.
    pub(super) fn within<T>(
        &mut self,
        plugin: &Plugin,
        make: impl FnOnce(&mut Self) -> Result<T, FormatError>,
    ) -> Result<T, FormatError> {
        if self.depth >= MAX_DEPTH {
            let message = format!(
                "{} is nested more than {MAX_DEPTH} levels deep, or contains itself: remove a reference",
                plugin.named()
            );
            return Err(FormatError::malformed(message, plugin.at.clone()));
        }
        self.depth += 1;
        let made = make(self);
        self.depth -= 1;
        made
    }

    /// A colour as Mitsuba's RGB modes have it.
    pub(super) fn colour(&mut self, given: &GivenColour, meaning: Meaning, at: &Span) -> Rgb {
        let colour = match (given, meaning) {
            // A light that is the same at all wavelengths is not quite white.
            (GivenColour::Even(value), Meaning::Light) => {
                bilux_import::appearance::spectra::Spectrum(vec![[300.0, 1.0], [900.0, 1.0]]).emission()
                    * *value
            }
            (GivenColour::Even(value), _) => Rgb::grey(*value),
            (GivenColour::Rgb(colour), _) => *colour,
            (GivenColour::Samples(spectrum), Meaning::Surface) => spectrum.surface(),
            // Indices of refraction are seen by equal light of all wavelengths.
            (GivenColour::Samples(spectrum), _) => spectrum.emission(),
        };
        self.within_range(colour, meaning, at)
    }

    /// A colour without numbers that it cannot have.
    pub(super) fn within_range(&mut self, colour: Rgb, meaning: Meaning, at: &Span) -> Rgb {
        if !colour.is_finite() || colour.to_array().iter().any(|c| *c < 0.0) {
            self.note("colours have negative numbers or NaN: these are set to 0", at);
        }
        let held = colour.map(|c| if c.is_finite() { c.clamp(0.0, MAX_LIGHT) } else { 0.0 });
        if meaning == Meaning::Surface && held.max_channel() > 1.0 {
            self.note("a reflectance is above 1: it is limited to 1", at);
            return held.clamp(0.0, 1.0);
        }
        held
    }

    /// The colour or texture of a property.
    pub(super) fn source(
        &mut self,
        plugin: &Plugin,
        name: &'static str,
        meaning: Meaning,
    ) -> Result<Option<TextureOrValue>, FormatError> {
        let Some(property) = plugin.find(name) else { return Ok(None) };
        let at = &property.at;
        let colour = match &property.value {
            Given::Number(number) => self.within_range(Rgb::grey(*number as f32), meaning, at),
            Given::Integer(number) => self.within_range(Rgb::grey(*number as f32), meaning, at),
            Given::Colour(given) => self.colour(given, meaning, at),
            Given::Vector(vector) => {
                self.within_range(Rgb::from_array(vector.as_vec3().to_array()), meaning, at)
            }
            _ => match self.document.part(property)? {
                Some(part) if ["texture", "spectrum", "volume"].contains(&part.tag) => {
                    return self.texture(&part, meaning).map(Some);
                }
                _ => {
                    let message = format!("'{name}' of {} must be a colour or a texture", plugin.named());
                    return Err(FormatError::malformed(message, at.clone()));
                }
            },
        };
        Ok(Some(TextureOrValue::Colour(colour)))
    }

    /// Colour or texture of a property, or else a grey.
    pub(super) fn source_or(
        &mut self,
        plugin: &Plugin,
        name: &'static str,
        meaning: Meaning,
        default: f32,
    ) -> Result<TextureOrValue, FormatError> {
        let found = self.source(plugin, name, meaning)?;
        Ok(found.unwrap_or(TextureOrValue::Colour(Rgb::grey(default))))
    }

    /// A single colour; the mean of a texture, with a warning.
    pub(super) fn even(
        &mut self,
        plugin: &Plugin,
        name: &'static str,
        meaning: Meaning,
    ) -> Result<Option<Rgb>, FormatError> {
        let found = self.source(plugin, name, meaning)?;
        if let Some(TextureOrValue::Picture(_)) = &found {
            let what = format!("a texture of '{name}' of {} is replaced by its mean", plugin.named());
            self.note(&what, &plugin.place(name));
        }
        Ok(found.map(|source| source.mean()))
    }

    /// A texture, made once.
    pub(super) fn texture(
        &mut self,
        plugin: &Rc<Plugin>,
        meaning: Meaning,
    ) -> Result<TextureOrValue, FormatError> {
        let key = (Rc::as_ptr(plugin), meaning);
        if let Some(known) = self.made.get(&key) {
            return Ok(known.clone());
        }
        let made = self.within(plugin, |maker| (maker.tables.texture)(maker, plugin, meaning))?;
        plugin.report_unused(&mut self.diagnostics);
        self.made.insert(key, made.clone());
        Ok(made)
    }

    /// The material of a plugin; `None` for a boundary that is invisible.
    pub(super) fn material(&mut self, plugin: &Rc<Plugin>) -> Result<Option<Spec>, FormatError> {
        (self.tables.material)(self, plugin)
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
            TextureOrValue::Colour(colour) => colour.luminance().clamp(min, max).into(),
            TextureOrValue::Picture(picture) => self.texture_value(picture),
        }
    }

    /// Sets a parameter to a colour or a texture.
    pub(super) fn set(&mut self, spec: &mut Spec, key: &str, source: TextureOrValue, at: &Span) {
        let value = self.value(source);
        spec.parameters.set_at(key, value, at.clone());
    }

    /// Sets a parameter that is a single number, or a texture of them.
    pub(super) fn set_number(&mut self, spec: &mut Spec, key: &str, source: TextureOrValue, at: &Span) {
        let value = self.number_value(source, [0.0, 1.0]);
        spec.parameters.set_at(key, value, at.clone());
    }

    /// Adds a texture to the scene once.
    fn texture_value(&mut self, picture: Arc<Texture>) -> Value {
        let index = *self.placed.entry(Arc::as_ptr(&picture)).or_insert_with(|| {
            self.in_scene.push(picture);
            self.in_scene.len() - 1
        });
        Value::Texture(index)
    }
}
