//! Materials and their extensions, mapped to the `principled` material.

use crate::document::json::JsonNode;
use crate::document::json_document::Document;
use crate::materials::alpha::opacity;
use crate::materials::draft::{Alpha, Draft, OnMesh};
use crate::materials::glossiness::glossy;
use crate::materials::pictures::Pictures;
use crate::materials::remapped::{angles, film};
use crate::materials::scatter::scatter;
use crate::materials::textures::{ChannelSelection, Textures, UvSets};
use bilux_import::FormatError;
use bilux_import::appearance::as_metal::as_metal;
use bilux_import::appearance::fitting::fitted;
use bilux_import::input::reading::Reading;
use bilux_import::input::sink::Sink;
use bilux_math::Rgb;
use bilux_scene::texture::Channel;
use bilux_scene::{Span, Spec, Value};
use std::collections::HashMap;
use std::f64::consts::TAU;

/// A material with what its primitives need to know.
#[derive(Clone, Copy)]
pub(crate) struct UsedMaterial {
    /// Index of the material in the scene.
    pub(crate) index: usize,
    /// The sets of texture coordinates that its textures use.
    pub(crate) uv_sets: UvSets,
    /// True if the material depends on the direction of the texture coordinates.
    pub(crate) has_direction: bool,
    /// True if its normal map uses the second of these sets.
    pub(crate) normal_by_second: bool,
    /// True if it emits its colour, which vertices tint.
    pub(crate) is_unlit: bool,
    /// Effect of the alpha of vertices.
    pub(crate) alpha: Alpha,
}

/// The materials that have been added to the scene, by their index in the file (`None` for the default one) and by what
/// they are on.
#[derive(Default)]
pub(crate) struct Materials {
    used: HashMap<(Option<usize>, OnMesh), UsedMaterial>,
    pub(crate) pictures: Pictures,
}

impl Materials {
    /// The material that `index` refers to, or the default one.
    pub(crate) fn material<'d>(
        &mut self,
        index: Option<JsonNode<'d>>,
        on: OnMesh,
        document: &'d Document<'d>,
        reading: &mut Reading,
        sink: &mut Sink,
    ) -> Result<UsedMaterial, FormatError> {
        let node = index.map(|index| document.named("materials", index)).transpose()?;
        // Only a mask has to know: its threshold is compared after the vertices' factor.
        let is_mask = node.is_some_and(|node| matches!(node.text("alphaMode"), Ok(Some("MASK"))));
        let on = OnMesh { has_alpha: on.has_alpha && is_mask, ..on };
        let key = (index.map(|index| index.as_count()).transpose()?, on);
        if let Some(material) = self.used.get(&key) {
            return Ok(*material);
        }
        let textures = Textures { document, pictures: &mut self.pictures, reading, sink };
        let (spec, alpha) = (Spec::new("default", "principled"), Alpha::Opaque);
        let mut draft = Draft { spec, alpha, uv_sets: [None; 2], on, textures };
        match node {
            Some(node) => fill(node, &mut draft)?,
            None => {
                draft.set("base_color", Rgb::WHITE, Span::default());
                draft.set("base_metalness", 1.0, Span::default());
                draft.set("specular_roughness", 1.0, Span::default());
                draft.set("visible_sides", "front", Span::default());
            }
        }
        let is_unlit = node.is_some_and(|node| node.extension("KHR_materials_unlit").is_some());
        let material = used(draft, is_unlit);
        self.used.insert(key, material);
        Ok(material)
    }
}

/// Adds a finished draft to the scene.
fn used(draft: Draft, is_unlit: bool) -> UsedMaterial {
    let has_direction =
        draft.has("normal") || draft.has("coat_normal") || draft.has("specular_roughness_anisotropy");
    let normal = draft.value("normal").or(draft.value("coat_normal")).cloned();
    let sink = draft.textures.sink;
    let is_second = |i: &usize| sink.scene.textures.get(*i).is_some_and(|texture| texture.second_uv);
    let normal_by_second = matches!(normal, Some(Value::Texture(i)) if is_second(&i));
    let index = sink.scene.add_material(fitted(draft.spec, &mut sink.diagnostics));
    let (uv_sets, alpha) = (draft.uv_sets, draft.alpha);
    UsedMaterial { index, uv_sets, has_direction, normal_by_second, is_unlit, alpha }
}

