//! `KHR_materials_pbrSpecularGlossiness`, converted to metalness and roughness.
//!
//! A surface whose specular reflectance only a metal reaches is metal. The metalness and the base colour are those
//! that give the same diffuse and the same specular reflectance together, as far as both are possible.

use super::json::JsonNode;
use super::material::Draft;
use super::reader::Gltf;
use super::textures::ChannelSelection;
use crate::FormatError;
use bilux_math::colour::srgb_encode;
use bilux_math::{Rgb, Vec2};
use bilux_scene::Texture;
use bilux_scene::texture::{Channel, Image, Texels};
use std::sync::Arc;

/// The reflectance of a dielectric at normal incidence, for an index of refraction of 1.5.
const DIELECTRIC: f32 = 0.04;

impl<'d> Gltf<'d, '_, '_> {
    /// Sets base colour, metalness, roughness and opacity of a material with this extension.
    pub(super) fn glossy(
        &mut self,
        node: JsonNode<'d>,
        extension: JsonNode<'d>,
        draft: &mut Draft,
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
            return self.opacity(node, None, alpha, draft);
        }
        let mut texture = |info: Option<JsonNode<'d>>, taken: ChannelSelection| {
            info.map(|info| self.looked_up(info, taken, &mut draft.uv_sets)).transpose()
        };
        let diffuse_map = texture(of_diffuse, ChannelSelection::colours(diffuse))?;
        let specular_map = texture(of_specular, ChannelSelection::colours(specular))?;
        let gloss_map = texture(of_specular, ChannelSelection::channel(Channel::A, f64::from(gloss)))?;
        let [base, numbers] = self.baked(
            (diffuse, diffuse_map.as_ref()),
            (specular, specular_map.as_ref()),
            (gloss, gloss_map.as_ref()),
        )?;
        let channel = |channel| Texture { channel: Some(channel), ..numbers.clone() };
        let (metal, rough) = (self.add_texture(channel(Channel::B))?, self.add_texture(channel(Channel::G))?);
        let base = self.add_texture(base)?;
        draft.set("base_color", base, at.clone());
        draft.set("base_metalness", metal, at.clone());
        draft.set("specular_roughness", rough, at);
        self.opacity(node, of_diffuse, alpha, draft)
    }

    /// Bakes an image of the base colour and one of roughness and metalness, with the size and placement of the
    /// larger source.
    fn baked(
        &mut self,
        (diffuse, diffuse_map): (Rgb, Option<&Texture>),
        (specular, specular_map): (Rgb, Option<&Texture>),
        (gloss, gloss_map): (f32, Option<&Texture>),
    ) -> Result<[Texture; 2], FormatError> {
        let size = |map: &&Texture| map.width() * map.height();
        let larger = diffuse_map.into_iter().chain(specular_map).max_by_key(size);
        let Some(lies) = larger else { return Ok([Texture::missing(""), Texture::missing("")]) };
        let (width, height) = (lies.width(), lies.height());
        let as_they_are = |map: &Texture| Texture { transform: None, ..map.clone() };
        let (diffuse_map, specular_map, gloss_map) =
            (diffuse_map.map(as_they_are), specular_map.map(as_they_are), gloss_map.map(as_they_are));
        self.reading.budget.take_bytes((width * height) as u64 * 8, &self.file)?;
        let (mut base, mut numbers) =
            (Vec::with_capacity(width * height), Vec::with_capacity(width * height));
        let byte = |x: f32| (x.clamp(0.0, 1.0) * 255.0).round() as u8;
        for i in 0..width * height {
            let (x, y) = ((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
            let uv = Vec2::new(x / width as f32, 1.0 - y / height as f32);
            let colour = |map: &Option<Texture>, or: Rgb| map.as_ref().map_or(or, |map| map.at_one(uv));
            let gloss = gloss_map.as_ref().map_or(gloss, |map| map.at_one(uv).r);
            let (colour, metalness) =
                as_metal(colour(&diffuse_map, diffuse), colour(&specular_map, specular));
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
}

/// The base colour and metalness of a surface with the given diffuse reflectance and specular reflectance at
/// normal incidence.
///
/// With base colour c and metalness m, diffuse is c (1 - m) (1 - 0.04) / (1 - s), where s is the maximum specular
/// reflectance, and specular is 0.04 (1 - m) + c m. Eliminating c, by brightness, leaves a quadratic equation for
/// m.
fn as_metal(diffuse: Rgb, specular: Rgb) -> (Rgb, f32) {
    let left = 1.0 - specular.to_array().into_iter().fold(0.0, f32::max).min(1.0);
    let (d, s) = (brightness(diffuse) * left / (1.0 - DIELECTRIC), brightness(specular));
    let metalness = if s < DIELECTRIC {
        0.0
    } else {
        let (b, c) = (d + s - 2.0 * DIELECTRIC, DIELECTRIC - s);
        ((-b + (b * b - 4.0 * DIELECTRIC * c).max(0.0).sqrt()) / (2.0 * DIELECTRIC)).clamp(0.0, 1.0)
    };
    let from_diffuse = diffuse * (left / (1.0 - DIELECTRIC) / (1.0 - metalness).max(1e-6));
    let from_specular = specular.map(|c| (c - DIELECTRIC * (1.0 - metalness)) / metalness.max(1e-6));
    // Each reflectance determines the colour to the degree that it contributes.
    (from_diffuse.lerp(from_specular, metalness * metalness).clamp(0.0, 1.0), metalness)
}

/// The perceived brightness of a colour, as the root of its weighted mean square.
fn brightness(colour: Rgb) -> f32 {
    let [r, g, b] = colour.to_array();
    (0.299 * r * r + 0.587 * g * g + 0.114 * b * b).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: Rgb, b: Rgb) -> bool {
        a.to_array().iter().zip(b.to_array()).all(|(a, b)| (a - b).abs() < 0.01)
    }

    #[test]
    fn plastic_stays_plastic_and_gold_is_metal() {
        let (base, metalness) = as_metal(Rgb::new(0.5, 0.2, 0.1), Rgb::grey(DIELECTRIC));
        assert!(metalness < 1e-3 && near(base, Rgb::new(0.5, 0.2, 0.1)), "{base:?} {metalness}");
        let gold = Rgb::new(1.0, 0.77, 0.34);
        let (base, metalness) = as_metal(Rgb::BLACK, gold);
        assert!(metalness > 0.99 && near(base, gold), "{base:?} {metalness}");
    }
}
