//! `translucent`: paper, leaves, lampshades: a thin sheet that scatters light diffusely to both of its sides.

use super::{
    AsPrincipled, EMISSION, EMISSION_SCALE, EMISSION_SIDES, Material, MaterialEntry, NORMAL, NORMAL_SCALE,
    OPACITY, colour_map, reflectance,
};
use crate::bsdf::{Albedo, Bsdf, CoatedDiffuse, Coating, Lobe};
use crate::classic::ClassicMaterial;
use crate::parameters::{Spec, Value};
use crate::surface::Surface;
use crate::texture::ColourMap;
use bilux_math::Rgb;
use bilux_math::registry::Entry;
use std::sync::Arc;

pub(super) const ENTRY: MaterialEntry = MaterialEntry {
    entry: Entry {
        name: "translucent",
        summary: "paper, leaves, lampshades: diffuse reflection and diffuse transmission",
        source: "pbrt 2023",
        parameters: &[
            reflectance("reflectance", "fraction of the light that is reflected", "0.4"),
            reflectance(
                "transmittance",
                "fraction of the light that is transmitted diffusely; both are scaled down if they sum to more than 1",
                "0.4",
            ),
            EMISSION,
            EMISSION_SCALE,
            EMISSION_SIDES,
            OPACITY,
            NORMAL,
            NORMAL_SCALE,
        ],
    },
    build: |reader, inputs| {
        Ok(Arc::new(Translucent {
            reflectance: colour_map(reader, "reflectance", inputs)?,
            transmittance: colour_map(reader, "transmittance", inputs)?,
        }))
    },
    principled: Some(AsPrincipled {
        keeps: &["reflectance", "transmittance"],
        differs: "gives a textured side only the light that the other side leaves",
        convert,
    }),
};

/// The diffuse part of `principled` is divided between the two sides: by the largest channels of the two colours; where one
/// is a texture, it gets what the other leaves; evenly between two textures.
fn convert(material: &Spec, principled: Spec) -> Spec {
    let value = |key| material.value_or(key, 0.4f32);
    let (reflected, transmitted) = (channels(&value("reflectance")), channels(&value("transmittance")));
    let largest = |channels: &[f64]| channels.iter().copied().fold(0.0, f64::max);
    let share = match (reflected.as_deref().map(largest), transmitted.as_deref().map(largest)) {
        (Some(r), Some(t)) if r + t > 0.0 => t / (r + t),
        (Some(r), None) => (1.0 - r).clamp(0.0, 1.0),
        (None, Some(t)) => t.clamp(0.0, 1.0),
        _ => 0.5,
    };
    let part = |key, channels: Option<Vec<f64>>, share: f64| match channels {
        Some(channels) => {
            let scale = if share > 0.0 { 1.0 / share } else { 1.0 };
            let scaled: Vec<Value> = channels.iter().map(|c| Value::Number((c * scale).min(1.0))).collect();
            if let [one] = &scaled[..] { one.clone() } else { Value::List(scaled) }
        }
        None => value(key),
    };
    principled
        .with("base_color", part("reflectance", reflected, 1.0 - share))
        .with("diffuse_transmission_weight", share as f32)
        .with("diffuse_transmission_color", part("transmittance", transmitted, share))
        .with("specular_weight", 0.0)
        .with("specular_roughness", 1.0)
}

/// The numbers of a colour; `None` for a texture.
fn channels(value: &Value) -> Option<Vec<f64>> {
    match value {
        Value::Integer(i) => Some(vec![*i as f64]),
        Value::Number(x) => Some(vec![*x]),
        Value::List(list) => {
            let channels: Vec<f64> = list.iter().filter_map(channels).flatten().collect();
            (channels.len() == list.len()).then_some(channels)
        }
        _ => None,
    }
}

struct Translucent {
    reflectance: ColourMap,
    transmittance: ColourMap,
}

impl Translucent {
    /// The reflected and the transmitted fraction at a point, at most 1 together.
    fn fractions(&self, surface: &Surface) -> [Rgb; 2] {
        let vertex = surface.vertex_kd.unwrap_or(Rgb::WHITE);
        let of = |map: &ColourMap| (map.at(surface.uvs()) * vertex).clamp(0.0, 1.0);
        let (reflected, transmitted) = (of(&self.reflectance), of(&self.transmittance));
        let scale = (reflected + transmitted).map(|sum| 1.0 / sum.max(1.0));
        [reflected * scale, transmitted * scale]
    }
}

impl Material for Translucent {
    fn bsdf(&self, surface: &Surface) -> Bsdf {
        let [reflected, transmitted] = self.fractions(surface);
        let sheet = CoatedDiffuse::sheet(reflected, transmitted, Albedo::NONE, Coating::NONE);
        Bsdf::of(surface.n_shade, surface.n_geom, Lobe::CoatedDiffuse(sheet))
    }

    fn classic(&self, surface: &Surface) -> ClassicMaterial {
        let [kd, _] = self.fractions(surface);
        ClassicMaterial { ka: kd, kd, ..ClassicMaterial::default() }
    }
}
