//! Materials and their extensions, mapped to the `principled` material.

use super::alpha::Alpha;
use super::json::JsonNode;
use super::reader::Gltf;
use super::textures::ChannelSelection;
use crate::FormatError;
use bilux_math::Rgb;
use bilux_scene::texture::Channel;
use bilux_scene::{Span, Spec, Value};
use std::f64::consts::TAU;

/// A material with what its primitives need to know.
#[derive(Clone, Copy)]
pub(super) struct UsedMaterial {
    /// Its index in the scene.
    pub(super) index: usize,
    /// The sets of texture coordinates that its textures use.
    pub(super) uv_sets: UvSets,
    /// True if the material depends on the direction of the texture coordinates.
    pub(super) has_direction: bool,
    /// True if its normal map uses the second of these sets.
    pub(super) normal_by_second: bool,
    /// True if it emits its colour, which vertices tint.
    pub(super) is_unlit: bool,
    /// What the alpha of vertices does.
    pub(super) alpha: Alpha,
}

/// A material by its index in the file (`None` for the default one), by whether glass is solid, and by whether it is
/// a mask for vertices with alpha.
pub(super) type MaterialKey = (Option<usize>, bool, bool);

/// The texture coordinate sets of the file that become the mesh's first and second set.
pub(super) type UvSets = [Option<usize>; 2];

/// A material under construction: parameters of `principled`, whether or not that has them all.
pub(super) struct Draft {
    pub(super) spec: Spec,
    pub(super) uv_sets: UvSets,
    /// True if transmission without a thickness means a solid.
    is_solid: bool,
    /// True if the vertices have alpha, with which a threshold is compared only after it has been multiplied.
    pub(super) has_vertex_alpha: bool,
    pub(super) alpha: Alpha,
}

impl Draft {
    pub(super) fn set(&mut self, key: &str, value: impl Into<Value>, at: Span) {
        self.spec.parameters.set_at(key, value.into(), at);
    }

    fn number(&self, key: &str) -> Option<f64> {
        match self.spec.parameters.find(key)?.0 {
            Value::Number(x) => Some(*x),
            _ => None,
        }
    }
}

impl<'d> Gltf<'d, '_, '_> {
    /// The material that `index` refers to, or the default one.
    pub(super) fn material(
        &mut self,
        index: Option<JsonNode<'d>>,
        (is_solid, has_vertex_alpha): (bool, bool),
    ) -> Result<UsedMaterial, FormatError> {
        let node = index.map(|index| self.document.named("materials", index)).transpose()?;
        // Only a mask has to know: its threshold is compared after the vertices' factor.
        let is_mask = node.is_some_and(|node| matches!(node.text("alphaMode"), Ok(Some("MASK"))));
        let has_vertex_alpha = has_vertex_alpha && is_mask;
        let key = (index.map(|index| index.as_count()).transpose()?, is_solid, has_vertex_alpha);
        if let Some(material) = self.materials.get(&key) {
            return Ok(*material);
        }
        let (spec, alpha) = (Spec::new("default", "principled"), Alpha::Opaque);
        let mut draft = Draft { spec, uv_sets: [None; 2], is_solid, has_vertex_alpha, alpha };
        let is_unlit = node.is_some_and(|node| node.extension("KHR_materials_unlit").is_some());
        match node {
            Some(node) => self.draft(node, &mut draft)?,
            None => {
                draft.set("base_color", Rgb::WHITE, Span::default());
                draft.set("base_metalness", 1.0, Span::default());
                draft.set("specular_roughness", 1.0, Span::default());
                draft.set("visible_sides", "front", Span::default());
            }
        }
        let has = |key| draft.spec.parameters.find(key).is_some();
        let has_direction = has("normal") || has("coat_normal") || has("specular_roughness_anisotropy");
        let normal = draft.spec.parameters.find("normal").or(draft.spec.parameters.find("coat_normal"));
        let normal = normal.map(|(value, _)| value);
        let is_second = |i: &usize| self.scene.textures.get(*i).is_some_and(|texture| texture.second_uv);
        let normal_by_second = matches!(normal, Some(Value::Texture(i)) if is_second(i));
        let (uv_sets, alpha) = (draft.uv_sets, draft.alpha);
        let index = self.fitted(draft.spec);
        let used = UsedMaterial { index, uv_sets, has_direction, normal_by_second, is_unlit, alpha };
        self.materials.insert(key, used);
        Ok(used)
    }

