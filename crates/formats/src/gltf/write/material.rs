//! Materials in the terms of glTF: what [`super::super::material`] reads, the other way round.

use super::Document;
use super::pictures::Channel;
use crate::FormatError;
use crate::values::{colour, number, texture};
use crate::writing::Writing;
use bilux_math::Rgb;
use bilux_math::transcendental::exp;
use bilux_scene::{Spec, Value};
use serde_json::{Value as Json, json};
use std::f32::consts::TAU;

/// Our parameters of `principled` that are an extension's: extension, key there, its texture's key and channel.
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

/// The same of colours.
const COLOURS: &[(&str, &str, &str, &str)] = &[
    ("specular_color", "KHR_materials_specular", "specularColorFactor", "specularColorTexture"),
    (
        "diffuse_transmission_color",
        "KHR_materials_diffuse_transmission",
        "diffuseTransmissionColorFactor",
        "diffuseTransmissionColorTexture",
    ),
];

/// What is written in another way.
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
    "emission",
    "emission_scale",
    "normal",
    "normal_scale",
    "opacity",
    "visible_sides",
    "emission_sides",
];

impl Document<'_> {
    /// A material of any kind.
    pub(super) fn material(&mut self, spec: &Spec, writing: &mut Writing) -> Result<Json, FormatError> {
        let principled = as_principled(spec, self, writing);
        for (key, ..) in &principled.parameters.0 {
            let known = ELSEWHERE.contains(&key.as_str())
                || NUMBERS.iter().any(|row| row.0 == key)
                || COLOURS.iter().any(|row| row.0 == key);
            if !known {
                writing.warn(format!("glTF files hold no '{key}' of a material: left out"));
            }
        }
        let is_front =
            |key| matches!(principled.parameters.find(key), Some((Value::Text(side), _)) if side == "front");
        let is_one_sided = is_front("visible_sides");
        let glows = principled.parameters.find("emission").is_some();
        if glows && is_front("emission_sides") != is_one_sided {
            writing.warn("in glTF files a surface gives light on those sides from which it is seen");
        }
        let mut out = json!({ "doubleSided": !is_one_sided });
        if !spec.name.is_empty() {
            out["name"] = json!(spec.name);
        }
        self.base(&principled, &mut out, writing)?;
        self.extensions(&principled, &mut out, writing)?;
        self.volume(&principled, &mut out);
        self.brushing(&principled, &mut out, writing);
        if let Some(normals) = self.normals(&principled, "normal", writing)? {
            out["normalTexture"] = normals;
        }
        if let Some(picture) =
            texture(&principled, "emission").and_then(|i| self.scene.textures.get(i)).cloned()
        {
            let emission = emission(self, colour(&principled, "emission_scale").unwrap_or(Rgb::WHITE));
            merge(&mut out, emission);
            out["emissiveTexture"] = self.colours(&picture, &Channel::Even(1.0), writing)?;
        } else if let Some(light) = colour(&principled, "emission").filter(|light| !light.is_black()) {
            let emission = emission(self, light);
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
        }
        if number(spec, "thin_film_weight").is_some() {
            let thickness = number(spec, "thin_film_thickness").unwrap_or(0.5) * 1000.0;
            let of = &mut out["extensions"][self.uses("KHR_materials_iridescence")];
            of["iridescenceThicknessMaximum"] = json!(thickness);
            of["iridescenceIor"] = json!(number(spec, "thin_film_ior").unwrap_or(1.4));
        }
        if let Some(normals) = self.normals(spec, "coat_normal", writing)? {
            let of = &mut out["extensions"][self.uses("KHR_materials_clearcoat")];
            of["clearcoatNormalTexture"] = normals;
        }
        Ok(())
    }

    /// A picture of normals, and how far these lean.
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

    /// Theirs is smooth across and rougher along, ours of the mean and smoother across, by the same ratio.
    fn brushing(&mut self, spec: &Spec, out: &mut Json, writing: &mut Writing) {
        let Some(ours) = number(spec, "specular_roughness_anisotropy").filter(|ours| *ours > 0.0) else {
            if texture(spec, "specular_roughness_anisotropy").is_some() {
                writing.warn("anisotropy from a picture is not written");
            }
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

    /// What is inside of what is clear; a thickness says that there is one.
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

/// What materials of all kinds have.
const OF_ANY: &[&str] =
    &["emission", "emission_scale", "emission_sides", "normal", "normal_scale", "opacity", "visible_sides"];

/// What any material comes to as `principled`.
fn as_principled(spec: &Spec, document: &Document, writing: &mut Writing) -> Spec {
    let mut out = Spec::new(&spec.name, "principled");
    for &key in OF_ANY {
        if let Some((value, at)) = spec.parameters.find(key) {
            out.parameters.set_at(key, value.clone(), at.clone());
        }
    }
    let taken =
        |key: &str, default: Value| spec.parameters.find(key).map_or(default, |(value, _)| value.clone());
    match spec.kind.as_str() {
        "principled" => {
            let mut same = spec.clone();
            // Light that goes through is tinted by the base there.
            if number(spec, "transmission_depth").unwrap_or(0.0) == 0.0
                && number(spec, "transmission_weight") == Some(1.0)
            {
                same.parameters.set("base_color", taken("transmission_color", 1.0.into()));
            }
            same
        }
        "diffuse" => {
            if let Some((roughness, at)) = spec.parameters.find("roughness") {
                out.parameters.set_at("base_diffuse_roughness", roughness.clone(), at.clone());
            }
            out.with("base_color", taken("reflectance", 0.7.into()))
                .with("specular_weight", 0.0)
                .with("specular_roughness", 1.0)
        }
        "mirror" => out
            .with("base_color", taken("reflectance", 0.95.into()))
            .with("base_metalness", 1.0)
            .with("specular_roughness", 0.0),
        "conductor" => {
            let surface = bilux_scene::materials::straight_on(spec).unwrap_or(Rgb::grey(0.9));
            out.with("base_color", taken("reflectance", surface.into()))
                .with("base_metalness", 1.0)
                .with("specular_roughness", taken("roughness", 0.3.into()))
        }
        "dielectric" => {
            let absorbed = colour(spec, "absorption").unwrap_or(Rgb::BLACK);
            let out = out
                .with("base_color", taken("tint", 1.0.into()))
                .with("transmission_weight", 1.0)
                .with("specular_ior", taken("eta", 1.5.into()))
                .with("specular_roughness", taken("roughness", 0.0.into()))
                .with("thin_walled", taken("thin", false.into()));
            let out = match number(spec, "dispersion") {
                Some(dispersion) => parting(out, dispersion),
                None => out,
            };
            if absorbed.is_black() {
                out
            } else {
                out.with("transmission_depth", 1.0).with("transmission_color", absorbed.map(|a| exp(-a)))
            }
        }
        "phong" => {
            let exponent = number(spec, "exponent").unwrap_or(10.0).max(0.0);
            writing.warn(
                "a phong material becomes one of metal and roughness, which reflects a little otherwise",
            );
            out.with("base_color", taken("kd", 0.7.into()))
                .with("specular_color", taken("ks", 0.2.into()))
                .with("specular_roughness", (2.0 / (exponent + 2.0)).sqrt().sqrt())
        }
        other => {
            let first = spec.parameters.find("a").and_then(|(value, _)| match value {
                Value::Material(index) => document.scene.materials.get(*index),
                _ => None,
            });
            writing
                .warn(format!("glTF files hold no material '{other}': its first part stands in its place"));
            match first.filter(|first| first.kind != "mix") {
                Some(first) => Spec { name: spec.name.clone(), ..as_principled(first, document, writing) },
                None => out,
            }
        }
    }
}

/// With glTF's dispersion as OpenPBR has it: how much of what an Abbe number says, 20 where nothing else is said.
fn parting(spec: Spec, dispersion: f32) -> Spec {
    spec.with("transmission_dispersion_scale", dispersion.min(1.0))
        .with("transmission_dispersion_abbe_number", 20.0 / dispersion.max(1.0))
}

/// Light that a surface gives out: a factor of at most 1, and what is above it in an extension.
pub(super) fn emission(document: &mut Document, light: Rgb) -> Json {
    let strength = light.max_channel().max(1.0);
    let mut out = json!({ "emissiveFactor": (light * (1.0 / strength)).to_array() });
    if strength > 1.0 {
        let extension = document.uses("KHR_materials_emissive_strength");
        out["extensions"] = json!({ extension: { "emissiveStrength": strength } });
    }
    out
}

/// The keys of one object into another, those below `extensions` too.
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