/// Sets all that the file says about a material.
fn fill<'d>(node: JsonNode<'d>, draft: &mut Draft<'d, '_>) -> Result<(), FormatError> {
    draft.spec = Spec { span: node.at(), ..Spec::new(node.name(), "principled") };
    match node.extension("KHR_materials_pbrSpecularGlossiness") {
        Some(extension) => glossy(node, extension, draft)?,
        None => base(node, draft)?,
    }
    emission(node, draft)?;
    if let Some(info) = node.get("normalTexture") {
        let map = draft.texture(info, ChannelSelection::VECTORS)?;
        draft.set("normal", map, info.at());
        let scale = info.number("scale")?.unwrap_or(1.0);
        draft.set("normal_scale", scale as f32, info.at());
    }
    if let Some(info) = node.get("occlusionTexture") {
        let what = "occlusion textures are not used: light transport computes the occlusion";
        draft.remark(what, || info.at());
    }
    if let Some(ior) = node.extension("KHR_materials_ior") {
        let number = ior.number("ior")?.unwrap_or(1.5);
        draft.set("specular_ior", number.clamp(1.0, GREATEST_INDEX) as f32, ior.at());
    }
    specular(node, draft)?;
    anisotropy(node, draft)?;
    transmission(node, draft)?;
    coat(node, draft)?;
    fuzz(node, draft)?;
    film(node, draft)?;
    diffuse_transmission(node, draft)?;
    scatter(node, draft)?;
    if let Some(extension) = node.extension("KHR_materials_unlit") {
        unlit(extension, draft);
    }
    sides(node, draft)
}

fn base<'d>(node: JsonNode<'d>, draft: &mut Draft<'d, '_>) -> Result<(), FormatError> {
    let pbr = node.get("pbrMetallicRoughness");
    let at = pbr.unwrap_or(node).at();
    let factor = pbr.map_or(Ok(None), |pbr| pbr.numbers::<4>("baseColorFactor"))?.unwrap_or([1.0; 4]);
    let [r, g, b, alpha] = factor.map(|c| c as f32);
    let picture = pbr.and_then(|pbr| pbr.get("baseColorTexture"));
    draft.colour("base_color", Rgb::new(r, g, b), picture, &at)?;
    let factor = |key| pbr.map_or(Ok(None), |pbr| pbr.number(key));
    let (metal, rough) =
        (factor("metallicFactor")?.unwrap_or(1.0), factor("roughnessFactor")?.unwrap_or(1.0));
    let picture_of = pbr.and_then(|pbr| pbr.get("metallicRoughnessTexture"));
    draft.scalar("base_metalness", metal, picture_of, Channel::B, &at)?;
    draft.scalar("specular_roughness", rough, picture_of, Channel::G, &at)?;
    opacity(node, picture, alpha, draft)
}

/// The back faces of transmissive surfaces are always visible, since light travels inside.
fn sides<'d>(node: JsonNode<'d>, draft: &mut Draft<'d, '_>) -> Result<(), FormatError> {
    let is_whole = !draft.has("transmission_weight") && !draft.has("transmission_scatter");
    if is_whole && !node.switch("doubleSided")? {
        draft.set("visible_sides", "front", node.at());
        if draft.has("emission") {
            draft.set("emission_sides", "front", node.at());
        }
    }
    Ok(())
}

fn emission<'d>(node: JsonNode<'d>, draft: &mut Draft<'d, '_>) -> Result<(), FormatError> {
    let factor = node.numbers::<3>("emissiveFactor")?.unwrap_or([0.0; 3]).map(|c| c.max(0.0) as f32);
    let strength = match node.extension("KHR_materials_emissive_strength") {
        Some(extension) => extension.number("emissiveStrength")?.unwrap_or(1.0).max(0.0),
        None => 1.0,
    };
    let factor = Rgb::from_array(factor) * strength as f32;
    if !factor.is_black() {
        draft.colour("emission", factor, node.get("emissiveTexture"), &node.at())?;
    }
    Ok(())
}

/// The greatest index of refraction that a material has here.
const GREATEST_INDEX: f64 = 10.0;

/// The reflectance at normal incidence of a file's index of refraction; 0 stands for a surface that reflects everything.
/// [KHR_materials_ior]
fn reflectance(ior: f64) -> f32 {
    let root = if ior == 0.0 { 1.0 } else { (ior - 1.0) / (ior + 1.0) };
    (root * root) as f32
}

