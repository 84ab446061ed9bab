//! Writes pbrt materials: the inverse of [`super::super::materials`].

use super::document::{Document, float, rgb};
use super::material_parameters::HOLDS;
use super::textures::{AS_IT_IS, Change, TexelMeaning};
use crate::pbrt::spectra::GLASSES;
use bilux_import::FormatError;
use bilux_import::appearance::filling::Medium;
use bilux_import::appearance::fresnel::{extinction_of, reflected_inside};
use bilux_import::output::values::{as_principled, colour, number, texture};
use bilux_import::output::writing::Writing;
use bilux_math::Rgb;
use bilux_math::transcendental::ln;
use bilux_scene::materials::{metal_indices, with_indices};
use bilux_scene::{Spec, Value};

/// Roughness is written as alpha, so pbrt must not take its root.
const AS_ALPHA: &str = " \"bool remaproughness\" false";

/// Medium that fills a material.
fn inside(spec: &Spec) -> Medium {
    Medium {
        absorption: colour(spec, "absorption").unwrap_or(Rgb::BLACK),
        scattering: colour(spec, "scattering").unwrap_or(Rgb::BLACK),
        anisotropy: number(spec, "scattering_anisotropy").unwrap_or(0.0),
        ..Medium::default()
    }
}

impl Document<'_> {
    /// Writes a material; returns its name and what is inside.
    pub(super) fn material(
        &mut self,
        spec: &Spec,
        writing: &mut Writing,
    ) -> Result<(String, Medium), FormatError> {
        let plain = with_indices(spec);
        let spec = if GLASSES.iter().any(|(_, ours)| is_of(spec, ours)) { spec } else { &*plain };
        let is_known = HOLDS.of_kinds.iter().any(|(kind, _)| *kind == spec.kind);
        let principled = if is_known { None } else { as_principled(spec, "pbrt", writing) };
        let spec = principled.as_ref().unwrap_or(spec);
        HOLDS.warn_unsupported(spec, writing);
        let mut medium = Medium::default();
        let given = match spec.kind.as_str() {
            "diffuse" => self.diffuse(spec, "reflectance", 0.7, writing)?,
            "mirror" => {
                writing.warn("mirrors are written as metal, which reflects more at grazing angles");
                let reflectance = self.colour_of(spec, "reflectance", 0.95, AS_IT_IS, writing)?;
                format!(" \"string type\" \"conductor\"{}", renamed(&reflectance, "reflectance"))
            }
            "conductor" => self.metal(spec, writing)?,
            "dielectric" => {
                medium = inside(spec);
                self.glass(spec, "eta", "thin", ["roughness", "anisotropy", "rotation"], writing)?
            }
            "interface" => {
                // Without its grid it would be a block of fog.
                if spec.parameters.find("density").is_none() {
                    medium = inside(spec);
                }
                " \"string type\" \"interface\"".to_owned()
            }
            "principled" => return self.principled(spec, writing),
            "mix" => self.mix(spec, writing)?,
            _ => self.shiny(spec, writing)?,
        };
        self.named(spec, &spec.name, &given, writing).map(|name| (name, medium))
    }

    /// Writes a named material of this kind.
    fn named(
        &mut self,
        spec: &Spec,
        name: &str,
        given: &str,
        writing: &mut Writing,
    ) -> Result<String, FormatError> {
        let name = self.name(name, &spec.kind);
        let mut line = format!("MakeNamedMaterial \"{name}\"{given}");
        if let Some(map) = texture(spec, "normal").and_then(|i| self.scene.textures.get(i)).cloned() {
            let file = self.picture(&map, false, AS_IT_IS, writing)?;
            line += &format!(" \"string normalmap\" \"{file}\"");
        }
        self.line(&line);
        Ok(name)
    }

    /// A colour, or a texture of colours, as the parameter `x`.
    fn colour_of(
        &mut self,
        spec: &Spec,
        key: &str,
        default: f32,
        change: Change,
        writing: &mut Writing,
    ) -> Result<String, FormatError> {
        if let Some(index) = texture(spec, key)
            && let Some(name) = self.texture(index, TexelMeaning::Colours, change, writing)?
        {
            return Ok(format!(" \"texture x\" \"{name}\""));
        }
        Ok(rgb("x", (change.of)(colour(spec, key).unwrap_or(Rgb::grey(default)))))
    }

    fn diffuse(
        &mut self,
        spec: &Spec,
        key: &str,
        default: f32,
        writing: &mut Writing,
    ) -> Result<String, FormatError> {
        let reflectance = self.colour_of(spec, key, default, AS_IT_IS, writing)?;
        Ok(format!(" \"string type\" \"diffuse\"{}", renamed(&reflectance, "reflectance")))
    }

    fn metal(&mut self, spec: &Spec, writing: &mut Writing) -> Result<String, FormatError> {
        let rough = self.roughness(spec, ["roughness", "anisotropy", "rotation"], 0.3, 90.0, "", writing)?;
        let given = match (colour(spec, "reflectance"), colour(spec, "eta"), colour(spec, "k")) {
            (Some(shade), ..) => match texture(spec, "reflectance") {
                Some(_) => {
                    renamed(&self.colour_of(spec, "reflectance", 1.0, AS_IT_IS, writing)?, "reflectance")
                }
                None => {
                    writing.warn(
                        "metal with a reflectance is written with a refractive index of 1 and a matching \
                                  extinction coefficient",
                    );
                    rgb("eta", Rgb::WHITE) + &rgb("k", extinction_of(shade))
                }
            },
            (None, None, None) => {
                let metal = match spec.parameters.find("metal") {
                    Some((Value::Text(name), _)) => name.as_str(),
                    _ => "aluminium",
                };
                // Not by name: pbrt's spectra come from other measurements.
                let [eta, k] = metal_indices(metal).unwrap_or([Rgb::WHITE; 2]);
                rgb("eta", eta) + &rgb("k", k)
            }
            (None, eta, k) => rgb("eta", eta.unwrap_or(Rgb::WHITE)) + &rgb("k", k.unwrap_or(Rgb::WHITE)),
        };
        Ok(format!(" \"string type\" \"conductor\"{given}{rough}{AS_ALPHA}"))
    }

    fn glass(
        &mut self,
        spec: &Spec,
        index: &str,
        thin: &str,
        keys: [&str; 3],
        writing: &mut Writing,
    ) -> Result<String, FormatError> {
        let named = GLASSES.iter().find(|(_, ours)| is_of(spec, ours));
        let index = match named {
            Some((theirs, _)) => format!(" \"spectrum eta\" \"{theirs}\""),
            None => float("eta", number(spec, index).unwrap_or(1.5)),
        };
        if matches!(spec.parameters.find(thin), Some((Value::Bool(true), _))) {
            return Ok(format!(" \"string type\" \"thindielectric\"{index}"));
        }
        let (default, quarter) = if keys[0] == "roughness" { (0.0, 90.0) } else { (0.3, 0.25) };
        let rough = self.roughness(spec, keys, default, quarter, "", writing)?;
        Ok(format!(" \"string type\" \"dielectric\"{index}{rough}{AS_ALPHA}"))
    }

    /// The two alphas; Bilux states the square root of alpha, and an anisotropy that reduces it along the
    /// brushing.
    fn roughness(
        &mut self,
        spec: &Spec,
        [even, ratio, turn]: [&str; 3],
        default: f32,
        quarter: f32,
        before: &str,
        writing: &mut Writing,
    ) -> Result<String, FormatError> {
        if let Some(index) = texture(spec, even) {
            let square = Change { name: "squared", of: &|texel| texel * texel };
            if let Some(name) = self.texture(index, TexelMeaning::Numbers, square, writing)? {
                return Ok(format!(" \"texture {before}roughness\" \"{name}\""));
            }
        }
        let rough = number(spec, even).unwrap_or(default);
        let lacks = number(spec, ratio).unwrap_or(0.0);
        if lacks <= 0.0 {
            return Ok(float(&format!("{before}roughness"), rough * rough));
        }
        let ratio = 1.0 - lacks;
        let across = rough * rough / ((1.0 + ratio * ratio) * 0.5).sqrt();
        let turned = number(spec, turn).unwrap_or(0.0) / quarter;
        if (turned - turned.round()).abs() > 1e-3 {
            writing.warn("pbrt supports anisotropy only along u or v: the nearer one is written");
        }
        let is_along_v = turned.round() as i64 % 2 != 0;
        let (u, v) = if is_along_v { (across, ratio * across) } else { (ratio * across, across) };
        Ok(float(&format!("{before}uroughness"), u) + &float(&format!("{before}vroughness"), v))
    }

    /// Writes metal, glass and a coated base, mixed if a surface combines several of them.
    fn principled(&mut self, spec: &Spec, writing: &mut Writing) -> Result<(String, Medium), FormatError> {
        let white =
            |key: &str| colour(spec, key).is_none_or(|c| c == Rgb::WHITE) && texture(spec, key).is_none();
        let given = |key: &str| texture(spec, key).is_some() || number(spec, key).is_some_and(|x| x > 0.0);
        let all = |key: &str| number(spec, key) == Some(1.0);
        let mut absorbed = Rgb::BLACK;
        let mut whole = None;
        if !all("base_metalness") {
            if !all("transmission_weight") {
                whole = Some(self.below_dielectric(spec, writing)?);
            }
            if given("transmission_weight") {
                absorbed = absorption(spec);
                if absorbed.is_black() && !white("transmission_color") {
                    writing.warn("pbrt files cannot store 'transmission_color' at the surface: left out");
                }
                let keys = ["specular_roughness", "specular_roughness_anisotropy", "anisotropy_rotation"];
                let clear = self.glass(spec, "specular_ior", "thin_walled", keys, writing)?;
                whole = Some(self.blended(spec, whole, clear, "transmission_weight", writing)?);
            }
        }
        if given("base_metalness") {
            let metal = self.coated_metal(spec, writing)?;
            whole = Some(self.blended(spec, whole, metal, "base_metalness", writing)?);
        } else if given("coat_weight") {
            writing.warn("pbrt files can store 'coat_weight' only for metal: left out");
        }
        let name = self.named(spec, &spec.name, &whole.unwrap_or_default(), writing)?;
        Ok((name, Medium { absorption: absorbed, ..Medium::default() }))
    }

    /// Mixes one material with the ones so far; `share` names the parameter with its weight.
    fn blended(
        &mut self,
        spec: &Spec,
        before: Option<String>,
        other: String,
        share: &str,
        writing: &mut Writing,
    ) -> Result<String, FormatError> {
        let Some(before) = before else { return Ok(other) };
        let part = |suffix: &str| format!("{} {suffix}", spec.name);
        let first = self.named(spec, &part("below"), &before, writing)?;
        let second = self.named(spec, &part("above"), &other, writing)?;
        let amount = self.amount(spec, share, writing)?;
        Ok(format!(" \"string type\" \"mix\" \"string materials\" [ \"{first}\" \"{second}\" ]{amount}"))
    }

    fn amount(&mut self, spec: &Spec, key: &str, writing: &mut Writing) -> Result<String, FormatError> {
        if let Some(index) = texture(spec, key)
            && let Some(name) = self.texture(index, TexelMeaning::Numbers, AS_IT_IS, writing)?
        {
            return Ok(format!(" \"texture amount\" \"{name}\""));
        }
        Ok(float("amount", number(spec, key).unwrap_or(0.5)))
    }

    /// The diffuse base with the boundary above it.
    fn below_dielectric(&mut self, spec: &Spec, writing: &mut Writing) -> Result<String, FormatError> {
        let weight = number(spec, "specular_weight").unwrap_or(1.0);
        let behind = number(spec, "diffuse_transmission_weight").unwrap_or(0.0);
        if behind > 0.0 {
            if weight > 0.0 {
                writing.warn("pbrt's diffuse transmission has no dielectric boundary: left out");
            }
            let [front, through] = [1.0 - behind, behind];
            let dimmed = |c: Rgb| c * front;
            let lit = |c: Rgb| c * through;
            let front = Change { name: "of the front", of: &dimmed };
            let reflectance = self.colour_of(spec, "base_color", 0.8, front, writing)?;
            let through = Change { name: "behind", of: &lit };
            let transmittance = self.colour_of(spec, "diffuse_transmission_color", 1.0, through, writing)?;
            return Ok(format!(
                " \"string type\" \"diffusetransmission\"{}{}",
                renamed(&reflectance, "reflectance"),
                renamed(&transmittance, "transmittance")
            ));
        }
        if weight <= 0.0 {
            return self.diffuse(spec, "base_color", 0.8, writing);
        }
        // The reflectance at normal incidence is multiplied by the weight.
        let index = number(spec, "specular_ior").unwrap_or(1.5);
        let root = ((index - 1.0) / (index + 1.0)) * weight.min(1.0).sqrt();
        let index = (1.0 + root) / (1.0 - root);
        let internal_reflectance = reflected_inside(index);
        let seen = |c: Rgb| c.map(|c| c / (1.0 - internal_reflectance + c * internal_reflectance));
        let change = Change { name: "below glass", of: &seen };
        let reflectance = self.colour_of(spec, "base_color", 0.8, change, writing)?;
        let keys = ["specular_roughness", "specular_roughness_anisotropy", "anisotropy_rotation"];
        let rough = self.roughness(spec, keys, 0.3, 0.25, "", writing)?;
        let given = renamed(&reflectance, "reflectance") + &float("eta", index);
        Ok(format!(" \"string type\" \"coateddiffuse\"{given}{rough}{AS_ALPHA}"))
    }

    fn coated_metal(&mut self, spec: &Spec, writing: &mut Writing) -> Result<String, FormatError> {
        let keys = ["specular_roughness", "specular_roughness_anisotropy", "anisotropy_rotation"];
        let shade = self.colour_of(spec, "base_color", 0.8, AS_IT_IS, writing)?;
        let reflectance = renamed(&shade, "reflectance");
        writing.warn("metal with a colour is written as metal with that reflectance at normal incidence");
        if number(spec, "coat_weight").is_none_or(|weight| weight < 0.5) {
            let rough = self.roughness(spec, keys, 0.3, 0.25, "", writing)?;
            return Ok(format!(" \"string type\" \"conductor\"{reflectance}{rough}{AS_ALPHA}"));
        }
        let below = self.roughness(spec, keys, 0.3, 0.25, "conductor.", writing)?;
        let coat = ["coat_roughness", "", ""];
        let above = self.roughness(spec, coat, 0.0, 1.0, "interface.", writing)?;
        let index = float("interface.eta", number(spec, "coat_ior").unwrap_or(1.6));
        Ok(format!(" \"string type\" \"coatedconductor\"{reflectance}{below}{above}{index}{AS_ALPHA}"))
    }

    fn mix(&mut self, spec: &Spec, writing: &mut Writing) -> Result<String, FormatError> {
        let mut part = |key: &str| match spec.parameters.find(key) {
            // Parts are written before the materials that contain them.
            Some((Value::Material(index), _)) => match self.scene.materials.get(*index).cloned() {
                Some(part) => self.material(&part, writing).map(|(name, _)| name),
                None => Ok(String::new()),
            },
            _ => Ok(String::new()),
        };
        let (a, b) = (part("a")?, part("b")?);
        let amount = self.amount(spec, "amount", writing)?;
        Ok(format!(" \"string type\" \"mix\" \"string materials\" [ \"{a}\" \"{b}\" ]{amount}"))
    }

    /// The Phong material: diffuse, with a highlight as wide as its exponent implies.
    fn shiny(&mut self, spec: &Spec, writing: &mut Writing) -> Result<String, FormatError> {
        let strongest = |key, default| colour(spec, key).unwrap_or(Rgb::grey(default)).max_channel();
        let clear = strongest("kt", 0.0);
        let mut left_out = |keys: &[&str], of: &str| {
            for key in keys.iter().filter(|key| spec.parameters.find(key).is_some()) {
                writing.warn(format!("pbrt files cannot store '{key}' of {of}: left out"));
            }
        };
        if clear > 0.5 {
            writing.warn(
                "mostly transmissive materials are written as glass, whose reflection depends only on its index",
            );
            return self.glass(spec, "eta", "thin", ["roughness", "", ""], writing);
        }
        if clear > 0.0 {
            left_out(&["kt", "eta", "thin"], "barely transmissive materials");
        }
        let (kd, ks) = (strongest("kd", 0.7), strongest("ks", 0.3));
        if ks <= 0.0 {
            return self.diffuse(spec, "kd", 0.7, writing);
        }
        writing.warn("highlights of 'phong' are written as metal of the same highlight width and weight");
        let share = (ks / (kd + ks)).clamp(0.01, 0.99);
        let (over_rest, over_share) = (1.0 / (1.0 - share), 1.0 / share);
        let rest = |c: Rgb| (c * over_rest).clamp(0.0, 1.0);
        let part = |c: Rgb| (c * over_share).clamp(0.0, 1.0);
        let below = self.colour_of(spec, "kd", 0.7, Change { name: "the rest", of: &rest }, writing)?;
        let above = self.colour_of(spec, "ks", 0.3, Change { name: "a share", of: &part }, writing)?;
        let alpha = (2.0 / (number(spec, "exponent").unwrap_or(32.0) + 2.0)).sqrt();
        let diffuse = format!(" \"string type\" \"diffuse\"{}", renamed(&below, "reflectance"));
        let metal = format!(
            " \"string type\" \"conductor\"{}{}{AS_ALPHA}",
            renamed(&above, "reflectance"),
            float("roughness", alpha)
        );
        let first = self.named(spec, &format!("{} below", spec.name), &diffuse, writing)?;
        let second = self.named(spec, &format!("{} above", spec.name), &metal, writing)?;
        let amount = float("amount", share);
        Ok(format!(" \"string type\" \"mix\" \"string materials\" [ \"{first}\" \"{second}\" ]{amount}"))
    }
}

/// True if the material names this glass.
fn is_of(spec: &Spec, glass: &str) -> bool {
    matches!(spec.parameters.find("glass"), Some((Value::Text(name), _)) if name == glass)
}

/// A parameter with another name.
fn renamed(parameter: &str, name: &str) -> String {
    parameter.replacen(" x\"", &format!(" {name}\""), 1)
}

/// The absorption that leaves `transmission_color` after `transmission_depth`.
fn absorption(spec: &Spec) -> Rgb {
    let depth = number(spec, "transmission_depth").unwrap_or(0.0);
    if depth <= 0.0 || texture(spec, "transmission_color").is_some() {
        return Rgb::BLACK;
    }
    let left = colour(spec, "transmission_color").unwrap_or(Rgb::WHITE);
    left.map(|left| -ln(left.clamp(1e-6, 1.0)) / depth)
}
