//! Writes materials as `UsdPreviewSurface`: the inverse of [`crate::shading`].

use super::document::{Document, Look};
use super::draft::Draft;
use super::text::{Text, quoted};
use super::textures::{Input, Meaning};
use bilux_import::FormatError;
use bilux_import::output::values::{MaterialSupport, colour, nearest_principled, number, texture};
use bilux_import::output::writing::Writing;
use bilux_math::Rgb;
use bilux_scene::{Spec, Value};

const HOLDS: MaterialSupport = MaterialSupport {
    format: "USD",
    of_kinds: &[(
        "principled",
        &[
            "base_color",
            "base_metalness",
            "specular_weight",
            "specular_color",
            "specular_ior",
            "specular_roughness",
            "coat_weight",
            "coat_roughness",
            "coat_ior",
        ],
    )],
    of_any: &["emission", "emission_scale", "opacity", "normal", "normal_scale", "visible_sides"],
    textured: Some(&[
        "base_color",
        "base_metalness",
        "specular_roughness",
        "coat_weight",
        "coat_roughness",
        "emission",
        "opacity",
        "normal",
    ]),
};

impl Document<'_> {
    /// Look of a surface of a material, whose prim is written on first use. Surfaces whose vertices have colours need a
    /// material of their own, which shows these.
    pub(super) fn look(
        &mut self,
        material: usize,
        has_colours: bool,
        writing: &mut Writing,
    ) -> Result<Look, FormatError> {
        if let Some(known) = self.looks.get(&(material, has_colours)) {
            return Ok(known.clone());
        }
        let Some(spec) = self.scene.materials.get(material).cloned() else { return Ok(Look::default()) };
        let look = match plain(&spec) {
            Some(look) => look,
            None => self.material(&spec, has_colours, writing)?,
        };
        self.looks.insert((material, has_colours), look.clone());
        Ok(look)
    }

    fn material(
        &mut self,
        original: &Spec,
        has_colours: bool,
        writing: &mut Writing,
    ) -> Result<Look, FormatError> {
        let spec = &nearest_principled(original, self.scene, "USD", writing);
        let glass = number(spec, "transmission_weight").unwrap_or(0.0);
        HOLDS.warn_unsupported(spec, writing);
        let is_front =
            |key| matches!(spec.parameters.find(key), Some((Value::Text(side), _)) if side == "front");
        if spec.parameters.find("emission").is_some() && is_front("emission_sides") {
            writing.warn("in USD files a surface emits light on both sides");
        }
        let name = self.material_names.unused(&original.name, "material");
        let path = Self::material_path(&name);
        let mut text = std::mem::replace(&mut self.materials, Text::at_depth(2));
        let metadata = match name == original.name || original.name.is_empty() {
            true => Vec::new(),
            false => vec![format!("displayName = {}", quoted(&original.name))],
        };
        text.open(&format!("def Material \"{name}\""), &metadata);
        text.line(&format!("token outputs:surface.connect = <{path}/Surface.outputs:surface>"));
        let mut nodes = Text { out: Vec::new(), ..text.clone() };
        text.open("def Shader \"Surface\"", &[]);
        text.line("uniform token info:id = \"UsdPreviewSurface\"");
        let mut draft = Draft { spec, path: &path, text: &mut text, nodes: &mut nodes };
        let factor = self.base(&mut draft, has_colours, writing)?;
        self.reflection(&mut draft, writing)?;
        self.opacity(&mut draft, glass, writing)?;
        draft.text.line("token outputs:surface");
        text.close();
        text.out.extend(nodes.out);
        text.close();
        self.materials = text;
        Ok(Look { path, colour: None, opacity: None, factor, has_two_sides: !is_front("visible_sides") })
    }

    /// Base colour, metalness, emission and the normal map; returns the factor on the colours of vertices.
    fn base(
        &mut self,
        draft: &mut Draft,
        has_colours: bool,
        writing: &mut Writing,
    ) -> Result<Rgb, FormatError> {
        let spec = draft.spec;
        let base = colour(spec, "base_color").unwrap_or(Rgb::grey(0.8));
        let map = texture(spec, "base_color").and_then(|i| self.scene.textures.get(i)).cloned();
        if has_colours && map.is_some() {
            writing.warn("USD files cannot store colours of vertices on top of a texture: left out");
        }
        match map {
            Some(map) => {
                let input = Input { name: "diffuseColor", meaning: Meaning::Colours, scale: Rgb::WHITE };
                self.texture(draft, input, &map, writing)?;
            }
            None if has_colours => draft.vertex_colours(),
            None => draft.colour("diffuseColor", base),
        }
        self.number_of(draft, "base_metalness", "metallic", 0.0, writing)?;
        let scale = colour(spec, "emission_scale").unwrap_or(Rgb::WHITE);
        if let Some(map) = texture(spec, "emission").and_then(|i| self.scene.textures.get(i)).cloned() {
            self.texture(
                draft,
                Input { name: "emissiveColor", meaning: Meaning::Colours, scale },
                &map,
                writing,
            )?;
        } else if let Some(light) = colour(spec, "emission").filter(|light| !light.is_black()) {
            draft.colour("emissiveColor", light * scale);
        }
        if let Some(map) = texture(spec, "normal").and_then(|i| self.scene.textures.get(i)).cloned() {
            let strength = Rgb::grey(number(spec, "normal_scale").unwrap_or(1.0));
            let input = Input { name: "normal", meaning: Meaning::Normals, scale: strength };
            self.texture(draft, input, &map, writing)?;
        }
        Ok(base)
    }

    /// Adds what is reflected at the surface, and at a coat on it.
    fn reflection(&mut self, draft: &mut Draft, writing: &mut Writing) -> Result<(), FormatError> {
        let spec = draft.spec;
        self.number_of(draft, "specular_roughness", "roughness", 0.3, writing)?;
        // The weight scales the reflectance at normal incidence, which follows from the index alone here.
        let weight = number(spec, "specular_weight").unwrap_or(1.0);
        let ior = number(spec, "specular_ior").unwrap_or(1.5);
        let ior = match weight == 1.0 {
            true => ior,
            false => {
                let root = weight.max(0.0).sqrt() * ((ior - 1.0) / (ior + 1.0));
                (1.0 + root) / (1.0 - root)
            }
        };
        draft.number("ior", ior);
        self.tint(draft, ior, writing);
        let has_coat = texture(spec, "coat_weight").is_some()
            || number(spec, "coat_weight").is_some_and(|weight| weight > 0.0);
        if has_coat {
            if number(spec, "coat_ior") != Some(1.5) {
                writing.warn(
                    "USD files cannot store 'coat_ior' of a material: coats there have an index of 1.5",
                );
            }
            self.number_of(draft, "coat_weight", "clearcoat", 0.0, writing)?;
            self.number_of(draft, "coat_roughness", "clearcoatRoughness", 0.0, writing)?;
        }
        Ok(())
    }

    /// The colour of reflections, for which there is a workflow without metal.
    fn tint(&self, draft: &mut Draft, ior: f32, writing: &mut Writing) {
        let tint = colour(draft.spec, "specular_color").unwrap_or(Rgb::WHITE);
        let is_textured = |key| texture(draft.spec, key).is_some();
        if tint == Rgb::WHITE && !is_textured("specular_color") {
            return;
        }
        let is_metal =
            is_textured("base_metalness") || number(draft.spec, "base_metalness").unwrap_or(0.0) > 0.0;
        if is_metal || is_textured("specular_color") {
            writing.warn("USD files cannot store 'specular_color' of metal, nor as a texture: left out");
            return;
        }
        draft.text.line("int inputs:useSpecularWorkflow = 1");
        draft.colour("specularColor", tint * at_normal_incidence(ior));
    }

    /// Opacity. What a pane of glass reflects at its two sides stays, and the rest passes straight through.
    fn opacity(&mut self, draft: &mut Draft, glass: f32, writing: &mut Writing) -> Result<(), FormatError> {
        let spec = draft.spec;
        let ior = number(spec, "specular_ior").unwrap_or(1.5);
        let once = at_normal_incidence(ior);
        let passes = glass * (1.0 - 2.0 * once / (1.0 + once));
        if glass > 0.0 {
            writing.warn("glass is written as a transparent surface, which refracts nothing");
        }
        if let Some(map) = texture(spec, "opacity").and_then(|i| self.scene.textures.get(i)).cloned() {
            if let Some(threshold) = map.threshold {
                draft.number("opacityThreshold", threshold);
            }
            let scale = Rgb::grey(1.0 - passes);
            self.texture(draft, Input { name: "opacity", meaning: Meaning::Numbers, scale }, &map, writing)?;
            return Ok(());
        }
        let opacity = number(spec, "opacity").unwrap_or(1.0) * (1.0 - passes);
        if opacity < 1.0 {
            draft.number("opacity", opacity);
        }
        Ok(())
    }

    /// A number, or a texture of numbers.
    fn number_of(
        &mut self,
        draft: &mut Draft,
        key: &str,
        name: &'static str,
        default: f32,
        writing: &mut Writing,
    ) -> Result<(), FormatError> {
        match texture(draft.spec, key).and_then(|i| self.scene.textures.get(i)).cloned() {
            Some(map) => {
                let input = Input { name, meaning: Meaning::Numbers, scale: Rgb::WHITE };
                self.texture(draft, input, &map, writing)?;
            }
            None => draft.number(name, number(draft.spec, key).unwrap_or(default)),
        }
        Ok(())
    }
}

/// Reflectance of a boundary of this index at normal incidence.
fn at_normal_incidence(ior: f32) -> f32 {
    let root = (ior - 1.0) / (ior + 1.0);
    root * root
}

/// The look of a material that says nothing but a colour and an opacity, as files without materials have it.
fn plain(spec: &Spec) -> Option<Look> {
    let is_constant = |(key, value, _): &(String, Value, _)| {
        ["kd", "opacity"].contains(&key.as_str()) && !matches!(value, Value::Texture(_))
    };
    let is_plain = spec.kind == "phong" && spec.parameters.0.iter().all(is_constant);
    is_plain.then(|| Look::plain(colour(spec, "kd"), number(spec, "opacity").filter(|o| *o < 1.0)))
}