    fn draft(&mut self, node: JsonNode<'d>, draft: &mut Draft) -> Result<(), FormatError> {
        draft.spec = Spec { span: node.at(), ..Spec::new(node.name(), "principled") };
        match node.extension("KHR_materials_pbrSpecularGlossiness") {
            Some(extension) => self.glossy(node, extension, draft)?,
            None => self.base(node, draft)?,
        }
        self.emission(node, draft)?;
        if let Some(info) = node.get("normalTexture") {
            let map = self.texture(info, ChannelSelection::VECTORS, &mut draft.uv_sets)?;
            draft.set("normal", map, info.at());
            let scale = info.number("scale")?.unwrap_or(1.0);
            draft.set("normal_scale", scale as f32, info.at());
        }
        if let Some(info) = node.get("occlusionTexture") {
            let what = "occlusion textures are not used: light transport computes the occlusion";
            self.oddities.remark(what, || info.at());
        }
        if let Some(ior) = node.extension("KHR_materials_ior") {
            let number = ior.number("ior")?.unwrap_or(1.5);
            // Zero stands for a surface that reflects everything.
            draft.set("specular_ior", (if number == 0.0 { 10.0 } else { number }) as f32, ior.at());
        }
        self.specular(node, draft)?;
        self.anisotropy(node, draft)?;
        self.transmission(node, draft)?;
        self.coat(node, draft)?;
        self.fuzz(node, draft)?;
        self.film(node, draft)?;
        self.diffuse_transmission(node, draft)?;
        self.scatter(node, draft)?;
        if let Some(unlit) = node.extension("KHR_materials_unlit") {
            self.unlit(unlit, draft);
        }
        self.sides(node, draft)
    }

    fn base(&mut self, node: JsonNode<'d>, draft: &mut Draft) -> Result<(), FormatError> {
        let pbr = node.get("pbrMetallicRoughness");
        let at = pbr.unwrap_or(node).at();
        let factor = pbr.map_or(Ok(None), |pbr| pbr.numbers::<4>("baseColorFactor"))?.unwrap_or([1.0; 4]);
        let [r, g, b, alpha] = factor.map(|c| c as f32);
        let picture = pbr.and_then(|pbr| pbr.get("baseColorTexture"));
        self.colour(draft, "base_color", Rgb::new(r, g, b), picture, &at)?;
        let factor = |key| pbr.map_or(Ok(None), |pbr| pbr.number(key));
        let (metal, rough) =
            (factor("metallicFactor")?.unwrap_or(1.0), factor("roughnessFactor")?.unwrap_or(1.0));
        let picture_of = pbr.and_then(|pbr| pbr.get("metallicRoughnessTexture"));
        self.scalar(draft, "base_metalness", metal, picture_of, Channel::B, &at)?;
        self.scalar(draft, "specular_roughness", rough, picture_of, Channel::G, &at)?;
        self.opacity(node, picture, alpha, draft)
    }

    /// The back faces of transmissive surfaces are always visible, since light travels inside.
    fn sides(&mut self, node: JsonNode<'d>, draft: &mut Draft) -> Result<(), FormatError> {
        let has = |key| draft.spec.parameters.find(key).is_some();
        let is_whole = !has("transmission_weight") && !has("transmission_scatter");
        if is_whole && !node.switch("doubleSided")? {
            draft.set("visible_sides", "front", node.at());
            if draft.spec.parameters.find("emission").is_some() {
                draft.set("emission_sides", "front", node.at());
            }
        }
        Ok(())
    }

    fn emission(&mut self, node: JsonNode<'d>, draft: &mut Draft) -> Result<(), FormatError> {
        let factor = node.numbers::<3>("emissiveFactor")?.unwrap_or([0.0; 3]).map(|c| c.max(0.0) as f32);
        let strength = match node.extension("KHR_materials_emissive_strength") {
            Some(extension) => extension.number("emissiveStrength")?.unwrap_or(1.0).max(0.0),
            None => 1.0,
        };
        let factor = Rgb::from_array(factor) * strength as f32;
        if !factor.is_black() {
            self.colour(draft, "emission", factor, node.get("emissiveTexture"), &node.at())?;
        }
        Ok(())
    }

