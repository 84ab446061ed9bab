//! Textures: an image, its sampler, and its placement.

use super::json::JsonNode;
use super::material::UvSets;
use super::reader::{Gltf, Named};
use super::uri::{self, Resource};
use crate::FormatError;
use crate::images::SampleMeaning;
use bilux_math::Rgb;
use bilux_scene::texture::{Channel, Filter, UvTransform, Wrap};
use bilux_scene::{Texture, Value};
use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;

/// The channels of an image that a texture uses, and the factor that multiplies them.
#[derive(Clone, Copy)]
pub(super) struct ChannelSelection {
    pub(super) is_data: bool,
    pub(super) channel: Option<Channel>,
    pub(super) factor: Rgb,
    pub(super) threshold: Option<f32>,
}

impl ChannelSelection {
    /// Display-encoded colours.
    pub(super) fn colours(factor: Rgb) -> ChannelSelection {
        ChannelSelection { is_data: false, channel: None, factor, threshold: None }
    }

    /// The numbers of one channel.
    pub(super) fn channel(channel: Channel, factor: f64) -> ChannelSelection {
        ChannelSelection {
            is_data: true,
            channel: Some(channel),
            factor: Rgb::grey(factor as f32),
            threshold: None,
        }
    }

    /// The numbers of all channels.
    pub(super) const VECTORS: ChannelSelection =
        ChannelSelection { is_data: true, channel: None, factor: Rgb::WHITE, threshold: None };
}

impl<'d> Gltf<'d, '_, '_> {
    /// Adds the texture that a material refers to. `uv_sets` are the texture coordinate sets in use by the
    /// material so far.
    pub(super) fn texture(
        &mut self,
        info: JsonNode<'d>,
        taken: ChannelSelection,
        uv_sets: &mut UvSets,
    ) -> Result<Value, FormatError> {
        let texture = self.looked_up(info, taken, uv_sets)?;
        self.add_texture(texture)
    }

    /// Adds a texture to the scene.
    pub(super) fn add_texture(&mut self, texture: Texture) -> Result<Value, FormatError> {
        self.reading.budget.take_bytes(size_of::<[Texture; 2]>() as u64, &self.file)?;
        self.scene.textures.push(Arc::new(texture));
        Ok(Value::Texture(self.scene.textures.len() - 1))
    }

    /// The texture that a material refers to.
    pub(super) fn looked_up(
        &mut self,
        info: JsonNode<'d>,
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
                self.oddities.note(what, || info.at());
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

    /// The image of a texture and its name; `None`, with a warning, if it cannot be read.
    fn picture(&mut self, texture: JsonNode<'d>, is_data: bool) -> Result<Option<Named>, FormatError> {
        let Some(index) = source(texture) else {
            let what = "a texture has no readable picture and is replaced by a magenta checker";
            self.oddities.note(what, || texture.at());
            return Ok(None);
        };
        let image = self.document.named("images", index)?;
        let number = index.as_count()?;
        let known = self.images.get(&(number, is_data)).or_else(|| {
            // 8-bit texels are the same whether they hold colours or numbers.
            let other = self.images.get(&(number, !is_data));
            other.filter(|other| other.as_ref().is_none_or(|(_, image)| image.is_bytes()))
        });
        if let Some(known) = known {
            return Ok(known.clone());
        }
        let decoded = match self.decode(image, is_data) {
            Ok(decoded) => Some(decoded),
            Err(error @ FormatError::TooLarge { .. }) => return Err(error),
            Err(error) => {
                let reason = error.without_place();
                let what = format!("a texture is replaced by a magenta checker: {reason}");
                self.oddities.note(&what, || image.at());
                None
            }
        };
        self.images.insert((number, is_data), decoded.clone());
        Ok(decoded)
    }

    pub(super) fn decode(&mut self, image: JsonNode<'d>, is_data: bool) -> Result<Named, FormatError> {
        let at = image.at();
        let (name, bytes) = self.encoded(image)?;
        let kind = image.text("mimeType")?.unwrap_or_default();
        let extension = Path::new(&name).extension().and_then(|e| e.to_str());
        let hint = kind.strip_prefix("image/").or(extension);
        let means = if is_data { SampleMeaning::Numbers } else { SampleMeaning::SrgbColours };
        let decoded = self.reading.decode(&bytes, (hint, None), means, (&name, &at))?;
        self.release_encoded(bytes);
        Ok((name, Arc::new(decoded)))
    }

    /// The name and the encoded bytes of an image, wherever they are stored.
    pub(super) fn encoded(&mut self, image: JsonNode<'d>) -> Result<(String, Cow<'d, [u8]>), FormatError> {
        if let Some(view) = image.get("bufferView") {
            let view = self.document.view(view)?;
            let name = if image.name().is_empty() { "a picture in the file" } else { image.name() };
            return Ok((name.to_owned(), Cow::Borrowed(view.bytes)));
        }
        let place = image.need("uri")?;
        Ok(match uri::resolve(self.reading, place)? {
            Resource::Data(bytes) => (image.name().to_owned(), Cow::Owned(bytes)),
            Resource::File(names) => {
                let path = self.reading.locate_any(self.source.folder, &names, &place.at())?;
                let bytes = self.reading.load(&path)?;
                (names.into_iter().next().unwrap_or_default(), Cow::Owned(bytes))
            }
        })
    }

    /// Releases bytes from [`Gltf::encoded`].
    pub(super) fn release_encoded(&mut self, bytes: Cow<'d, [u8]>) {
        if let Cow::Owned(bytes) = bytes {
            self.reading.release(bytes);
        }
    }
}

/// The index of a texture's image. The format that all programs can read comes first: compressed ones have lost
/// more.
pub(super) fn source(texture: JsonNode) -> Option<JsonNode> {
    let of = |name| texture.extension(name).and_then(|extension| extension.get("source"));
    let packed = if cfg!(feature = "ktx2") { of("KHR_texture_basisu") } else { None };
    texture.get("source").or(of("EXT_texture_webp")).or(packed)
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
