//! Writes glTF materials: the inverse of [`crate::materials::material`].

use super::Document;
use super::kinds::as_principled;
use super::pictures::Channel;
use bilux_import::FormatError;
use bilux_import::output::values::{MaterialSupport, colour, number, texture};
use bilux_import::output::writing::Writing;
use bilux_math::Rgb;
use bilux_scene::materials::SHARED;
use bilux_scene::{Spec, Texture, Value};
use serde_json::{Value as Json, json};
use std::f32::consts::TAU;
use std::sync::Arc;

/// Parameters of `principled` that belong to an extension: extension, key, texture key and channel.
const NUMBERS: &[(&str, &str, &str, &str, usize)] = &[
    ("specular_weight", "KHR_materials_specular", "specularFactor", "specularTexture", 3),
    ("transmission_weight", "KHR_materials_transmission", "transmissionFactor", "transmissionTexture", 0),
    ("coat_weight", "KHR_materials_clearcoat", "clearcoatFactor", "clearcoatTexture", 0),
    ("coat_roughness", "KHR_materials_clearcoat", "clearcoatRoughnessFactor", "clearcoatRoughnessTexture", 1),
    ("fuzz_roughness", "KHR_materials_sheen", "sheenRoughnessFactor", "sheenRoughnessTexture", 3),
    ("thin_film_weight", "KHR_materials_iridescence", "iridescenceFactor", "iridescenceTexture", 0),
    (
        "diffuse_transmission_weight",
        "KHR_materials_diffuse_transmission",
        "diffuseTransmissionFactor",
        "diffuseTransmissionTexture",
        3,
    ),
];

/// Parameters of `principled` that belong to an extension and are colours: extension, key and texture key.
const COLOURS: &[(&str, &str, &str, &str)] = &[
    ("specular_color", "KHR_materials_specular", "specularColorFactor", "specularColorTexture"),
    (
        "diffuse_transmission_color",
        "KHR_materials_diffuse_transmission",
        "diffuseTransmissionColorFactor",
        "diffuseTransmissionColorTexture",
    ),
];

/// Parameters that are written in another way.
const ELSEWHERE: &[&str] = &[
    "base_color",
    "base_metalness",
    "specular_roughness",
    "specular_roughness_anisotropy",
    "anisotropy_rotation",
    "specular_ior",
    "thin_walled",
    "transmission_color",
    "transmission_depth",
    "transmission_dispersion_scale",
    "transmission_dispersion_abbe_number",
    "coat_ior",
    "coat_normal",
    "coat_normal_scale",
    "fuzz_weight",
    "fuzz_color",
    "thin_film_thickness",
    "thin_film_ior",
];

/// Parameters written in another way that may be textures.
const TEXTURED: [&str; 6] = [
    "base_color",
    "base_metalness",
    "specular_roughness",
    "coat_normal",
    "fuzz_color",
    "thin_film_thickness",
];

