//! Writes textures.

use super::document::Document;
use bilux_import::FormatError;
use bilux_import::output::writing::Writing;
use bilux_math::{Rgb, Vec2};
use bilux_pictures::{Alpha, ColourSpace, Picture, write_bytes};
use bilux_scene::Texture;
use bilux_scene::texture::{Filter, Wrap};
use std::fmt::Write;

/// A function that changes the texels of an image.
#[derive(Clone, Copy)]
pub(super) struct Change<'c> {
    /// Distinct functions have distinct names.
    pub(super) name: &'static str,
    pub(super) of: &'c dyn Fn(Rgb) -> Rgb,
}

/// No change.
pub(super) const AS_IT_IS: Change = Change { name: "", of: &|texel| texel };

/// Interpretation of the texels of a texture.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum TexelMeaning {
    Colours,
    Numbers,
}

impl Document<'_> {
    /// The name of a texture after a change; `None` if the texture does not exist.
    pub(super) fn texture(
        &mut self,
        index: usize,
        holds: TexelMeaning,
        change: Change,
        writing: &mut Writing,
    ) -> Result<Option<String>, FormatError> {
        let Some(texture) = self.scene.textures.get(index).cloned() else { return Ok(None) };
        let is_number = holds == TexelMeaning::Numbers;
        let holds = if is_number { "float" } else { "spectrum" };
        let key = format!("{index} {holds} {}", change.name);
        if let Some(name) = self.textures.get(&key) {
            return Ok(Some(name.clone()));
        }
        let file = self.picture(&texture, is_number, change, writing)?;
        let name = self.name(&format!("texture {}", self.textures.len() + 1), "");
        let mut line = format!("Texture \"{name}\" \"{holds}\" \"imagemap\" \"string filename\" \"{file}\"");
        if (texture.is_data || is_number) && file.ends_with("png") {
            line += " \"string encoding\" \"linear\"";
        }
        if texture.filter == Filter::Nearest {
            line += " \"string filter\" \"point\"";
        }
        if texture.second_uv {
            writing.warn("pbrt files store one set of texture coordinates: the second is left out");
        }
        match texture.wrap {
            [Wrap::Repeat, Wrap::Repeat] => {}
            [Wrap::Clamp, Wrap::Clamp] => line += " \"string wrap\" \"clamp\"",
            _ => writing.warn("textures with mirrored or different wrap modes are written as repeating"),
        }
        if let Some(transform) = &texture.transform {
            // In pbrt, v points up.
            let at = |u, v| transform.apply(Vec2::new(u, v));
            let (zero, u, v) = (at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0));
            if (u.y - zero.y).abs() + (v.x - zero.x).abs() > 1e-5 {
                writing.warn("pbrt files cannot store rotated textures: they are written without rotation");
            }
            let scale = [u.x - zero.x, v.y - zero.y];
            let shift = [zero.x, 1.0 - scale[1] - zero.y];
            let parts =
                [("uscale", scale[0]), ("vscale", scale[1]), ("udelta", shift[0]), ("vdelta", shift[1])];
            for (key, number) in parts {
                let _ = write!(line, " \"float {key}\" [ {number} ]");
            }
        }
        self.line(&line);
        self.textures.insert(key, name.clone());
        Ok(Some(name))
    }

    /// The file of an image; an image with texels brighter than white becomes an EXR.
    pub(super) fn picture(
        &mut self,
        texture: &Texture,
        is_number: bool,
        change: Change,
        writing: &mut Writing,
    ) -> Result<String, FormatError> {
        let one = |texel: Rgb| match (is_number, texture.channel) {
            (true, Some(_)) => Rgb::grey(texel.r),
            (true, None) => Rgb::grey(texel.luminance()),
            _ => texel,
        };
        let texels: Vec<Rgb> = texture.texels().map(|texel| (change.of)(one(texel))).collect();
        let is_bright = texels.iter().any(|texel| !texel.is_finite() || texel.max_channel() > 1.0);
        let format = if is_bright { "exr" } else { "png" };
        let mut picture = Picture::from_rgb(texture.width(), texture.height(), texels)?;
        if (texture.is_data || is_number) && !is_bright {
            // Texels are written as stored, so that no transfer curve is applied to numbers.
            picture.colour_space = ColourSpace::Srgb;
        }
        picture.alpha = Alpha::Straight;
        let bytes = write_bytes(format, &picture, &bilux_pictures::WriteOptions::default())?;
        Ok(writing.add_numbered("texture", writing.count() + 1, format, bytes))
    }
}
