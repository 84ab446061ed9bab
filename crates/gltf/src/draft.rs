//! A material under construction.

use super::json::JsonNode;
use super::textures::{ChannelSelection, Textures, UvSets};
use bilux_import::FormatError;
use bilux_math::Rgb;
use bilux_scene::texture::Channel;
use bilux_scene::{Span, Spec, Texture, Value};

/// Parameters of `principled`, whether or not that has them all, and the textures that they refer to.
pub(super) struct Draft<'a, 'o> {
    pub(super) spec: Spec,
    pub(super) alpha: Alpha,
    /// The sets of texture coordinates in use so far.
    pub(super) uv_sets: UvSets,
    /// Facts about the mesh that the material is on.
    pub(super) on: OnMesh,
    pub(super) textures: Textures<'a, 'o>,
}

/// Facts that a material has to know of the mesh that it is on.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct OnMesh {
    /// True if transmission without a thickness means a solid.
    pub(super) is_solid: bool,
    /// True if the vertices have alpha, with which a threshold is compared only after it has been multiplied.
    pub(super) has_alpha: bool,
}

/// Effect of alpha on a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Alpha {
    /// Nothing.
    #[default]
    Opaque,
    /// Alpha is the opacity.
    Blend,
    /// Below this the surface is not there, elsewhere it is opaque.
    Mask(f32),
}

impl<'a> Draft<'a, '_> {
    pub(super) fn set(&mut self, key: &str, value: impl Into<Value>, at: Span) {
        self.spec.parameters.set_at(key, value.into(), at);
    }

    pub(super) fn value(&self, key: &str) -> Option<&Value> {
        self.spec.parameters.find(key).map(|(value, _)| value)
    }

    pub(super) fn has(&self, key: &str) -> bool {
        self.value(key).is_some()
    }

    pub(super) fn number(&self, key: &str) -> Option<f64> {
        match self.value(key)? {
            Value::Number(x) => Some(*x),
            _ => None,
        }
    }

    /// Sets a colour, which multiplies that of a picture if there is one.
    pub(super) fn colour(
        &mut self,
        key: &str,
        factor: Rgb,
        picture: Option<JsonNode<'a>>,
        at: &Span,
    ) -> Result<(), FormatError> {
        let value = match picture {
            Some(info) => self.texture(info, ChannelSelection::colours(factor))?,
            None => factor.into(),
        };
        self.set(key, value, picture.map_or_else(|| at.clone(), |info| info.at()));
        Ok(())
    }

    /// Sets a number, which multiplies one channel of a picture if there is one.
    pub(super) fn scalar(
        &mut self,
        key: &str,
        factor: f64,
        picture: Option<JsonNode<'a>>,
        channel: Channel,
        at: &Span,
    ) -> Result<(), FormatError> {
        let value = match picture {
            Some(info) if factor != 0.0 => self.texture(info, ChannelSelection::channel(channel, factor))?,
            _ => Value::Number(factor),
        };
        self.set(key, value, picture.map_or_else(|| at.clone(), |info| info.at()));
        Ok(())
    }

    /// Adds the texture that the file refers to here.
    pub(super) fn texture(
        &mut self,
        info: JsonNode<'a>,
        taken: ChannelSelection,
    ) -> Result<Value, FormatError> {
        let texture = self.looked_up(info, taken)?;
        self.textures.add(texture)
    }

    /// The texture that the file refers to here.
    pub(super) fn looked_up(
        &mut self,
        info: JsonNode<'a>,
        taken: ChannelSelection,
    ) -> Result<Texture, FormatError> {
        self.textures.looked_up(info, taken, &mut self.uv_sets)
    }

    /// Counts something odd about the material.
    pub(super) fn note(&mut self, what: &str, at: impl FnOnce() -> Span) {
        self.textures.sink.oddities.note(what, at);
    }

    /// Counts something that is no fault, and that changes nothing in the picture.
    pub(super) fn remark(&mut self, what: &str, at: impl FnOnce() -> Span) {
        self.textures.sink.oddities.remark(what, at);
    }
}
