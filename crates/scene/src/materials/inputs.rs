//! Inputs of a material, besides its own parameters.

use crate::messages::error::SceneError;
use crate::parameters::{Reader, Spec};
use crate::texture::{ColourMap, NumberMap, Texture};
use std::sync::Arc;

/// The inputs of a material.
#[derive(Clone, Copy, Debug, Default)]
pub struct MaterialInputs<'a> {
    /// The scene's textures.
    pub textures: &'a [Arc<Texture>],
    /// The scene's materials, for those that refer to others.
    pub materials: &'a [Spec],
    /// The nesting depth of this material in mixes.
    pub(super) depth: usize,
}

impl<'a> MaterialInputs<'a> {
    /// The inputs from a whole scene.
    pub fn new(textures: &'a [Arc<Texture>], materials: &'a [Spec]) -> MaterialInputs<'a> {
        MaterialInputs { textures, materials, depth: 0 }
    }
}

/// The colour or texture under a key.
pub(super) fn colour_map(
    reader: &Reader,
    key: &str,
    inputs: &MaterialInputs,
) -> Result<ColourMap, SceneError> {
    Ok(ColourMap { colour: reader.colour(key), texture: texture(reader, key, inputs)? })
}

/// The number or texture under a key.
pub(super) fn number_map(
    reader: &Reader,
    key: &str,
    inputs: &MaterialInputs,
) -> Result<NumberMap, SceneError> {
    let range = reader.range(key).map(|x| x as f32);
    Ok(NumberMap { number: reader.number(key), range, texture: texture(reader, key, inputs)? })
}

/// The texture under a key, if there is one.
pub(super) fn texture(
    reader: &Reader,
    key: &str,
    inputs: &MaterialInputs,
) -> Result<Option<Arc<Texture>>, SceneError> {
    let Some(index) = reader.texture(key) else { return Ok(None) };
    let missing = || SceneError::invalid(format!("no texture {index}"), reader.span(key));
    inputs.textures.get(index).cloned().map(Some).ok_or_else(missing)
}