    fn specular(&mut self, node: JsonNode<'d>, draft: &mut Draft) -> Result<(), FormatError> {
        let Some(extension) = node.extension("KHR_materials_specular") else { return Ok(()) };
        if draft.number("base_metalness") == Some(1.0) {
            // The extension applies only to dielectrics.
            return Ok(());
        }
        let at = extension.at();
        let weight = extension.number("specularFactor")?.unwrap_or(1.0);
        self.scalar(draft, "specular_weight", weight, extension.get("specularTexture"), Channel::A, &at)?;
        let [r, g, b] = extension.numbers::<3>("specularColorFactor")?.unwrap_or([1.0; 3]).map(|c| c as f32);
        let (mut shade, picture) = (Rgb::new(r, g, b), extension.get("specularColorTexture"));
        let greatest = shade.max_channel();
        if greatest > 1.0 && node.extension("KHR_materials_transmission").is_none() {
            // A factor above 1 reflects more than the index of refraction allows, so the index is raised.
            let ior = draft.number("specular_ior").unwrap_or(1.5) as f32;
            let (root, most) = ((ior - 1.0) / (ior + 1.0) * greatest.sqrt(), 9.0 / 11.0);
            if root > most {
                self.oddities
                    .note("specular reflectance at normal incidence is limited to 0.67", || extension.at());
            }
            let root = root.min(most);
            draft.set("specular_ior", (1.0 + root) / (1.0 - root), at.clone());
            shade *= 1.0 / greatest;
        }
        self.colour(draft, "specular_color", shade, picture, &at)
    }

    /// Converts the anisotropy. glTF increases the roughness along a direction; `principled` decreases it across
    /// that direction, by the same ratio.
    fn anisotropy(&mut self, node: JsonNode<'d>, draft: &mut Draft) -> Result<(), FormatError> {
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
        self.scalar(draft, "specular_roughness_anisotropy", 1.0 - ratio, picture, Channel::B, &at)?;
        let turns = extension.number("anisotropyRotation")?.unwrap_or(0.0) / TAU + 0.25;
        let rotation = match picture {
            Some(info) => self.angles(info, turns, &mut draft.uv_sets)?,
            None => (turns.rem_euclid(1.0) as f32).into(),
        };
        draft.set("anisotropy_rotation", rotation, at);
        Ok(())
    }

    fn transmission(&mut self, node: JsonNode<'d>, draft: &mut Draft) -> Result<(), FormatError> {
        let Some(extension) = node.extension("KHR_materials_transmission") else { return Ok(()) };
        let weight = extension.number("transmissionFactor")?.unwrap_or(0.0);
        if weight <= 0.0 {
            return Ok(());
        }
        let at = extension.at();
        let picture = extension.get("transmissionTexture");
        self.scalar(draft, "transmission_weight", weight, picture, Channel::R, &at)?;
        let volume = node.extension("KHR_materials_volume");
        let thickness = volume.map_or(Ok(None), |volume| volume.number("thicknessFactor"))?.unwrap_or(0.0);
        let is_thin = thickness <= 0.0 && !draft.is_solid;
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
        let base = draft.spec.parameters.find("base_color").map(|(value, _)| value.clone());
        let depth = volume.map_or(Ok(None), |volume| volume.number("attenuationDistance"))?;
        let (Some(volume), Some(depth)) = (volume.filter(|_| thickness > 0.0), depth.filter(|d| *d > 0.0))
        else {
            // The light is tinted as it crosses the surface.
            draft.set("transmission_color", base.unwrap_or(1.0.into()), at);
            return Ok(());
        };
        let colour = volume.numbers::<3>("attenuationColor")?.unwrap_or([1.0; 3]).map(|c| c as f32);
        draft.set("transmission_color", Rgb::from_array(colour), volume.at());
        draft.set("transmission_depth", depth as f32, volume.at());
        if base.is_some_and(|base| base != Value::from(Rgb::WHITE)) {
            let what =
                "the base colour of a material with absorption does not tint light at the surface as well";
            self.oddities.note(what, || volume.at());
        }
        Ok(())
    }

