//! Writes bsdfs: the inverse of [`super::super::bsdfs`].

use super::document::Document;
use crate::mitsuba::bsdfs::rough_base_factor;
use bilux_import::FormatError;
use bilux_import::appearance::fresnel::extinction_of;
use bilux_import::output::values::{colour, number, texture};
use bilux_import::output::writing::Writing;
use bilux_math::Rgb;
use bilux_scene::materials::metal_indices;
use bilux_scene::{Spec, Texture, Value};

/// Begins the element of a bsdf of this kind.
type Begin<'b, 'd> = &'b mut dyn FnMut(&mut Document<'d>, &str);

/// The names of roughness, anisotropy and its rotation, and the value of a quarter turn.
type Keys = ([&'static str; 3], f32);
const PLAIN: Keys = (["roughness", "anisotropy", "rotation"], 90.0);
const PRINCIPLED: Keys =
    (["specular_roughness", "specular_roughness_anisotropy", "anisotropy_rotation"], 0.25);

/// Parameters that Mitsuba's principled material does not have, or not as we do.
const OTHERS: [&str; 6] = [
    "specular_color",
    "specular_roughness_anisotropy",
    "anisotropy_rotation",
    "transmission_color",
    "transmission_depth",
    "thin_walled",
];

/// Below this, microfacets are a mirror.
const SMOOTH: f32 = 1e-3;

/// True if light passes through a surface.
pub(super) fn lets_through(spec: &Spec) -> bool {
    let given = |key: &str| texture(spec, key).is_some() || number(spec, key).is_some_and(|x| x > 0.0);
    match spec.kind.as_str() {
        "dielectric" | "interface" | "mix" => true,
        _ => given("transmission_weight") || given("diffuse_transmission_weight"),
    }
}

impl<'d> Document<'d> {
    /// Writes the bsdf of a material, and leaves its element open.
    pub(super) fn bsdf(
        &mut self,
        spec: &Spec,
        begin: &mut dyn FnMut(&mut Document<'d>, &str),
        writing: &mut Writing,
    ) -> Result<(), FormatError> {
        match spec.kind.as_str() {
            "diffuse" => {
                begin(self, "diffuse");
                self.colours(spec, "reflectance", Rgb::grey(0.7), "reflectance", writing)
            }
            "mirror" => {
                begin(self, "conductor");
                self.text("material", "none");
                self.colours(spec, "reflectance", Rgb::grey(0.95), "specular_reflectance", writing)
            }
            "conductor" => self.metal(spec, begin, writing),
            "dielectric" => {
                let is_thin = matches!(spec.parameters.find("thin"), Some((Value::Bool(true), _)));
                self.glass(spec, number(spec, "eta").unwrap_or(1.5), is_thin, "tint", PLAIN, begin, writing)
            }
            "interface" => {
                begin(self, "null");
                Ok(())
            }
            "mix" => self.mix(spec, begin, writing),
            _ => self.principled(spec, begin, writing),
        }
    }

    /// A metal by its indices; one with a reflectance is the metal that reflects as much at normal incidence.
    fn metal(&mut self, spec: &Spec, begin: Begin<'_, 'd>, writing: &mut Writing) -> Result<(), FormatError> {
        if texture(spec, "reflectance").is_some() || texture(spec, "roughness").is_some() {
            begin(self, "principled");
            self.colours(spec, "reflectance", Rgb::grey(0.9), "base_color", writing)?;
            self.number("metallic", 1.0);
            return self.numbers_of(spec, "roughness", 0.3, "roughness", writing);
        }
        let alphas = alphas(spec, PLAIN, 0.3, writing);
        let is_smooth = alphas[0].max(alphas[1]) < SMOOTH;
        begin(self, if is_smooth { "conductor" } else { "roughconductor" });
        let named = match spec.parameters.find("metal") {
            Some((Value::Text(name), _)) => metal_indices(name),
            _ => None,
        };
        let [eta, k] = match (colour(spec, "reflectance"), colour(spec, "eta"), colour(spec, "k")) {
            (Some(shade), ..) => {
                writing.warn(
                    "metal with a colour is written as metal with that reflectance at normal incidence",
                );
                [Rgb::WHITE, extinction_of(shade)]
            }
            (None, Some(eta), k) => [eta, k.unwrap_or(Rgb::WHITE)],
            (None, None, k) => named.unwrap_or([Rgb::WHITE, k.unwrap_or(Rgb::WHITE)]),
        };
        self.rgb("eta", eta);
        self.rgb("k", k);
        if !is_smooth {
            self.roughness(spec, alphas);
        }
        Ok(())
    }

    #[allow(clippy::too_many_arguments, reason = "two kinds of material with names of their own")]
    fn glass(
        &mut self,
        spec: &Spec,
        index: f32,
        is_thin: bool,
        tint: &str,
        keys: Keys,
        begin: Begin<'_, 'd>,
        writing: &mut Writing,
    ) -> Result<(), FormatError> {
        let alphas = alphas(spec, keys, if keys.1 == PLAIN.1 { 0.0 } else { 0.3 }, writing);
        let is_smooth = alphas[0].max(alphas[1]) < SMOOTH;
        begin(
            self,
            match (is_thin, is_smooth) {
                (true, _) => "thindielectric",
                (false, true) => "dielectric",
                (false, false) => "roughdielectric",
            },
        );
        if is_thin && !is_smooth {
            writing.warn("Mitsuba files cannot store rough panes without thickness: written as smooth");
        }
        self.number("int_ior", index);
        self.number("ext_ior", 1.0);
        let is_tinted = texture(spec, tint).is_some() || colour(spec, tint).is_some_and(|c| c != Rgb::WHITE);
        if is_tinted {
            self.colours(spec, tint, Rgb::WHITE, "specular_transmittance", writing)?;
            if tint == "tint" {
                self.colours(spec, tint, Rgb::WHITE, "specular_reflectance", writing)?;
            }
        }
        if !is_thin && !is_smooth {
            self.roughness(spec, alphas);
        }
        Ok(())
    }

    fn mix(&mut self, spec: &Spec, begin: Begin<'_, 'd>, writing: &mut Writing) -> Result<(), FormatError> {
        begin(self, "blendbsdf");
        self.numbers_of(spec, "amount", 0.5, "weight", writing)?;
        for key in ["a", "b"] {
            let part = match spec.parameters.find(key) {
                Some((Value::Material(index), _)) => self.scene.materials.get(*index).cloned(),
                _ => None,
            };
            self.material(&part.unwrap_or_else(|| Spec::new("", "diffuse")), None, writing)?;
        }
        Ok(())
    }

    /// Plastic and glass by what Mitsuba has for them; the rest by its own principled material.
    fn principled(
        &mut self,
        spec: &Spec,
        begin: Begin<'_, 'd>,
        writing: &mut Writing,
    ) -> Result<(), FormatError> {
        let given = |key: &str| texture(spec, key).is_some() || number(spec, key).is_some_and(|x| x > 0.0);
        let index = plain_index(spec);
        let is_bare = !given("base_metalness") && !given("coat_weight");
        let is_thin = matches!(spec.parameters.find("thin_walled"), Some((Value::Bool(true), _)));
        let is_clear = number(spec, "transmission_weight") == Some(1.0);
        if is_bare && is_clear && !given("diffuse_transmission_weight") {
            let tint = if given("transmission_depth") { "" } else { "transmission_color" };
            return self.glass(spec, index, is_thin, tint, PRINCIPLED, begin, writing);
        }
        let is_opaque = !given("transmission_weight") && !given("diffuse_transmission_weight");
        if is_bare && is_opaque && texture(spec, "specular_roughness").is_none() {
            return self.plastic(spec, index, begin, writing);
        }
        writing.warn(
            "Mitsuba's principled material is another one: its diffuse part and its coat look slightly different",
        );
        for key in OTHERS.iter().filter(|key| spec.parameters.find(key).is_some()) {
            writing.warn(format!("Mitsuba files cannot store '{key}' of this material: left out"));
        }
        if number(spec, "coat_weight").is_some_and(|weight| weight > 0.25) {
            writing.warn("Mitsuba files cannot store 'coat_weight' above a quarter: written as that");
        }
        if given("diffuse_transmission_weight") {
            begin(self, "principledthin");
            self.number("diff_trans", 2.0 * number(spec, "diffuse_transmission_weight").unwrap_or(0.0));
        } else {
            begin(self, "principled");
            self.numbers_of(spec, "base_metalness", 0.0, "metallic", writing)?;
            if given("coat_weight") {
                // A coat reflects a quarter of what its number says, with an alpha from 0.1 to 0.001.
                self.number("clearcoat", (4.0 * number(spec, "coat_weight").unwrap_or(0.0)).min(1.0));
                let alpha = number(spec, "coat_roughness").map_or(0.0, |rough| rough * rough);
                self.number("clearcoat_gloss", ((0.1 - alpha) / (0.1 - 0.001)).clamp(0.0, 1.0));
            }
        }
        self.colours(spec, "base_color", Rgb::grey(0.8), "base_color", writing)?;
        self.numbers_of(spec, "specular_roughness", 0.3, "roughness", writing)?;
        if given("transmission_weight") {
            self.numbers_of(spec, "transmission_weight", 0.0, "spec_trans", writing)?;
        }
        if index > 1.0 {
            self.number("eta", index.max(1.001));
        }
        Ok(())
    }

    /// A diffuse base that loses what the boundary above it reflects: as much as Mitsuba's, which divides by the mean.
    fn plastic(
        &mut self,
        spec: &Spec,
        index: f32,
        begin: Begin<'_, 'd>,
        writing: &mut Writing,
    ) -> Result<(), FormatError> {
        if index <= 1.0 {
            begin(self, "diffuse");
            return self.colours(spec, "base_color", Rgb::grey(0.8), "reflectance", writing);
        }
        let alphas = alphas(spec, PRINCIPLED, 0.3, writing);
        let is_smooth = alphas[0] < SMOOTH;
        begin(self, if is_smooth { "plastic" } else { "roughplastic" });
        self.number("int_ior", index);
        self.number("ext_ior", 1.0);
        // The mean of what passes a smooth boundary is the same in both.
        let factor = if is_smooth { 1.0 } else { 1.0 / rough_base_factor(alphas[0], index) };
        match texture(spec, "base_color").and_then(|i| self.scene.textures.get(i)).cloned() {
            Some(map) => {
                let map = Texture { factor: map.factor * factor, ..(*map).clone() };
                self.texture("diffuse_reflectance", &map, writing)?;
            }
            None => {
                let shade = colour(spec, "base_color").unwrap_or(Rgb::grey(0.8));
                self.rgb("diffuse_reflectance", (shade * factor).clamp(0.0, 1.0));
            }
        }
        let is_tinted = texture(spec, "specular_color").is_some()
            || colour(spec, "specular_color").is_some_and(|tint| tint != Rgb::WHITE);
        if is_tinted {
            self.colours(spec, "specular_color", Rgb::WHITE, "specular_reflectance", writing)?;
        }
        if !is_smooth {
            if alphas[0] != alphas[1] {
                writing.warn("Mitsuba files cannot store anisotropy of plastic: left out");
            }
            self.text("distribution", "ggx");
            self.number("alpha", alphas[0]);
        }
        Ok(())
    }

    fn roughness(&mut self, spec: &Spec, [u, v]: [f32; 2]) {
        let is_beckmann = matches!(spec.parameters.find("distribution"), Some((Value::Text(name), _)) if name == "beckmann");
        self.text("distribution", if is_beckmann { "beckmann" } else { "ggx" });
        if u == v {
            self.number("alpha", u);
        } else {
            self.number("alpha_u", u);
            self.number("alpha_v", v);
        }
    }
}

/// The index of refraction that gives the reflectance at normal incidence times the weight.
fn plain_index(spec: &Spec) -> f32 {
    let index = number(spec, "specular_ior").unwrap_or(1.5);
    let weight = number(spec, "specular_weight").unwrap_or(1.0).clamp(0.0, 1.0);
    let root = ((index - 1.0) / (index + 1.0)) * weight.sqrt();
    (1.0 + root) / (1.0 - root)
}

/// The alphas along u and v; of a texture, that of its mean.
fn alphas(spec: &Spec, (keys, quarter): Keys, default: f32, writing: &mut Writing) -> [f32; 2] {
    let [even, ratio, turn] = keys;
    if texture(spec, even).is_some() {
        writing.warn("Mitsuba files cannot store a texture of the roughness of glass: left out");
    }
    let rough = number(spec, even).unwrap_or(default);
    let lacks = number(spec, ratio).unwrap_or(0.0);
    if lacks <= 0.0 {
        return [rough * rough; 2];
    }
    let ratio = 1.0 - lacks;
    let across = rough * rough / ((1.0 + ratio * ratio) * 0.5).sqrt();
    let turned = number(spec, turn).unwrap_or(0.0) / quarter;
    if (turned - turned.round()).abs() > 1e-3 {
        writing.warn("Mitsuba supports anisotropy only along u or v: the nearer one is written");
    }
    let is_along_v = turned.round() as i64 % 2 != 0;
    if is_along_v { [across, ratio * across] } else { [ratio * across, across] }
}