impl Document<'_> {
    /// Writes a material of any kind.
    pub(super) fn material(&mut self, spec: &Spec, writing: &mut Writing) -> Result<Json, FormatError> {
        let principled = as_principled(spec, self, writing);
        let in_tables = NUMBERS.iter().map(|row| row.0).chain(COLOURS.iter().map(|row| row.0));
        let of_any: Vec<&str> = in_tables.chain(SHARED.iter().copied()).collect();
        let textured = [&of_any[..], &TEXTURED].concat();
        let of_kinds = &[("principled", ELSEWHERE)];
        MaterialSupport { format: "glTF", of_kinds, of_any: &of_any, textured: Some(&textured) }
            .warn_unsupported(&principled, writing);
        let is_front =
            |key| matches!(principled.parameters.find(key), Some((Value::Text(side), _)) if side == "front");
        let is_one_sided = is_front("visible_sides");
        let glows = principled.parameters.find("emission").is_some();
        if glows && is_front("emission_sides") != is_one_sided {
            writing.warn("in glTF files a surface emits light on the sides that are visible");
        }
        let mut out = json!({ "doubleSided": !is_one_sided });
        if !spec.name.is_empty() {
            out["name"] = json!(spec.name);
        }
        self.base(&principled, &mut out, writing)?;
        self.extensions(&principled, &mut out, writing)?;
        self.volume(&principled, &mut out);
        self.brushing(&principled, &mut out);
        if let Some(normals) = self.normals(&principled, "normal", writing)? {
            out["normalTexture"] = normals;
        }
        let scale = colour(&principled, "emission_scale").unwrap_or(Rgb::WHITE);
        if let Some(picture) =
            texture(&principled, "emission").and_then(|i| self.scene.textures.get(i)).cloned()
        {
            let emission = emission(self, scale);
            merge(&mut out, emission);
            out["emissiveTexture"] = self.colours(&picture, &Channel::Even(1.0), writing)?;
        } else if let Some(light) = colour(&principled, "emission").filter(|light| !light.is_black()) {
            let emission = emission(self, light * scale);
            merge(&mut out, emission);
        }
        Ok(out)
    }

    fn base(&mut self, spec: &Spec, out: &mut Json, writing: &mut Writing) -> Result<(), FormatError> {
        let value = |key: &str| spec.parameters.find(key).map(|(value, _)| value);
        let mut opacity = Channel::of(self, value("opacity"), 1.0);
        if let Channel::Numbers(texture) = &opacity {
            let mut plain = (**texture).clone();
            out["alphaMode"] = json!("BLEND");
            if let Some(threshold) = plain.threshold.take() {
                out["alphaMode"] = json!("MASK");
                out["alphaCutoff"] = json!(threshold);
            }
            opacity = Channel::Numbers(plain.into());
        } else if matches!(opacity, Channel::Even(x) if x < 1.0) {
            out["alphaMode"] = json!("BLEND");
        }
        let base = colour(spec, "base_color").unwrap_or(Rgb::grey(0.8));
        let alpha = if let Channel::Even(alpha) = opacity { alpha } else { 1.0 };
        let mut pbr = json!({ "baseColorFactor": [base.r, base.g, base.b, alpha] });
        if let Some(picture) = texture(spec, "base_color").and_then(|i| self.scene.textures.get(i)).cloned() {
            pbr["baseColorTexture"] = self.colours(&picture, &opacity, writing)?;
        } else if opacity.texture().is_some() {
            let white = Channel::Even(1.0);
            if let Some(info) = self.numbers([&white, &white, &white, &opacity])? {
                pbr["baseColorTexture"] = info;
            }
        }
        let metal = Channel::of(self, value("base_metalness"), 0.0);
        let rough = Channel::of(self, value("specular_roughness"), 0.3);
        let one = Channel::Even(1.0);
        if let Some(info) = self.numbers([&one, &rough, &metal, &one])? {
            pbr["metallicRoughnessTexture"] = info;
        }
        let packed = metal.texture().is_some() || rough.texture().is_some();
        for (key, channel) in [("metallicFactor", &metal), ("roughnessFactor", &rough)] {
            pbr[key] = match channel {
                Channel::Even(x) if !packed => json!(x),
                _ => json!(1.0),
            };
        }
        out["pbrMetallicRoughness"] = pbr;
        Ok(())
    }

    /// Writes a film's thickness; as a texture, relative to its maximum.
    fn thickness(&mut self, spec: &Spec, of: &mut Json) -> Result<(), FormatError> {
        let picture = texture(spec, "thin_film_thickness").and_then(|i| self.scene.textures.get(i));
        let Some(picture) = picture else {
            let thickness = number(spec, "thin_film_thickness").unwrap_or(0.5) * 1000.0;
            of["iridescenceThicknessMaximum"] = json!(thickness);
            return Ok(());
        };
        let most = picture.texels().fold(0.0, |most, texel| f32::max(most, texel.r));
        let factor = picture.factor * (1.0 / most.max(f32::MIN_POSITIVE));
        let parts = Channel::Numbers(Arc::new(Texture { factor, ..Texture::clone(picture) }));
        let one = Channel::Even(1.0);
        of["iridescenceThicknessMinimum"] = json!(0.0);
        of["iridescenceThicknessMaximum"] = json!(most * 1000.0);
        if let Some(info) = self.numbers([&one, &parts, &one, &one])? {
            of["iridescenceThicknessTexture"] = info;
        }
        Ok(())
    }

    fn extensions(&mut self, spec: &Spec, out: &mut Json, writing: &mut Writing) -> Result<(), FormatError> {
        for &(ours, extension, factor, picture, place) in NUMBERS {
            let Some((value, _)) = spec.parameters.find(ours) else { continue };
            let of = &mut out["extensions"][self.uses(extension)];
            match Channel::of(self, Some(value), 0.0) {
                Channel::Even(x) => of[factor] = json!(x),
                channel => {
                    of[factor] = json!(1.0);
                    let mut channels = [const { &Channel::Even(1.0) }; 4];
                    channels[place] = &channel;
                    if let Some(info) = self.numbers(channels)? {
                        out["extensions"][extension][picture] = info;
                    }
                }
            }
        }
        for &(ours, extension, factor, picture) in COLOURS {
            let Some(shade) = colour(spec, ours) else { continue };
            out["extensions"][self.uses(extension)][factor] = json!(shade.to_array());
            if let Some(found) = texture(spec, ours).and_then(|i| self.scene.textures.get(i)).cloned() {
                out["extensions"][extension][picture] = self.colours(&found, &Channel::Even(1.0), writing)?;
            }
        }
        if let Some(ior) = number(spec, "specular_ior").filter(|ior| *ior != 1.5) {
            out["extensions"][self.uses("KHR_materials_ior")]["ior"] = json!(ior);
        }
        if let Some(weight) = number(spec, "fuzz_weight").filter(|weight| *weight > 0.0) {
            let shade = colour(spec, "fuzz_color").unwrap_or(Rgb::WHITE) * weight;
            let of = &mut out["extensions"][self.uses("KHR_materials_sheen")];
            of["sheenColorFactor"] = json!(shade.to_array());
            if let Some(found) = texture(spec, "fuzz_color").and_then(|i| self.scene.textures.get(i)).cloned()
            {
                out["extensions"]["KHR_materials_sheen"]["sheenColorTexture"] =
                    self.colours(&found, &Channel::Even(1.0), writing)?;
            }
        }
        if number(spec, "thin_film_weight").is_some() {
            let of = &mut out["extensions"][self.uses("KHR_materials_iridescence")];
            of["iridescenceIor"] = json!(number(spec, "thin_film_ior").unwrap_or(1.4));
            self.thickness(spec, of)?;
        }
        let has_coat = texture(spec, "coat_weight").is_some()
            || number(spec, "coat_weight").is_some_and(|weight| weight > 0.0);
        if has_coat && number(spec, "coat_ior") != Some(1.5) {
            writing
                .warn("glTF files cannot store 'coat_ior' of a material: coats there have an index of 1.5");
        }
        if let Some(normals) = self.normals(spec, "coat_normal", writing)? {
            let of = &mut out["extensions"][self.uses("KHR_materials_clearcoat")];
            of["clearcoatNormalTexture"] = normals;
        }
        Ok(())
    }

    /// A normal map with its scale.
    fn normals(
        &mut self,
        spec: &Spec,
        key: &str,
        writing: &mut Writing,
    ) -> Result<Option<Json>, FormatError> {
        let found = texture(spec, key).and_then(|i| self.scene.textures.get(i)).cloned();
        let Some(picture) = found else { return Ok(None) };
        let mut info = self.colours(&picture, &Channel::Even(1.0), writing)?;
        info["scale"] = json!(number(spec, &format!("{key}_scale")).unwrap_or(1.0));
        Ok(Some(info))
    }

    /// Converts the anisotropy. glTF states the roughness across the direction and increases it along;
    /// `principled` states the mean and decreases it across, by the same ratio.
    fn brushing(&mut self, spec: &Spec, out: &mut Json) {
        let Some(ours) = number(spec, "specular_roughness_anisotropy").filter(|ours| *ours > 0.0) else {
            return;
        };
        let ratio = 1.0 - ours;
        let rough = number(spec, "specular_roughness").unwrap_or(0.3);
        let along = rough * rough * (2.0 / (1.0 + ratio * ratio)).sqrt();
        let across = ratio * along;
        let strength = ((along - across) / (1.0 - across).max(1e-6)).clamp(0.0, 1.0).sqrt();
        if texture(spec, "specular_roughness").is_none() {
            out["pbrMetallicRoughness"]["roughnessFactor"] = json!(across.sqrt());
        }
        let turns = number(spec, "anisotropy_rotation").unwrap_or(0.0) - 0.25;
        let of = &mut out["extensions"][self.uses("KHR_materials_anisotropy")];
        of["anisotropyStrength"] = json!(strength);
        of["anisotropyRotation"] = json!(turns * TAU);
    }

    /// Writes the interior of a transmissive material; a non-zero thickness states that it has one.
    fn volume(&mut self, spec: &Spec, out: &mut Json) {
        let is_thin = matches!(spec.parameters.find("thin_walled"), Some((Value::Bool(true), _)));
        if spec.parameters.find("transmission_weight").is_none() || is_thin {
            return;
        }
        let of = &mut out["extensions"][self.uses("KHR_materials_volume")];
        of["thicknessFactor"] = json!(1.0);
        let abbe_number = number(spec, "transmission_dispersion_abbe_number").unwrap_or(20.0);
        let dispersion = number(spec, "transmission_dispersion_scale").unwrap_or(0.0) * 20.0 / abbe_number;
        if dispersion > 0.0 {
            out["extensions"][self.uses("KHR_materials_dispersion")]["dispersion"] = json!(dispersion);
        }
        let of = &mut out["extensions"]["KHR_materials_volume"];
        if let Some(depth) = number(spec, "transmission_depth").filter(|depth| *depth > 0.0) {
            of["attenuationDistance"] = json!(depth);
            let shade = colour(spec, "transmission_color").unwrap_or(Rgb::WHITE);
            of["attenuationColor"] = json!(shade.to_array());
        }
    }
}

/// Emission: a factor of at most 1, and an extension for stronger light.
pub(super) fn emission(document: &mut Document, light: Rgb) -> Json {
    let strength = light.max_channel().max(1.0);
    let mut out = json!({ "emissiveFactor": (light * (1.0 / strength)).to_array() });
    if strength > 1.0 {
        let extension = document.uses("KHR_materials_emissive_strength");
        out["extensions"] = json!({ extension: { "emissiveStrength": strength } });
    }
    out
}

/// Merges the keys of one object into another, including those under `extensions`.
pub(super) fn merge(out: &mut Json, more: Json) {
    let Json::Object(more) = more else { return };
    for (key, value) in more {
        match value {
            Json::Object(below) if key == "extensions" => {
                below.into_iter().for_each(|(name, value)| out["extensions"][name] = value);
            }
            value => out[key] = value,
        }
    }
}
