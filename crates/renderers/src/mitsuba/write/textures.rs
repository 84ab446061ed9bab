//! Writes textures.

use super::document::{Document, numbers};
use bilux_import::FormatError;
use bilux_import::output::values::{colour, texture};
use bilux_import::output::writing::Writing;
use bilux_math::Rgb;
use bilux_scene::texture::{Filter, Wrap};
use bilux_scene::{Spec, Texture};

impl Document<'_> {
    /// A colour, or a texture of colours, under a key, as the property of this name.
    pub(super) fn colours(
        &mut self,
        spec: &Spec,
        key: &str,
        default: Rgb,
        name: &str,
        writing: &mut Writing,
    ) -> Result<(), FormatError> {
        match texture(spec, key).and_then(|i| self.scene.textures.get(i)).cloned() {
            Some(picture) => self.texture(name, &picture, writing),
            None => {
                self.rgb(name, colour(spec, key).unwrap_or(default));
                Ok(())
            }
        }
    }

    /// Writes a number, or a texture of numbers, under a key, as the property of this name.
    pub(super) fn numbers_of(
        &mut self,
        spec: &Spec,
        key: &str,
        default: f32,
        name: &str,
        writing: &mut Writing,
    ) -> Result<(), FormatError> {
        match texture(spec, key).and_then(|i| self.scene.textures.get(i)).cloned() {
            Some(picture) => self.texture(name, &picture, writing),
            None => {
                self.number(name, spec.number(key).unwrap_or(default));
                Ok(())
            }
        }
    }

    /// A texture, whose factor, channel and threshold are part of its file.
    pub(super) fn texture(
        &mut self,
        name: &str,
        texture: &Texture,
        writing: &mut Writing,
    ) -> Result<(), FormatError> {
        let file = writing.texture_file(texture)?;
        if texture.second_uv {
            writing.warn("Mitsuba files store one set of texture coordinates: the second is left out");
        }
        if texture.threshold.is_some() {
            writing.warn("cut-outs get the hard edges of their texels");
        }
        self.open(&format!("texture type=\"bitmap\" name=\"{name}\""));
        self.text("filename", &file);
        if texture.is_data {
            self.flag("raw", true);
        }
        if texture.filter == Filter::Nearest {
            self.text("filter_type", "nearest");
        }
        match texture.wrap {
            [Wrap::Repeat, Wrap::Repeat] => {}
            [Wrap::Clamp, Wrap::Clamp] => self.text("wrap_mode", "clamp"),
            [Wrap::Mirror, Wrap::Mirror] => self.text("wrap_mode", "mirror"),
            _ => writing.warn("textures with different wrap modes are written as repeating"),
        }
        if let Some(transform) = &texture.transform {
            let [a, b, c, d, x, y] = transform.to_array();
            self.open("transform name=\"to_uv\"");
            let rows = [[a, c, 0.0, x], [b, d, 0.0, y], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
            self.line(&format!("<matrix value=\"{}\"/>", numbers(rows.as_flattened())));
            self.close("transform");
        }
        self.close("texture");
        Ok(())
    }
}
