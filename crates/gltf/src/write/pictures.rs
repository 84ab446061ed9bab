//! Writes textures as PNG images, with several numbers packed into the channels of one image.

use super::Document;
use bilux_import::FormatError;
use bilux_import::output::writing::Writing;
use bilux_math::Rgb;
use bilux_math::colour::srgb_encode;
use bilux_pictures::{Alpha, ColourSpace, Picture, write_bytes};
use bilux_scene::texture::{Filter, Texels, Wrap};
use bilux_scene::{Texture, Value};
use serde_json::{Value as Json, json};
use std::sync::Arc;

/// The source of one channel of an image: a texture's numbers, or a constant.
#[derive(Clone)]
pub(super) enum Channel {
    Even(f32),
    Numbers(Arc<Texture>),
}

impl Channel {
    /// The number or texture of a parameter.
    pub(super) fn of(document: &Document, value: Option<&Value>, default: f32) -> Channel {
        match value {
            Some(Value::Texture(index)) => match document.scene.textures.get(*index) {
                Some(texture) => Channel::Numbers(texture.clone()),
                None => Channel::Even(default),
            },
            Some(Value::Number(x)) => Channel::Even(*x as f32),
            Some(Value::Integer(i)) => Channel::Even(*i as f32),
            _ => Channel::Even(default),
        }
    }

    pub(super) fn texture(&self) -> Option<&Arc<Texture>> {
        match self {
            Channel::Numbers(texture) => Some(texture),
            Channel::Even(_) => None,
        }
    }

    /// The value at a texel of an image of this size, as a byte.
    fn byte(&self, x: usize, y: usize, size: (usize, usize)) -> f32 {
        match self {
            Channel::Even(number) => number.clamp(0.0, 1.0),
            Channel::Numbers(texture) => {
                let (at_x, at_y) = (x * texture.width() / size.0, y * texture.height() / size.1);
                let texel = texture.texel(at_x, at_y);
                let number = if texture.channel.is_some() { texel.r } else { texel.luminance() };
                number.clamp(0.0, 1.0)
            }
        }
    }
}

impl Document<'_> {
    /// An image of colours with an opacity.
    pub(super) fn colours(
        &mut self,
        texture: &Arc<Texture>,
        opacity: &Channel,
        writing: &mut Writing,
    ) -> Result<Json, FormatError> {
        if texture.texels().any(|texel| texel.max_channel() > 1.0) {
            writing.warn("texels brighter than white are written as white");
        }
        let encode =
            |c: f32| if texture.is_data { c.clamp(0.0, 1.0) } else { srgb_encode(c.clamp(0.0, 1.0)) };
        let size = (texture.width(), texture.height());
        let opaque = matches!(opacity, Channel::Even(_));
        self.picture(texture, size, !opaque, |x, y| {
            let texel = texture.texel(x, y);
            // 8-bit texels are written unchanged.
            let [r, g, b] = match &texture.image.texels {
                Texels::Bytes(bytes) if texture.factor == Rgb::WHITE && texture.channel.is_none() => {
                    let [r, g, b, _] = bytes[y * size.0 + x];
                    [r, g, b].map(|byte| f32::from(byte) / 255.0)
                }
                _ => [encode(texel.r), encode(texel.g), encode(texel.b)],
            };
            [r, g, b, if opaque { 1.0 } else { opacity.byte(x, y, size) }]
        })
    }

    /// An image of numbers; `None` if none of the channels is a texture.
    pub(super) fn numbers(&mut self, channels: [&Channel; 4]) -> Result<Option<Json>, FormatError> {
        let textures: Vec<&Arc<Texture>> = channels.iter().filter_map(|channel| channel.texture()).collect();
        let Some(first) = textures.first() else { return Ok(None) };
        let largest = |side: fn(&Texture) -> usize| textures.iter().map(|t| side(t)).max().unwrap_or(1);
        let size = (largest(Texture::width), largest(Texture::height));
        let has_alpha = channels[3].texture().is_some();
        self.picture(first, size, has_alpha, |x, y| channels.map(|channel| channel.byte(x, y, size)))
            .map(Some)
    }

    /// Adds an image with a texture's sampler; returns the reference for a material.
    fn picture(
        &mut self,
        like: &Texture,
        (width, height): (usize, usize),
        has_alpha: bool,
        texel: impl Fn(usize, usize) -> [f32; 4],
    ) -> Result<Json, FormatError> {
        let mut picture = Picture::new(width, height)?;
        (picture.colour_space, picture.alpha) = (ColourSpace::Srgb, Alpha::Straight);
        let texels: Vec<[f32; 4]> = (0..width * height).map(|i| texel(i % width, i / width)).collect();
        for (i, name) in ["R", "G", "B", "A"].into_iter().enumerate().take(if has_alpha { 4 } else { 3 }) {
            picture.push_channel(name, texels.iter().map(|texel| texel[i]).collect())?;
        }
        let png = write_bytes("png", &picture, &bilux_pictures::WriteOptions::default())?;
        let view = self.buffer.view(&png, None);
        let image = self.push("images", json!({ "bufferView": view, "mimeType": "image/png" }));
        let sampler = self.sampler(like);
        let index = self.push("textures", json!({ "source": image, "sampler": sampler }));
        let mut info = json!({ "index": index });
        if like.second_uv {
            info["texCoord"] = json!(1);
        }
        if let Some(transform) = &like.transform {
            let (offset, rotation, scale) = transform.parts();
            let extension = self.uses("KHR_texture_transform");
            info["extensions"] =
                json!({ extension: { "offset": offset, "rotation": rotation, "scale": scale } });
        }
        Ok(info)
    }

    fn sampler(&mut self, texture: &Texture) -> usize {
        let wrap = |wrap| match wrap {
            Wrap::Repeat => 10497,
            Wrap::Mirror => 33648,
            Wrap::Clamp => 33071,
        };
        let filter = if texture.filter == Filter::Nearest { 9728 } else { 9729 };
        let [s, t] = texture.wrap.map(wrap);
        let key = format!("sampler {s} {t} {filter}");
        if let Some(known) = self.known.get(&key) {
            return *known;
        }
        let sampler = json!({ "wrapS": s, "wrapT": t, "magFilter": filter });
        let index = self.push("samplers", sampler);
        self.known.insert(key, index);
        index
    }
}
