//! A material under construction.

use super::textures::Textures;
use super::worn::Worn;
use crate::fbx::document::Index;
use crate::fbx::posed::Posed;
use bilux_import::FormatError;
use bilux_import::appearance::principled_draft::PrincipledDraft;
use bilux_math::Rgb;
use bilux_math::colour::srgb_decode;
use bilux_scene::texture::Channel;
use bilux_scene::{Texture, Value};

/// A draft, and where its textures come from.
pub(super) struct Draft<'a, 'd, 'o> {
    pub(super) inner: PrincipledDraft<'a, 'o>,
    pub(super) worn: Worn<'d>,
    pub(super) posed: &'a Posed<'d>,
    textures: &'a mut Textures,
}

impl<'a, 'd, 'o> Draft<'a, 'd, 'o> {
    pub(super) fn new(
        inner: PrincipledDraft<'a, 'o>,
        worn: Worn<'d>,
        posed: &'a Posed<'d>,
        textures: &'a mut Textures,
    ) -> Draft<'a, 'd, 'o> {
        Draft { inner, worn, posed, textures }
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
        self.inner.set(key, value);
    }

    /// Sets a colour, or a factor on that of a texture.
    pub(super) fn colour(&mut self, key: &str, factor: Rgb, map: Option<Index>) -> Result<(), FormatError> {
        let texture = match map {
            Some(map) => Some(self.texture(map, false)?.unwrap_or_else(|| Texture::missing(""))),
            None => None,
        };
        self.inner.colour(key, factor, texture)
    }

    /// Sets a number, or a factor on that of a channel of a texture. A texture that cannot be read leaves the number.
    pub(super) fn number(
        &mut self,
        key: &str,
        factor: f64,
        map: Option<Index>,
        channel: Channel,
    ) -> Result<(), FormatError> {
        let texture = map.map(|map| self.texture(map, true)).transpose()?.flatten();
        self.inner.number(key, factor, texture, channel)
    }

    /// The texture of an object; `None`, with a warning, for one of numbers that cannot be read.
    pub(super) fn texture(&mut self, index: Index, is_data: bool) -> Result<Option<Texture>, FormatError> {
        let PrincipledDraft { reading, sink, .. } = &mut self.inner;
        self.textures.read(index, is_data, self.worn.second_set, self.posed, reading, sink)
    }

    /// Sets the normal from a map of normals, or from one of heights.
    pub(super) fn normals(&mut self, map: Option<Index>, scale: f64) -> Result<(), FormatError> {
        let texture = map.map(|map| self.texture(map, true)).transpose()?.flatten();
        self.inner.normals(texture, scale)
    }
}
