//! Values of the common profile's models.

use super::bindings::Worn;
use super::effect::{Effect, Model};
use super::pictures::picture;
use crate::dae::element::Element;
use crate::dae::posed::Posed;
use bilux_import::FormatError;
use bilux_import::appearance::phong;
use bilux_import::appearance::principled_draft::PrincipledDraft;
use bilux_math::Rgb;
use bilux_math::colour::srgb_decode;
use bilux_scene::Texture;
use bilux_scene::texture::Channel;

/// A material that is being filled.
pub(super) struct Filling<'a, 'p, 'd, 'o> {
    pub(super) draft: PrincipledDraft<'a, 'o>,
    pub(super) effect: &'a Effect<'d>,
    pub(super) worn: &'a Worn<'d>,
    pub(super) posed: &'a Posed<'p, 'd>,
}

impl<'d> Filling<'_, '_, 'd, '_> {
    pub(super) fn fill(&mut self) -> Result<(), FormatError> {
        if self.effect.model == Model::Constant {
            self.constant()?;
        } else {
            let emission = self.colour("emission")?;
            let missing = if emission.is_some_and(|c| !c.is_black()) { Rgb::BLACK } else { Rgb::grey(0.8) };
            let diffuse = self.colour("diffuse")?.unwrap_or(missing).clamp(0.0, 1.0);
            let map = self.map("diffuse", false)?;
            let factor = if map.is_some() { Rgb::WHITE } else { diffuse };
            self.draft.colour("base_color", factor, map)?;
            self.emission(emission.unwrap_or(Rgb::BLACK))?;
            self.highlight()?;
        }
        self.transparency()?;
        if let Some(map) = self.effect.added_texture(&["bump", "normalmap"]) {
            let texture = self.texture(map, true)?;
            self.draft.normals(texture, 1.0)?;
        }
        let reflects = self.number("reflectivity").unwrap_or(1.0) > 0.0;
        let mirror = self.colour("reflective")?.is_some_and(|colour| !colour.is_black());
        let is_mapped = self.effect.value("reflective").is_some_and(|value| value.name() == "texture");
        if reflects && (mirror || is_mapped) && !self.posed.document.settings.is_of_new_blender {
            self.draft.not_shown("mirror reflections of materials");
        }
        Ok(())
    }

    /// A surface that looks the same in any light.
    fn constant(&mut self) -> Result<(), FormatError> {
        let what = "an unlit material emits its colour, so it also lights its surroundings";
        let at = self.draft.spec.span.clone();
        self.draft.sink.diagnostics.remark(what, || at);
        // Some programs write the colour where the other models have it.
        let name = if self.effect.value("emission").is_some() { "emission" } else { "diffuse" };
        let colour = self.colour(name)?.unwrap_or(Rgb::BLACK);
        let map = self.map(name, false)?;
        self.draft.set("base_color", Rgb::BLACK);
        self.draft.set("specular_weight", 0.0f32);
        let factor = if map.is_some() { Rgb::WHITE } else { colour };
        self.draft.colour("emission", factor, map)
    }

    fn emission(&mut self, colour: Rgb) -> Result<(), FormatError> {
        match self.map("emission", false)? {
            Some(map) => self.draft.colour("emission", Rgb::WHITE, Some(map)),
            None if !colour.is_black() => self.draft.colour("emission", colour, None),
            None => Ok(()),
        }
    }

    /// Sets the specular reflection: none of Lambert's, except that new versions of Blender keep metalness there.
    fn highlight(&mut self) -> Result<(), FormatError> {
        let is_lambert = self.effect.model == Model::Lambert;
        let metal = self.number("reflectivity").filter(|_| self.posed.document.settings.is_of_new_blender);
        if let Some(metal) = metal.filter(|metal| *metal > 0.0) {
            self.draft.set("base_metalness", metal.min(1.0) as f32);
            return Ok(());
        }
        let exponent = self.number("shininess").unwrap_or(20.0);
        self.draft.set("specular_roughness", phong::roughness(exponent));
        let colour = self.colour("specular")?.filter(|_| !is_lambert);
        let map = if is_lambert { None } else { self.map("specular", true)? };
        let weight = colour.map_or(0.0, |colour| f64::from(colour.max_channel())).clamp(0.0, 1.0);
        self.draft.number("specular_weight", if map.is_some() { 1.0 } else { weight }, map, Channel::G)
    }

    /// A colour of the model in linear light: those of Blender are, those of others are as displays show them.
    pub(super) fn colour(&mut self, name: &str) -> Result<Option<Rgb>, FormatError> {
        let Some(value) = self.effect.value(name) else { return Ok(None) };
        let Some([r, g, b, _]) = self.rgba(value)? else { return Ok(None) };
        let colour = Rgb::new(r, g, b);
        let is_linear = self.posed.document.settings.is_of_blender;
        Ok(Some(if is_linear { colour } else { colour.map(srgb_decode) }))
    }

    /// The numbers of a colour, as they are in the file; `None` for a texture.
    pub(super) fn rgba(&mut self, value: Element<'d>) -> Result<Option<[f32; 4]>, FormatError> {
        if !matches!(value.name(), "color" | "float3" | "float4") {
            return Ok(None);
        }
        let numbers = self.posed.numbers(value, &mut self.draft.reading.budget)?;
        let at = |i: usize, default: f64| {
            let number = numbers.get(i).copied().unwrap_or(default);
            if number > 0.0 { number.min(1e12) as f32 } else { 0.0 }
        };
        Ok(Some([at(0, 0.0), at(1, 0.0), at(2, 0.0), at(3, 1.0)]))
    }

    pub(super) fn number(&self, name: &str) -> Option<f64> {
        self.posed.number(self.effect.value(name).filter(|value| value.name() == "float")?)
    }

    /// The texture of a part of the model; a magenta checker for one of colours that cannot be read.
    pub(super) fn map(&mut self, name: &str, is_data: bool) -> Result<Option<Texture>, FormatError> {
        match self.effect.value(name).filter(|value| value.name() == "texture") {
            Some(map) => {
                let texture = self.texture(map, is_data)?;
                Ok(texture.or_else(|| (!is_data).then(|| Texture::missing(""))))
            }
            None => Ok(None),
        }
    }

    /// The texture of a texture element; `None`, with a warning, if it cannot be read.
    pub(super) fn texture(
        &mut self,
        map: Element<'d>,
        is_data: bool,
    ) -> Result<Option<Texture>, FormatError> {
        let PrincipledDraft { reading, sink, .. } = &mut self.draft;
        let texture = match picture(map, self.effect, is_data, self.posed, reading) {
            Ok(texture) => texture,
            Err(error @ FormatError::TooLarge { .. }) => return Err(error),
            Err(error) => {
                let what = if is_data { "is left out" } else { "is replaced by a magenta checker" };
                sink.diagnostics.note(&format!("a texture {what}: {}", error.without_place()), || map.at());
                return Ok(None);
            }
        };
        let set = map.attribute("texcoord");
        let second_uv = set.is_some_and(|set| self.worn.second_set.contains(&set));
        if set.is_some_and(|set| self.worn.further_sets.contains(&set)) {
            let what = "a texture has a third set of texture coordinates, and is placed by the first: use one of the first two";
            sink.diagnostics.note(what, || map.at());
        }
        Ok(Some(Texture { second_uv, ..texture }))
    }
}
