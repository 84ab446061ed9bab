//! A material under construction.

use crate::document::json::JsonNode;
use crate::materials::textures::{ChannelSelection, Textures, UvSets};
use bilux_import::FormatError;
use bilux_math::Rgb;
use bilux_scene::texture::Channel;
use bilux_scene::{Span, Spec, Texture, Value};

/// Parameters of `principled`, whether or not that has them all, and the textures that they refer to.
pub(crate) struct Draft<'a, 'o> {
    pub(crate) spec: Spec,
    pub(crate) alpha: Alpha,
    /// The sets of texture coordinates in use so far.
    pub(crate) uv_sets: UvSets,
    /// Facts about the mesh that the material is on.
    pub(crate) on: OnMesh,
    pub(crate) textures: Textures<'a, 'o>,
}

/// Facts that a material has to know of the mesh that it is on.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct OnMesh {
    /// True if transmission without a thickness means a solid.
    pub(crate) is_solid: bool,
    /// True if the vertices have alpha, with which a threshold is compared only after it has been multiplied.
    pub(crate) has_alpha: bool,
}

/// Effect of alpha on a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Alpha {
    /// Nothing.
    #[default]
    Opaque,
    /// Alpha is the opacity.
    Blend,
    /// Below this the surface is not there, elsewhere it is opaque.
    Mask(f32),
}

impl<'a> Draft<'a, '_> {
    pub(crate) fn set(&mut self, key: &str, value: impl Into<Value>, at: Span) {
        self.spec.parameters.set_at(key, value.into(), at);
    }

    pub(crate) fn value(&self, key: &str) -> Option<&Value> {
        self.spec.parameters.find(key).map(|(value, _)| value)
    }

    pub(crate) fn has(&self, key: &str) -> bool {
        self.value(key).is_some()
    }

    pub(crate) fn number(&self, key: &str) -> Option<f64> {
        match self.value(key)? {
            Value::Number(x) => Some(*x),
            _ => None,
        }
    }

    /// Sets a colour, which multiplies that of a picture if there is one.
    pub(crate) fn colour(
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
    pub(crate) fn scalar(
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
    pub(crate) fn texture(
        &mut self,
        info: JsonNode<'a>,
        taken: ChannelSelection,
    ) -> Result<Value, FormatError> {
        let texture = self.looked_up(info, taken)?;
        self.textures.add(texture)
    }

    /// The texture that the file refers to here.
    pub(crate) fn looked_up(
        &mut self,
        info: JsonNode<'a>,
        taken: ChannelSelection,
    ) -> Result<Texture, FormatError> {
        self.textures.looked_up(info, taken, &mut self.uv_sets)
    }

    /// Counts something odd about the material.
    pub(crate) fn note(&mut self, what: &str, at: impl FnOnce() -> Span) {
        self.textures.sink.diagnostics.note(what, at);
    }

    /// Counts something that is no fault, and that changes nothing in the picture.
    pub(crate) fn remark(&mut self, what: &str, at: impl FnOnce() -> Span) {
        self.textures.sink.diagnostics.remark(what, at);
    }
}
