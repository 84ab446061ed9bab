//! Writes materials: what lies around a bsdf, and what a surface has next to it.

use super::document::{Document, Emission, Look};
use bilux_import::FormatError;
use bilux_import::output::values::{MaterialSupport, colour, nearest_principled, number, texture};
use bilux_import::output::writing::Writing;
use bilux_math::Rgb;
use bilux_scene::materials::with_indices;
use bilux_scene::{Spec, Texture, Value};
use std::sync::Arc;

/// The parameters that Mitsuba's materials can express.
const HOLDS: MaterialSupport = MaterialSupport {
    format: "Mitsuba",
    of_kinds: &[
        ("diffuse", &["reflectance"]),
        ("mirror", &["reflectance"]),
        (
            "conductor",
            &["metal", "eta", "k", "reflectance", "roughness", "anisotropy", "rotation", "distribution"],
        ),
        (
            "dielectric",
            &[
                "glass",
                "eta",
                "tint",
                "absorption",
                "scattering",
                "scattering_anisotropy",
                "thin",
                "roughness",
                "anisotropy",
                "rotation",
                "distribution",
            ],
        ),
        ("interface", &["absorption", "scattering", "scattering_anisotropy", "density"]),
        (
            "principled",
            &[
                "base_color",
                "base_metalness",
                "specular_weight",
                "specular_color",
                "specular_ior",
                "specular_roughness",
                "specular_roughness_anisotropy",
                "anisotropy_rotation",
                "transmission_weight",
                "transmission_color",
                "transmission_depth",
                "thin_walled",
                "coat_weight",
                "coat_roughness",
                "diffuse_transmission_weight",
            ],
        ),
        ("mix", &["a", "b", "amount"]),
    ],
    of_any: &["emission", "emission_scale", "emission_sides", "opacity", "normal"],
    textured: Some(&[
        "reflectance",
        "roughness",
        "tint",
        "base_color",
        "base_metalness",
        "specular_roughness",
        "specular_color",
        "transmission_weight",
        "amount",
        "emission",
        "opacity",
        "normal",
    ]),
};

impl Document<'_> {
    /// Look of a surface of a material, whose bsdf is written on first use.
    pub(super) fn look(&mut self, material: usize, writing: &mut Writing) -> Result<Look, FormatError> {
        if let Some(known) = self.looks.get(&material) {
            return Ok(known.clone());
        }
        let Some(spec) = self.scene.materials.get(material).cloned() else { return Ok(Look::default()) };
        let id = self.id(&spec.name, "material");
        let medium = self.material(&spec, Some(&id), writing)?;
        let emission = self.emission(&spec, writing)?;
        let look = Look { bsdf: id, medium, emission };
        self.looks.insert(material, look.clone());
        Ok(look)
    }

    /// Writes the bsdf of a material of any kind; returns the medium inside.
    pub(super) fn material(
        &mut self,
        original: &Spec,
        id: Option<&str>,
        writing: &mut Writing,
    ) -> Result<Option<super::document::Inside>, FormatError> {
        let plain = with_indices(original);
        let is_known = HOLDS.of_kinds.iter().any(|(kind, _)| *kind == plain.kind);
        let spec = match is_known {
            true => plain.into_owned(),
            false => nearest_principled(&plain, self.scene, "Mitsuba", writing),
        };
        HOLDS.warn_unsupported(&spec, writing);
        let mut id = id.map(str::to_owned);
        let mut begin = |document: &mut Self, kind: &str| {
            let id = id.take().map_or_else(String::new, |id| format!(" id=\"{id}\""));
            document.open(&format!("bsdf type=\"{kind}\"{id}"));
        };
        let mut around = 0;
        let is_masked =
            texture(&spec, "opacity").is_some() || number(&spec, "opacity").is_some_and(|o| o < 1.0);
        if is_masked {
            begin(self, "mask");
            self.numbers_of(&spec, "opacity", 1.0, "opacity", writing)?;
            around += 1;
        }
        // Our surfaces have two sides.
        if !super::bsdfs::lets_through(&spec) {
            begin(self, "twosided");
            around += 1;
        }
        if let Some(map) = texture(&spec, "normal").and_then(|i| self.scene.textures.get(i)).cloned() {
            begin(self, "normalmap");
            self.texture("normalmap", &Texture { is_data: true, ..(*map).clone() }, writing)?;
            around += 1;
        }
        self.bsdf(&spec, &mut begin, writing)?;
        for _ in 0..=around {
            self.close("bsdf");
        }
        Ok(super::media::inside(&spec))
    }

    fn emission(&mut self, spec: &Spec, writing: &mut Writing) -> Result<Option<Emission>, FormatError> {
        let scale = colour(spec, "emission_scale").unwrap_or(Rgb::WHITE);
        let is_in_front =
            matches!(spec.parameters.find("emission_sides"), Some((Value::Text(t), _)) if t == "front");
        let Some(map) = texture(spec, "emission").and_then(|i| self.scene.textures.get(i)) else {
            let light = colour(spec, "emission").map(|light| light * scale).filter(|light| !light.is_black());
            return Ok(light.map(|light| Emission::Even(light, !is_in_front)));
        };
        let map = Arc::new(Texture { factor: map.factor * scale, ..(**map).clone() });
        let (text, done) = self.aside(2, |document| document.texture("radiance", &map, writing));
        done?;
        Ok(Some(Emission::Picture(text, !is_in_front)))
    }
}
