//! `diffuse`: matte, equally bright from every direction.

use super::{
    AsPrincipled, EMISSION, EMISSION_SCALE, EMISSION_SIDES, Material, MaterialEntry, NORMAL, NORMAL_SCALE,
    OPACITY, VISIBLE_SIDES, colour_map, number_map, reflectance,
};
use crate::bsdf::{Albedo, Bsdf, CoatedDiffuse, Coating, Lambert, Lobe};
use crate::classic::ClassicMaterial;
use crate::surface::Surface;
use crate::texture::{ColourMap, NumberMap};
use bilux_math::Rgb;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use std::sync::Arc;

pub(super) const ENTRY: MaterialEntry = MaterialEntry {
    entry: Entry {
        name: "diffuse",
        summary: "diffuse reflection",
        source: "Lambert 1760",
        parameters: &[
            reflectance("reflectance", "reflected fraction of the light", "0.7"),
            Parameter {
                name: "roughness",
                summary: "roughness of the diffuse microsurface: 0 is Lambertian, 1 is like clay or the moon, which \
                          are brighter when the light is behind the viewer",
                unit: "",
                kind: ParameterKind::NumberTexture { min: 0.0, max: 1.0 },
                default: "0",
            },
            EMISSION,
            EMISSION_SCALE,
            EMISSION_SIDES,
            OPACITY,
            VISIBLE_SIDES,
            NORMAL,
            NORMAL_SCALE,
        ],
    },
    build: |reader, inputs| {
        Ok(Arc::new(Diffuse {
            reflectance: colour_map(reader, "reflectance", inputs)?,
            roughness: number_map(reader, "roughness", inputs)?,
        }))
    },
    principled: Some(AsPrincipled {
        keeps: &["reflectance", "roughness"],
        differs: "",
        convert: |material, mut principled| {
            if let Some((roughness, at)) = material.parameters.find("roughness") {
                principled.parameters.set_at("base_diffuse_roughness", roughness.clone(), at.clone());
            }
            principled
                .with("base_color", material.value_or("reflectance", 0.7))
                .with("specular_weight", 0.0)
                .with("specular_roughness", 1.0)
        },
    }),
};

struct Diffuse {
    reflectance: ColourMap,
    roughness: NumberMap,
}

impl Diffuse {
    fn albedo(&self, surface: &Surface) -> Rgb {
        let vertex = surface.vertex_kd.unwrap_or(Rgb::WHITE);
        (self.reflectance.at(surface.uvs()) * vertex).clamp(0.0, 1.0)
    }
}

impl Material for Diffuse {
    fn bsdf(&self, surface: &Surface) -> Bsdf {
        let albedo = self.albedo(surface);
        let roughness = self.roughness.at(surface.uvs());
        let lobe = if roughness > 0.0 {
            Lobe::CoatedDiffuse(
                CoatedDiffuse::new(albedo, Albedo::NONE, Coating::NONE).rough(roughness, albedo),
            )
        } else {
            Lobe::Lambert(Lambert { albedo })
        };
        Bsdf::of(surface.n_shade, surface.n_geom, lobe)
    }

    fn is_lambertian(&self) -> bool {
        self.roughness.texture.is_none() && self.roughness.number <= 0.0
    }

    fn lambertian_reflectance(&self, surface: &Surface) -> Rgb {
        self.albedo(surface)
    }

    fn constant_lambertian_reflectance(&self) -> Option<Rgb> {
        let is_constant = self.is_lambertian() && self.reflectance.texture.is_none();
        is_constant.then(|| self.reflectance.colour.clamp(0.0, 1.0))
    }

    fn classic(&self, surface: &Surface) -> ClassicMaterial {
        let kd = self.albedo(surface);
        ClassicMaterial { ka: kd, kd, ..ClassicMaterial::default() }
    }
}