    fn coat(&mut self, node: JsonNode<'d>, draft: &mut Draft) -> Result<(), FormatError> {
        let Some(extension) = node.extension("KHR_materials_clearcoat") else { return Ok(()) };
        let weight = extension.number("clearcoatFactor")?.unwrap_or(0.0);
        if weight <= 0.0 {
            return Ok(());
        }
        let at = extension.at();
        self.scalar(draft, "coat_weight", weight, extension.get("clearcoatTexture"), Channel::R, &at)?;
        let (rough, picture) = (
            extension.number("clearcoatRoughnessFactor")?.unwrap_or(0.0),
            extension.get("clearcoatRoughnessTexture"),
        );
        self.scalar(draft, "coat_roughness", rough, picture, Channel::G, &at)?;
        draft.set("coat_ior", 1.5, at);
        if let Some(normals) = extension.get("clearcoatNormalTexture") {
            let map = self.texture(normals, ChannelSelection::VECTORS, &mut draft.uv_sets)?;
            draft.set("coat_normal", map, normals.at());
            let scale = normals.number("scale")?.unwrap_or(1.0);
            draft.set("coat_normal_scale", scale as f32, normals.at());
        }
        Ok(())
    }

    fn fuzz(&mut self, node: JsonNode<'d>, draft: &mut Draft) -> Result<(), FormatError> {
        let Some(extension) = node.extension("KHR_materials_sheen") else { return Ok(()) };
        let colour = extension.numbers::<3>("sheenColorFactor")?.unwrap_or([0.0; 3]).map(|c| c as f32);
        let weight = colour.into_iter().fold(0.0, f32::max);
        if weight <= 0.0 {
            return Ok(());
        }
        let at = extension.at();
        draft.set("fuzz_weight", weight, at.clone());
        let picture = extension.get("sheenColorTexture");
        self.colour(draft, "fuzz_color", Rgb::from_array(colour) * (1.0 / weight), picture, &at)?;
        let rough = extension.number("sheenRoughnessFactor")?.unwrap_or(0.0);
        self.scalar(draft, "fuzz_roughness", rough, extension.get("sheenRoughnessTexture"), Channel::A, &at)
    }

    fn diffuse_transmission(&mut self, node: JsonNode<'d>, draft: &mut Draft) -> Result<(), FormatError> {
        let Some(extension) = node.extension("KHR_materials_diffuse_transmission") else { return Ok(()) };
        let weight = extension.number("diffuseTransmissionFactor")?.unwrap_or(0.0);
        if weight <= 0.0 {
            return Ok(());
        }
        let at = extension.at();
        let picture = extension.get("diffuseTransmissionTexture");
        self.scalar(draft, "diffuse_transmission_weight", weight, picture, Channel::A, &at)?;
        let [r, g, b] =
            extension.numbers::<3>("diffuseTransmissionColorFactor")?.unwrap_or([1.0; 3]).map(|c| c as f32);
        let picture = extension.get("diffuseTransmissionColorTexture");
        self.colour(draft, "diffuse_transmission_color", Rgb::new(r, g, b), picture, &at)
    }

    /// An unlit surface looks the same in any light, so its colour becomes emission.
    fn unlit(&mut self, unlit: JsonNode<'d>, draft: &mut Draft) {
        let what = "an unlit material emits its colour, so it also lights its surroundings";
        self.oddities.note(what, || unlit.at());
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

    fn colour(
        &mut self,
        draft: &mut Draft,
        key: &str,
        factor: Rgb,
        picture: Option<JsonNode<'d>>,
        at: &Span,
    ) -> Result<(), FormatError> {
        let value = match picture {
            Some(info) => self.texture(info, ChannelSelection::colours(factor), &mut draft.uv_sets)?,
            None => factor.into(),
        };
        draft.set(key, value, picture.map_or_else(|| at.clone(), |info| info.at()));
        Ok(())
    }

    pub(super) fn scalar(
        &mut self,
        draft: &mut Draft,
        key: &str,
        factor: f64,
        picture: Option<JsonNode<'d>>,
        channel: Channel,
        at: &Span,
    ) -> Result<(), FormatError> {
        let value = match picture {
            Some(info) if factor != 0.0 => {
                self.texture(info, ChannelSelection::channel(channel, factor), &mut draft.uv_sets)?
            }
            _ => Value::Number(factor),
        };
        draft.set(key, value, picture.map_or_else(|| at.clone(), |info| info.at()));
        Ok(())
    }
}
