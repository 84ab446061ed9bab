//! A material under construction.

use super::textures::Textures;
use super::worn::Worn;
use crate::FormatError;
use crate::fbx::document::Index;
use crate::fbx::posed::Posed;
use crate::reading::Reading;
use crate::sink::Sink;
use bilux_math::Rgb;
use bilux_math::colour::srgb_decode;
use bilux_scene::texture::Channel;
use bilux_scene::{Spec, Texture, Value};
use std::sync::Arc;

/// Parameters of `principled`, and the textures that they refer to.
pub(super) struct Draft<'a, 'd, 'o> {
    pub(super) spec: Spec,
    pub(super) worn: Worn<'d>,
    pub(super) posed: &'a Posed<'d>,
    textures: &'a mut Textures,
    reading: &'a mut Reading<'o>,
    pub(super) sink: &'a mut Sink,
}

impl<'a, 'd, 'o> Draft<'a, 'd, 'o> {
    pub(super) fn new(
        worn: Worn<'d>,
        posed: &'a Posed<'d>,
        textures: &'a mut Textures,
        reading: &'a mut Reading<'o>,
        sink: &'a mut Sink,
    ) -> Draft<'a, 'd, 'o> {
        let spec = Spec::new("default", "principled");
        Draft { spec, worn, posed, textures, reading, sink }
    }

    /// The texture that is connected to a property of the material.
    pub(super) fn map(&self, property: &str) -> Option<Index> {
        let links = self.posed.document.sources(self.worn.material?);
        let found = links.iter().find(|link| link.property == Some(property.as_bytes()))?;
        matches!(self.posed.document.class(found.source), b"Texture" | b"LayeredTexture")
            .then_some(found.source)
    }

    /// A colour of the file in linear light: those of Blender are, those of others are as displays show them.
    pub(super) fn linear(&self, colour: Rgb) -> Rgb {
        if self.posed.document.settings.is_of_blender { colour } else { colour.map(srgb_decode) }
    }

    pub(super) fn set(&mut self, key: &str, value: impl Into<Value>) {
        self.spec.parameters.set_at(key, value.into(), self.spec.span.clone());
    }

    /// Sets a colour, or a factor on that of a texture.
    pub(super) fn colour(&mut self, key: &str, factor: Rgb, map: Option<Index>) -> Result<(), FormatError> {
        match map {
            Some(map) => {
                let texture = self.texture(map, false)?.unwrap_or_else(|| Texture::missing(""));
                self.put(key, Texture { factor, ..texture })
            }
            None => {
                self.set(key, factor);
                Ok(())
            }
        }
    }

    /// Sets a number, or a factor on that of a channel of a texture. A texture that cannot be read leaves the number.
    pub(super) fn number(
        &mut self,
        key: &str,
        factor: f64,
        map: Option<Index>,
        channel: Channel,
    ) -> Result<(), FormatError> {
        match map.map(|map| self.texture(map, true)).transpose()?.flatten() {
            Some(texture) => {
                let factor = Rgb::grey(factor as f32);
                self.put(key, Texture { factor, channel: Some(channel), ..texture })
            }
            None => {
                self.set(key, factor as f32);
                Ok(())
            }
        }
    }

    /// The texture of an object; `None`, with a warning, for one of numbers that cannot be read.
    pub(super) fn texture(&mut self, index: Index, is_data: bool) -> Result<Option<Texture>, FormatError> {
        self.textures.read(index, is_data, self.worn.second_set, self.posed, self.reading, self.sink)
    }

    /// Adds a texture to the scene, and refers to it.
    pub(super) fn put(&mut self, key: &str, texture: Texture) -> Result<(), FormatError> {
        let file = self.posed.document.file();
        self.reading.budget.take_bytes(size_of::<[Texture; 2]>() as u64, file)?;
        self.sink.scene.textures.push(Arc::new(texture));
        self.set(key, Value::Texture(self.sink.scene.textures.len() - 1));
        Ok(())
    }

    /// Sets the normal from a map of normals, or from one of heights.
    pub(super) fn normals(&mut self, map: Option<Index>, scale: f64) -> Result<(), FormatError> {
        let Some(texture) = map.map(|map| self.texture(map, true)).transpose()?.flatten() else {
            return Ok(());
        };
        if !crate::heights::holds_normals(&texture) {
            let file = self.posed.document.file();
            self.reading.budget.take::<[u8; 4]>(texture.width() * texture.height(), file)?;
            let normals = crate::heights::normals_of_heights(&texture, scale as f32);
            return self.put("normal", Texture { image: normals.image, ..texture });
        }
        self.put("normal", texture)?;
        self.set("normal_scale", scale.clamp(0.0, 10.0) as f32);
        Ok(())
    }

    /// Names something that the picture does not show.
    pub(super) fn not_shown(&mut self, what: &str) {
        let at = self.spec.span.clone();
        self.sink.oddities.not_shown(what, || at);
    }
}