fn specular<'d>(node: JsonNode<'d>, draft: &mut Draft<'d, '_>) -> Result<(), FormatError> {
    let index = node.extension("KHR_materials_ior").map_or(Ok(None), |ior| ior.number("ior"))?;
    // Converters of specular colours state an index of 0 or a very large one, so that the colour alone counts.
    let is_by_colour = index.is_some_and(|index| index == 0.0 || index > GREATEST_INDEX);
    let whole = reflectance(index.unwrap_or(1.5));
    if draft.number("base_metalness") == Some(1.0) {
        // Both extensions apply only to dielectrics.
        return Ok(());
    }
    let Some(extension) = node.extension("KHR_materials_specular") else {
        if is_by_colour {
            mirror(Rgb::grey(whole), node, draft);
        }
        return Ok(());
    };
    let at = extension.at();
    let weight = extension.number("specularFactor")?.unwrap_or(1.0);
    draft.scalar("specular_weight", weight, extension.get("specularTexture"), Channel::A, &at)?;
    let [r, g, b] = extension.numbers::<3>("specularColorFactor")?.unwrap_or([1.0; 3]).map(|c| c as f32);
    let (mut shade, picture) = (Rgb::new(r, g, b), extension.get("specularColorTexture"));
    let greatest = shade.max_channel();
    let is_opaque = node.extension("KHR_materials_transmission").is_none();
    if (greatest > 1.0 || (is_by_colour && greatest > 0.0)) && is_opaque {
        // The index is the one that reflects as much as the greatest channel, which may be more than the file's allows.
        let (root, most) = ((whole * greatest).sqrt(), 9.0 / 11.0);
        if root > most {
            if is_by_colour && picture.is_none() && mirror(shade * whole, node, draft) {
                return Ok(());
            }
            draft.note("specular reflectance at normal incidence is limited to 0.67", || extension.at());
        }
        let root = root.min(most);
        draft.set("specular_ior", (1.0 + root) / (1.0 - root), at.clone());
        shade *= 1.0 / greatest;
    }
    draft.colour("specular_color", shade, picture, &at)
}

/// Makes a metal of what reflects more than any dielectric, where no texture is in the way; false where one is.
fn mirror(specular: Rgb, node: JsonNode, draft: &mut Draft) -> bool {
    let (Some(diffuse), Some(_)) = (draft.spec.colour("base_color"), draft.number("base_metalness")) else {
        return false;
    };
    let (base, metalness) = as_metal(diffuse, specular);
    draft.set("base_color", base, node.at());
    draft.set("base_metalness", metalness, node.at());
    true
}

/// Converts the anisotropy. glTF increases the roughness along a direction; `principled` decreases it across
/// that direction, by the same ratio.
fn anisotropy<'d>(node: JsonNode<'d>, draft: &mut Draft<'d, '_>) -> Result<(), FormatError> {
    let Some(extension) = node.extension("KHR_materials_anisotropy") else { return Ok(()) };
    let strength = extension.number("anisotropyStrength")?.unwrap_or(0.0).clamp(0.0, 1.0);
    if strength == 0.0 {
        return Ok(());
    }
    let at = extension.at();
    let roughness = draft.number("specular_roughness").unwrap_or(0.5);
    let (along, across) = (roughness * roughness, roughness * roughness);
    let along = along + (1.0 - along) * strength * strength;
    let ratio = if along > 0.0 { across / along } else { 1.0 };
    if draft.number("specular_roughness").is_some() {
        let even = along / (2.0 / (1.0 + ratio * ratio)).sqrt();
        draft.set("specular_roughness", even.sqrt() as f32, at.clone());
    }
    let picture = extension.get("anisotropyTexture");
    draft.scalar("specular_roughness_anisotropy", 1.0 - ratio, picture, Channel::B, &at)?;
    let turns = extension.number("anisotropyRotation")?.unwrap_or(0.0) / TAU + 0.25;
    let rotation = match picture {
        Some(info) => angles(info, turns, draft)?,
        None => (turns.rem_euclid(1.0) as f32).into(),
    };
    draft.set("anisotropy_rotation", rotation, at);
    Ok(())
}

fn transmission<'d>(node: JsonNode<'d>, draft: &mut Draft<'d, '_>) -> Result<(), FormatError> {
    let Some(extension) = node.extension("KHR_materials_transmission") else { return Ok(()) };
    let weight = extension.number("transmissionFactor")?.unwrap_or(0.0);
    if weight <= 0.0 {
        return Ok(());
    }
    let at = extension.at();
    let picture = extension.get("transmissionTexture");
    draft.scalar("transmission_weight", weight, picture, Channel::R, &at)?;
    let volume = node.extension("KHR_materials_volume");
    let thickness = volume.map_or(Ok(None), |volume| volume.number("thicknessFactor"))?.unwrap_or(0.0);
    let is_thin = thickness <= 0.0 && !draft.on.is_solid;
    draft.set("thin_walled", is_thin, at.clone());
    if let Some(dispersion) = node.extension("KHR_materials_dispersion").filter(|_| !is_thin) {
        // glTF states 20 / Abbe number. `principled` scales the dispersion of an Abbe number, 20 by default,
        // by at most 1.
        let number = dispersion.number("dispersion")?.unwrap_or(0.0) as f32;
        draft.set("transmission_dispersion_scale", number.min(1.0), dispersion.at());
        if number > 1.0 {
            draft.set("transmission_dispersion_abbe_number", 20.0 / number, dispersion.at());
        }
    }
    let base = draft.value("base_color").cloned();
    let depth = volume.map_or(Ok(None), |volume| volume.number("attenuationDistance"))?;
    let (Some(volume), Some(depth)) = (volume.filter(|_| thickness > 0.0), depth.filter(|d| *d > 0.0)) else {
        // The light is tinted as it crosses the surface.
        draft.set("transmission_color", base.unwrap_or(1.0.into()), at);
        return Ok(());
    };
    let colour = volume.numbers::<3>("attenuationColor")?.unwrap_or([1.0; 3]).map(|c| c as f32);
    draft.set("transmission_color", Rgb::from_array(colour), volume.at());
    draft.set("transmission_depth", depth as f32, volume.at());
    if base.is_some_and(|base| base != Value::from(Rgb::WHITE)) {
        let what = "the base colour of a material with absorption does not tint light at the surface as well";
        draft.note(what, || volume.at());
    }
    Ok(())
}

