//! Textures: an image, its sampler, and its placement.

use crate::document::json::JsonNode;
use crate::document::json_document::Document;
use crate::materials::pictures::{Named, Pictures};
use bilux_import::FormatError;
use bilux_import::input::reading::Reading;
use bilux_import::input::sink::Sink;
use bilux_math::Rgb;
use bilux_scene::texture::{Channel, Filter, UvTransform, Wrap};
use bilux_scene::{Texture, Value};
use std::sync::Arc;

/// The texture coordinate sets of the file that become the mesh's first and second set.
pub(crate) type UvSets = [Option<usize>; 2];

/// Reads textures, and adds them to the scene.
pub(crate) struct Textures<'a, 'o> {
    pub(crate) document: &'a Document<'a>,
    pub(crate) pictures: &'a mut Pictures,
    pub(crate) reading: &'a mut Reading<'o>,
    pub(crate) sink: &'a mut Sink,
}

/// The channels of an image that a texture uses, and the factor that multiplies them.
#[derive(Clone, Copy)]
pub(crate) struct ChannelSelection {
    pub(crate) is_data: bool,
    pub(crate) channel: Option<Channel>,
    pub(crate) factor: Rgb,
    pub(crate) threshold: Option<f32>,
}

impl ChannelSelection {
    /// Display-encoded colours.
    pub(crate) fn colours(factor: Rgb) -> ChannelSelection {
        ChannelSelection { is_data: false, channel: None, factor, threshold: None }
    }

    /// The numbers of one channel.
    pub(crate) fn channel(channel: Channel, factor: f64) -> ChannelSelection {
        ChannelSelection {
            is_data: true,
            channel: Some(channel),
            factor: Rgb::grey(factor as f32),
            threshold: None,
        }
    }

    /// The numbers of all channels.
    pub(crate) const VECTORS: ChannelSelection =
        ChannelSelection { is_data: true, channel: None, factor: Rgb::WHITE, threshold: None };
}

impl<'a> Textures<'a, '_> {
    /// The texture that a material refers to. `uv_sets` are the texture coordinate sets in use by the material so far.
    pub(crate) fn looked_up(
        &mut self,
        info: JsonNode<'a>,
        taken: ChannelSelection,
        uv_sets: &mut UvSets,
    ) -> Result<Texture, FormatError> {
        let node = self.document.named("textures", info.need("index")?)?;
        let lies = info.extension("KHR_texture_transform");
        let set = match lies.and_then(|lies| lies.get("texCoord")) {
            Some(set) => set.as_count()?,
            None => info.count("texCoord")?.unwrap_or(0),
        };
        let slot = uv_sets.iter().position(|slot| slot.is_none_or(|known| known == set));
        match slot {
            Some(slot) => uv_sets[slot] = Some(set),
            None => {
                let what = "a material uses three sets of texture coordinates, but only two are supported";
                self.sink.diagnostics.note(what, || info.at());
            }
        }
        let mut texture = match self.picture(node, taken.is_data)? {
            Some((name, image)) => {
                Texture { factor: taken.factor, ..Texture::of(&name, image, taken.is_data) }
            }
            None => Texture::missing(node.name()),
        };
        (texture.channel, texture.threshold) = (taken.channel, taken.threshold);
        texture.second_uv = slot == Some(1);
        if let Some(index) = node.get("sampler") {
            let sampler = self.document.named("samplers", index)?;
            texture.wrap = [wrap(sampler, "wrapS")?, wrap(sampler, "wrapT")?];
            if sampler.count("magFilter")? == Some(9728) {
                texture.filter = Filter::Nearest;
            }
        }
        if let Some(lies) = lies {
            let pair = |pair: [f64; 2]| pair.map(|x| x as f32);
            texture.transform = Some(UvTransform::new(
                pair(lies.numbers::<2>("offset")?.unwrap_or([0.0; 2])),
                lies.number("rotation")?.unwrap_or(0.0) as f32,
                pair(lies.numbers::<2>("scale")?.unwrap_or([1.0; 2])),
            ));
        }
        Ok(texture)
    }

    fn picture(&mut self, texture: JsonNode<'a>, is_data: bool) -> Result<Option<Named>, FormatError> {
        self.pictures.of_texture(texture, is_data, self.document, self.reading, &mut self.sink.diagnostics)
    }

    /// Adds a texture to the scene.
    pub(crate) fn add(&mut self, texture: Texture) -> Result<Value, FormatError> {
        self.take_bytes(size_of::<[Texture; 2]>() as u64)?;
        self.sink.scene.textures.push(Arc::new(texture));
        Ok(Value::Texture(self.sink.scene.textures.len() - 1))
    }

    /// Takes memory for texels.
    pub(crate) fn take_bytes(&mut self, bytes: u64) -> Result<(), FormatError> {
        self.reading.budget.take_bytes(bytes, self.document.file())
    }
}

fn wrap<'d>(sampler: JsonNode<'d>, key: &'d str) -> Result<Wrap, FormatError> {
    Ok(match sampler.count(key)? {
        None | Some(10497) => Wrap::Repeat,
        Some(33071) => Wrap::Clamp,
        Some(33648) => Wrap::Mirror,
        Some(other) => {
            let message = format!("{other} is not a wrapping mode: use 10497, 33071 or 33648");
            return Err(FormatError::malformed(message, sampler.at_key(key)));
        }
    })
}
