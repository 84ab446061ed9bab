//! A material under construction.

use super::network::{Input, input};
use crate::layers::value::Text;
use crate::stage::Stage;
use bilux_import::FormatError;
use bilux_import::geometry::displacement::Displacement;
use bilux_import::input::reading::Reading;
use bilux_import::input::sink::Sink;
use bilux_math::Rgb;
use bilux_scene::{Spec, Texture, Value};
use std::sync::Arc;

/// A material, and what it needs of the surfaces that have it.
#[derive(Clone, Debug)]
pub(crate) struct Shaded {
    pub(crate) spec: Spec,
    /// The primvars that its textures are placed by.
    pub(crate) uvs: [Option<Text>; 2],
    pub(crate) uses_colours: bool,
    pub(crate) uses_opacities: bool,
    /// The colour of meshes that have none, if it uses theirs.
    pub(crate) without_colours: Option<Rgb>,
    pub(crate) has_direction: bool,
    /// The map that moves its surfaces.
    pub(crate) displacement: Option<Displacement>,
}

/// Parameters of `principled`, and where they come from.
pub(super) struct Draft<'a, 'o> {
    pub(super) shaded: Shaded,
    pub(super) stage: &'a Stage<'a>,
    pub(super) shader: u32,
    pub(super) reading: &'a mut Reading<'o>,
    pub(super) sink: &'a mut Sink,
}

impl Draft<'_, '_> {
    pub(super) fn set(&mut self, key: &str, value: impl Into<Value>) {
        let at = self.stage.at(self.shader);
        self.shaded.spec.parameters.set_at(key, value.into(), at);
    }

    pub(super) fn input(&mut self, name: &str) -> Result<Input, FormatError> {
        input(self.stage, self.shader, name, &mut self.reading.budget)
    }

    /// A number that no texture gives.
    pub(super) fn number(&mut self, name: &str) -> Result<Option<f64>, FormatError> {
        Ok(match self.input(name)? {
            Input::Value(found) => found.value.number().filter(|x| x.is_finite()),
            _ => None,
        })
    }

    /// A colour that no texture gives.
    pub(super) fn colour(&mut self, name: &str) -> Result<Option<Rgb>, FormatError> {
        Ok(match self.input(name)? {
            Input::Value(found) => match found.value.tuple::<3>() {
                Some(rgb) => Some(Rgb::from_array(rgb.map(|x| x as f32))),
                None => found.value.number().map(|x| Rgb::grey(x as f32)),
            },
            _ => None,
        })
    }

    /// True if another shader gives an input.
    pub(super) fn is_textured(&mut self, name: &str) -> Result<bool, FormatError> {
        Ok(matches!(self.input(name)?, Input::Node(..)))
    }

    pub(super) fn set_texture(&mut self, key: &str, texture: Texture) -> Result<(), FormatError> {
        self.reading.budget.take_bytes(size_of::<[Texture; 2]>() as u64, &self.stage.layers[0].name)?;
        self.sink.scene.textures.push(Arc::new(texture));
        let index = self.sink.scene.textures.len() - 1;
        self.set(key, Value::Texture(index));
        Ok(())
    }

    /// Names something that the picture does not show.
    pub(super) fn not_shown(&mut self, what: &str) {
        let (stage, shader) = (self.stage, self.shader);
        self.sink.diagnostics.not_shown(what, || stage.at(shader));
    }
}