fn coat<'d>(node: JsonNode<'d>, draft: &mut Draft<'d, '_>) -> Result<(), FormatError> {
    let Some(extension) = node.extension("KHR_materials_clearcoat") else { return Ok(()) };
    let weight = extension.number("clearcoatFactor")?.unwrap_or(0.0);
    if weight <= 0.0 {
        return Ok(());
    }
    let at = extension.at();
    draft.scalar("coat_weight", weight, extension.get("clearcoatTexture"), Channel::R, &at)?;
    let (rough, picture) = (
        extension.number("clearcoatRoughnessFactor")?.unwrap_or(0.0),
        extension.get("clearcoatRoughnessTexture"),
    );
    draft.scalar("coat_roughness", rough, picture, Channel::G, &at)?;
    draft.set("coat_ior", 1.5, at);
    if let Some(normals) = extension.get("clearcoatNormalTexture") {
        let map = draft.texture(normals, ChannelSelection::VECTORS)?;
        draft.set("coat_normal", map, normals.at());
        let scale = normals.number("scale")?.unwrap_or(1.0);
        draft.set("coat_normal_scale", scale as f32, normals.at());
    }
    Ok(())
}

fn fuzz<'d>(node: JsonNode<'d>, draft: &mut Draft<'d, '_>) -> Result<(), FormatError> {
    let Some(extension) = node.extension("KHR_materials_sheen") else { return Ok(()) };
    let colour = extension.numbers::<3>("sheenColorFactor")?.unwrap_or([0.0; 3]).map(|c| c as f32);
    let weight = colour.into_iter().fold(0.0, f32::max);
    if weight <= 0.0 {
        return Ok(());
    }
    let at = extension.at();
    draft.set("fuzz_weight", weight, at.clone());
    let picture = extension.get("sheenColorTexture");
    draft.colour("fuzz_color", Rgb::from_array(colour) * (1.0 / weight), picture, &at)?;
    let rough = extension.number("sheenRoughnessFactor")?.unwrap_or(0.0);
    draft.scalar("fuzz_roughness", rough, extension.get("sheenRoughnessTexture"), Channel::A, &at)
}

fn diffuse_transmission<'d>(node: JsonNode<'d>, draft: &mut Draft<'d, '_>) -> Result<(), FormatError> {
    let Some(extension) = node.extension("KHR_materials_diffuse_transmission") else { return Ok(()) };
    let weight = extension.number("diffuseTransmissionFactor")?.unwrap_or(0.0);
    if weight <= 0.0 {
        return Ok(());
    }
    let at = extension.at();
    let picture = extension.get("diffuseTransmissionTexture");
    draft.scalar("diffuse_transmission_weight", weight, picture, Channel::A, &at)?;
    let [r, g, b] =
        extension.numbers::<3>("diffuseTransmissionColorFactor")?.unwrap_or([1.0; 3]).map(|c| c as f32);
    let picture = extension.get("diffuseTransmissionColorTexture");
    draft.colour("diffuse_transmission_color", Rgb::new(r, g, b), picture, &at)
}

/// An unlit surface looks the same in any light, so its colour becomes emission.
fn unlit(extension: JsonNode, draft: &mut Draft) {
    let what = "an unlit material emits its colour, so it also lights its surroundings";
    draft.note(what, || extension.at());
    let mut spec = Spec { span: draft.spec.span.clone(), ..Spec::new(&draft.spec.name, "principled") };
    for (key, value, at) in std::mem::take(&mut draft.spec.parameters.0) {
        match key.as_str() {
            "base_color" => spec.parameters.set_at("emission", value, at),
            "opacity" => spec.parameters.set_at("opacity", value, at),
            _ => {}
        }
    }
    spec.parameters.set("base_color", 0.0);
    spec.parameters.set("specular_weight", 0.0);
    draft.spec = spec;
}
