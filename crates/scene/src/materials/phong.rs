//! `phong`: the material of the paper, with every constant of Equations 1 and 2.
//!
//! For the physical integrators it is a diffuse lobe (kd), a mirror (ks · reflectivity), a normalised highlight (the
//! rest of ks), and, where kt is given, smooth glass in place of all three. Where kd + ks > 1 the lobes are scaled down
//! together, so that it never reflects more light than it receives.

use super::{
    ABSORPTION, AsPrincipled, EMISSION, EMISSION_SCALE, EMISSION_SIDES, ETA, Material, MaterialEntry, NORMAL,
    NORMAL_SCALE, OPACITY, THIN, colour_map, reflectance, spread,
};
use crate::bsdf::{Bsdf, Dielectric, Lambert, Lobe, Mirror, PhongLobe};
use crate::classic::ClassicMaterial;
use crate::media::Medium;
use crate::surface::Surface;
use crate::texture::ColourMap;
use bilux_math::Rgb;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use std::sync::Arc;

pub(super) const ENTRY: MaterialEntry = MaterialEntry {
    entry: Entry {
        name: "phong",
        summary: "the paper's material: ambient, diffuse, specular and refracted light, each with its coefficient",
        source: "Phong 1975",
        parameters: &[
            reflectance("ka", "ambient reflection; kd if it is not given", "0"),
            reflectance("kd", "diffuse reflection", "0.7"),
            reflectance("ks", "specular reflection: the weight of S in Equation 2", "0.3"),
            reflectance("kt", "refraction: the weight of T in Equation 2", "0"),
            Parameter {
                name: "exponent",
                summary: "exponent of the specular highlight",
                unit: "",
                kind: ParameterKind::Number { min: 0.0, max: 1e5 },
                default: "32",
            },
            Parameter {
                name: "reflectivity",
                summary: "share of S that comes from the reflected direction; 1 in the paper",
                unit: "",
                kind: ParameterKind::Number { min: 0.0, max: 1.0 },
                default: "1",
            },
            ETA,
            ABSORPTION,
            THIN,
            spread("gloss", "maximum angle by which reflected rays spread, in cook only"),
            spread("translucency", "maximum angle by which refracted rays spread, in cook only"),
            EMISSION,
            EMISSION_SCALE,
            EMISSION_SIDES,
            OPACITY,
            NORMAL,
            NORMAL_SCALE,
        ],
    },
    build: |reader, inputs| {
        let ambient = if reader.is_given("ka") { "ka" } else { "kd" };
        Ok(Arc::new(Phong {
            ka: colour_map(reader, ambient, inputs)?,
            ambient_follows_kd: !reader.is_given("ka"),
            kd: colour_map(reader, "kd", inputs)?,
            ks: colour_map(reader, "ks", inputs)?,
            kt: colour_map(reader, "kt", inputs)?,
            constants: ClassicMaterial {
                exponent: reader.number("exponent"),
                reflectivity: reader.number("reflectivity"),
                eta: reader.number("eta"),
                sigma_a: reader.colour("absorption"),
                thin: reader.bool("thin"),
                gloss: reader.number("gloss").to_radians(),
                translucency: reader.number("translucency").to_radians(),
                ..ClassicMaterial::default()
            },
        }))
    },
    principled: Some(AsPrincipled {
        keeps: &["kd", "ks", "exponent"],
        differs: "reflects slightly differently",
        convert: |material, principled| {
            let exponent = material.number("exponent").unwrap_or(10.0).max(0.0);
            principled
                .with("base_color", material.value_or("kd", 0.7))
                .with("specular_color", material.value_or("ks", 0.2))
                .with("specular_roughness", (2.0 / (exponent + 2.0)).sqrt().sqrt())
        },
    }),
};

struct Phong {
    ka: ColourMap,
    ambient_follows_kd: bool,
    kd: ColourMap,
    ks: ColourMap,
    kt: ColourMap,
    constants: ClassicMaterial,
}

impl Material for Phong {
    fn bsdf(&self, surface: &Surface) -> Bsdf {
        let c = self.classic(surface);
        let lobes = if c.kt.is_black() {
            let total = (c.kd + c.ks).max_channel().max(1.0);
            let (kd, ks) = (c.kd / total, c.ks / total);
            let mirror = ks * c.reflectivity;
            let highlight = ks * (1.0 - c.reflectivity);
            [
                (!kd.is_black()).then_some(Lobe::Lambert(Lambert { albedo: kd })),
                (!mirror.is_black()).then_some(Lobe::Mirror(Mirror { reflectance: mirror })),
                (!highlight.is_black())
                    .then_some(Lobe::Phong(PhongLobe { reflectance: highlight, exponent: c.exponent })),
            ]
        } else {
            let glass = Dielectric {
                eta: c.eta,
                dispersion: 0.0,
                tint: c.kt.clamp(0.0, 1.0),
                thin: c.thin,
                film: None,
            };
            [Some(Lobe::Dielectric(glass)), None, None]
        };
        Bsdf::new(surface.n_shade, surface.n_geom, lobes)
    }

    fn classic(&self, surface: &Surface) -> ClassicMaterial {
        let vertex_kd = surface.vertex_kd.unwrap_or(Rgb::WHITE);
        let kd = self.kd.at(surface.uvs()) * vertex_kd;
        let kt = self.kt.at(surface.uvs());
        ClassicMaterial {
            ka: if self.ambient_follows_kd { kd } else { self.ka.at(surface.uvs()) },
            kd,
            ks: self.ks.at(surface.uvs()) * surface.vertex_ks.unwrap_or(Rgb::WHITE),
            kt,
            fresnel: !kt.is_black(),
            ..self.constants
        }
    }

    fn max_lobes(&self) -> usize {
        3
    }

    fn medium(&self) -> Option<Medium<'_>> {
        let is_clear = self.kt.texture.is_some() || !self.kt.colour.is_black();
        (is_clear && !self.constants.thin).then_some(Medium::absorbing(self.constants.sigma_a))
    }
}
