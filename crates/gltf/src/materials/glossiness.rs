//! `KHR_materials_pbrSpecularGlossiness`, converted to metalness and roughness.

use crate::document::json::JsonNode;
use crate::materials::alpha::opacity;
use crate::materials::draft::Draft;
use crate::materials::textures::{ChannelSelection, Textures};
use bilux_import::FormatError;
use bilux_import::appearance::as_metal::as_metal;
use bilux_math::colour::srgb_encode;
use bilux_math::{Rgb, Vec2};
use bilux_scene::Texture;
use bilux_scene::texture::{Channel, Image, Texels};
use std::sync::Arc;

/// A value, which a texture replaces if there is one.
struct Mapped<T> {
    plain: T,
    map: Option<Texture>,
}

impl<T> Mapped<T> {
    /// The value without the texture's placement.
    fn unplaced(self) -> Mapped<T> {
        Mapped { map: self.map.map(|map| Texture { transform: None, ..map }), ..self }
    }
}

/// Sets base colour, metalness, roughness and opacity of a material with this extension.
pub(crate) fn glossy<'d>(
    node: JsonNode<'d>,
    extension: JsonNode<'d>,
    draft: &mut Draft<'d, '_>,
) -> Result<(), FormatError> {
    let at = extension.at();
    let [r, g, b, alpha] = extension.numbers::<4>("diffuseFactor")?.unwrap_or([1.0; 4]).map(|c| c as f32);
    let diffuse = Rgb::new(r, g, b);
    let specular = extension.numbers::<3>("specularFactor")?.unwrap_or([1.0; 3]).map(|c| c as f32);
    let specular = Rgb::from_array(specular);
    let gloss = extension.number("glossinessFactor")?.unwrap_or(1.0) as f32;
    let (of_diffuse, of_specular) =
        (extension.get("diffuseTexture"), extension.get("specularGlossinessTexture"));
    if of_diffuse.is_none() && of_specular.is_none() {
        let (base, metalness) = as_metal(diffuse, specular);
        draft.set("base_color", base, at.clone());
        draft.set("base_metalness", metalness, at.clone());
        draft.set("specular_roughness", (1.0 - gloss).clamp(0.0, 1.0), at);
        return opacity(node, None, alpha, draft);
    }
    let mut map = |info: Option<JsonNode<'d>>, taken: ChannelSelection| {
        info.map(|info| draft.looked_up(info, taken)).transpose()
    };
    let gloss_in_alpha = ChannelSelection::channel(Channel::A, f64::from(gloss));
    let diffuse = Mapped { plain: diffuse, map: map(of_diffuse, ChannelSelection::colours(diffuse))? };
    let specular = Mapped { plain: specular, map: map(of_specular, ChannelSelection::colours(specular))? };
    let gloss = Mapped { plain: gloss, map: map(of_specular, gloss_in_alpha)? };
    let textures = &mut draft.textures;
    let [base, numbers] = baked(diffuse, specular, gloss, textures)?;
    let channel = |channel| Texture { channel: Some(channel), ..numbers.clone() };
    let (metal, rough) = (textures.add(channel(Channel::B))?, textures.add(channel(Channel::G))?);
    let base = textures.add(base)?;
    draft.set("base_color", base, at.clone());
    draft.set("base_metalness", metal, at.clone());
    draft.set("specular_roughness", rough, at);
    opacity(node, of_diffuse, alpha, draft)
}

/// Bakes an image of the base colour and one of roughness and metalness, with the size and placement of the
/// larger source.
fn baked(
    diffuse: Mapped<Rgb>,
    specular: Mapped<Rgb>,
    gloss: Mapped<f32>,
    textures: &mut Textures,
) -> Result<[Texture; 2], FormatError> {
    let size = |map: &&Texture| map.width() * map.height();
    let larger = diffuse.map.iter().chain(&specular.map).max_by_key(size).cloned();
    let Some(lies) = larger else { return Ok([Texture::missing(""), Texture::missing("")]) };
    let (width, height) = (lies.width(), lies.height());
    let (diffuse, specular, gloss) = (diffuse.unplaced(), specular.unplaced(), gloss.unplaced());
    textures.take_bytes((width * height) as u64 * 8)?;
    let (mut base, mut numbers) = (Vec::with_capacity(width * height), Vec::with_capacity(width * height));
    let byte = |x: f32| (x.clamp(0.0, 1.0) * 255.0).round() as u8;
    for i in 0..width * height {
        let (x, y) = ((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
        let uv = Vec2::new(x / width as f32, 1.0 - y / height as f32);
        let colour = |of: &Mapped<Rgb>| of.map.as_ref().map_or(of.plain, |map| map.at_one(uv));
        let gloss = gloss.map.as_ref().map_or(gloss.plain, |map| map.at_one(uv).r);
        let (colour, metalness) = as_metal(colour(&diffuse), colour(&specular));
        let [r, g, b] = colour.map(srgb_encode).to_array().map(byte);
        base.push([r, g, b, 255]);
        numbers.push([0, byte(1.0 - gloss), byte(metalness), 255]);
    }
    let image = |texels| Arc::new(Image { width, height, texels: Texels::Bytes(texels) });
    let like = Texture { factor: Rgb::WHITE, channel: None, threshold: None, ..lies.clone() };
    Ok([
        Texture { image: image(base), is_data: false, ..like.clone() },
        Texture { image: image(numbers), is_data: true, ..like },
    ])
}
