//! Parameters from inputs.

use super::draft::Draft;
use super::network::Input;
use super::textures::{Painted, Taken, painted};
use bilux_import::FormatError;
use bilux_scene::texture::Channel;

impl Draft<'_, '_> {
    /// Sets a colour by an input: a texture, the colours of vertices, or a constant, times a factor. False if there is none.
    pub(super) fn set_colour(&mut self, key: &str, name: &str, factor: f32) -> Result<bool, FormatError> {
        match self.input(name)? {
            Input::Node(node, output) => {
                let taken = Taken { is_data: false, factor, threshold: None };
                match painted(self, node, &output, taken)? {
                    Some(Painted::Texture(texture)) => self.set_texture(key, texture)?,
                    Some(Painted::Constant(colour)) => self.set(key, colour.map(|c| c.max(0.0))),
                    None => return Ok(false),
                }
                Ok(true)
            }
            Input::Value(_) => {
                let Some(colour) = self.colour(name)? else { return Ok(false) };
                self.set(key, colour.map(|c| if c.is_finite() { c.max(0.0) } else { 0.0 }) * factor);
                Ok(true)
            }
            Input::Nothing => Ok(false),
        }
    }

    /// Sets a number by an input: a texture or a constant, times a factor. False if there is none.
    pub(super) fn set_number(&mut self, key: &str, name: &str, factor: f32) -> Result<bool, FormatError> {
        match self.input(name)? {
            Input::Node(node, output) => {
                let taken = Taken { is_data: true, factor, threshold: None };
                match painted(self, node, &output, taken)? {
                    Some(Painted::Constant(colour)) => self.set(key, colour.r),
                    Some(Painted::Texture(mut texture)) => {
                        texture.channel = texture.channel.or(Some(Channel::R));
                        self.set_texture(key, texture)?;
                    }
                    None => return Ok(false),
                }
                Ok(true)
            }
            Input::Value(_) => {
                let Some(number) = self.number(name)? else { return Ok(false) };
                self.set(key, number as f32 * factor);
                Ok(true)
            }
            Input::Nothing => Ok(false),
        }
    }
}
