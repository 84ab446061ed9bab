//! Converts materials of any kind to `principled`, the only one that glTF can represent.

use super::Document;
use crate::values::{MaterialSupport, colour, coloured_metal, number};
use crate::writing::Writing;
use bilux_math::Rgb;
use bilux_math::transcendental::exp;
use bilux_scene::materials::with_indices;
use bilux_scene::{Spec, Value};

/// The supported parameters of all other kinds; textures are checked after the conversion to `principled`.
pub(super) const OTHERS: MaterialSupport = MaterialSupport {
    format: "glTF",
    of_kinds: &[
        ("diffuse", &["reflectance", "roughness"]),
        ("mirror", &["reflectance"]),
        ("conductor", &["metal", "eta", "k", "reflectance", "roughness"]),
        ("dielectric", &["glass", "eta", "dispersion", "tint", "absorption", "thin", "roughness"]),
        ("phong", &["kd", "ks", "exponent"]),
    ],
    of_any: OF_ANY,
    textured: None,
};

/// The supported parameters that all kinds share.
pub(super) const OF_ANY: &[&str] =
    &["emission", "emission_scale", "emission_sides", "normal", "normal_scale", "opacity", "visible_sides"];

/// Converts any material to `principled`.
pub(super) fn as_principled(spec: &Spec, document: &Document, writing: &mut Writing) -> Spec {
    let spec = &*with_indices(spec);
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
            // glTF tints transmitted light by the base colour.
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
        "conductor" => coloured_metal(out, spec),
        "dielectric" => {
            let absorbed = colour(spec, "absorption").unwrap_or(Rgb::BLACK);
            let out = out
                .with("base_color", taken("tint", 1.0.into()))
                .with("transmission_weight", 1.0)
                .with("specular_ior", taken("eta", 1.5.into()))
                .with("specular_roughness", taken("roughness", 0.0.into()))
                .with("thin_walled", taken("thin", false.into()));
            let out = match number(spec, "dispersion") {
                Some(dispersion) => with_dispersion(out, dispersion),
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
                "a phong material is written as metallic-roughness, which reflects slightly differently",
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
            writing.warn(format!(
                "glTF files cannot store the material '{other}': its first part is written instead"
            ));
            match first.filter(|first| first.kind != "mix") {
                Some(first) => Spec { name: spec.name.clone(), ..as_principled(first, document, writing) },
                None => out,
            }
        }
    }
}

/// Converts glTF's dispersion to OpenPBR's: a scale on the dispersion of an Abbe number, 20 by default.
fn with_dispersion(spec: Spec, dispersion: f32) -> Spec {
    spec.with("transmission_dispersion_scale", dispersion.min(1.0))
        .with("transmission_dispersion_abbe_number", 20.0 / dispersion.max(1.0))
}
