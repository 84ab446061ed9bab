//! `principled`: one surface for nearly everything, in the terms of OpenPBR 1.1: glossy plastic, metal, or a mixture.
//!
//! Below is what scatters diffusely, or metal; at the surface, facets reflect by Fresnel's equations. What they reflect
//! the diffuse part lacks, and no more: a white surface loses nothing. [OpenPBR 1.1; Kulla 2017]

use super::{
    EMISSION, EMISSION_SCALE, EMISSION_SIDES, Ingredients, Material, MaterialEntry, NORMAL, NORMAL_SCALE,
    colour_map, number_map, reflectance,
};
use crate::bsdf::{Albedo, Bsdf, Cover, Fresnel, Ggx, Gloss, Lambert, Lobe, Matt};
use crate::classic::ClassicMaterial;
use crate::error::SceneError;
use crate::parameters::Reader;
use crate::surface::Surface;
use crate::texture::{ColourMap, NumberMap};
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::transcendental::atan;
use bilux_math::{Rgb, Vec2};
use std::f32::consts::TAU;
use std::sync::Arc;

pub(super) const ENTRY: MaterialEntry = MaterialEntry {
    entry: Entry {
        name: "principled",
        summary: "plastic, metal, paint: one surface for nearly everything",
        source: "OpenPBR 1.1",
        parameters: &[
            reflectance("base_color", "what diffuse parts reflect, and metal straight on", "0.8"),
            number("base_metalness", "how much of the surface is metal", 1.0, "0"),
            number("specular_weight", "factor on what is reflected straight on at the surface", 1.0, "1"),
            reflectance(
                "specular_color",
                "factor on what is reflected at the surface; of metal, near grazing",
                "1",
            ),
            number("specular_roughness", ROUGHNESS, 1.0, "0.3"),
            Parameter {
                name: "specular_ior",
                summary: "refractive index of what is not metal",
                unit: "",
                kind: ParameterKind::NumberTexture { min: 1.0, max: 10.0 },
                default: "1.5",
            },
            number(
                "specular_roughness_anisotropy",
                "how much smoother it is along its brushing than across",
                1.0,
                "0",
            ),
            Parameter {
                name: "anisotropy_rotation",
                summary: "turns the brushing, which goes along u",
                unit: "turns",
                kind: ParameterKind::NumberTexture { min: -1.0, max: 1.0 },
                default: "0",
            },
            EMISSION,
            EMISSION_SCALE,
            EMISSION_SIDES,
            NORMAL,
            NORMAL_SCALE,
        ],
    },
    build: |reader, ingredients| {
        let maps = Maps::read(reader, ingredients)?;
        let even = maps.are_even().then(|| maps.at(Vec2::ZERO).lobes());
        Ok(Arc::new(Principled { maps, even }))
    },
};

const ROUGHNESS: &str = "0 is polished, 1 as rough as can be; the square root of GGX's alpha";

const fn number(name: &'static str, summary: &'static str, max: f64, default: &'static str) -> Parameter {
    Parameter { name, summary, unit: "", kind: ParameterKind::NumberTexture { min: 0.0, max }, default }
}

/// The parameters, each a constant or a texture.
struct Maps {
    base_color: ColourMap,
    base_metalness: NumberMap,
    specular_weight: NumberMap,
    specular_color: ColourMap,
    specular_roughness: NumberMap,
    specular_ior: NumberMap,
    anisotropy: NumberMap,
    rotation: NumberMap,
}

impl Maps {
    fn read(reader: &Reader, ingredients: &Ingredients) -> Result<Maps, SceneError> {
        let colour = |key| colour_map(reader, key, ingredients);
        let number = |key| number_map(reader, key, ingredients);
        Ok(Maps {
            base_color: colour("base_color")?,
            base_metalness: number("base_metalness")?,
            specular_weight: number("specular_weight")?,
            specular_color: colour("specular_color")?,
            specular_roughness: number("specular_roughness")?,
            specular_ior: number("specular_ior")?,
            anisotropy: number("specular_roughness_anisotropy")?,
            rotation: number("anisotropy_rotation")?,
        })
    }

    /// True where no texture changes anything over the surface.
    fn are_even(&self) -> bool {
        let colours = [&self.base_color, &self.specular_color];
        let numbers = [
            &self.base_metalness,
            &self.specular_weight,
            &self.specular_roughness,
            &self.specular_ior,
            &self.anisotropy,
            &self.rotation,
        ];
        colours.iter().all(|map| map.texture.is_none()) && numbers.iter().all(|map| map.texture.is_none())
    }

    fn at(&self, uv: Vec2) -> Point {
        Point {
            base_color: self.base_color.at(uv).clamp(0.0, 1.0),
            metalness: self.base_metalness.at(uv),
            specular_weight: self.specular_weight.at(uv),
            specular_color: self.specular_color.at(uv).clamp(0.0, 1.0),
            roughness: self.specular_roughness.at(uv),
            ior: self.specular_ior.at(uv),
            anisotropy: self.anisotropy.at(uv),
            rotation: self.rotation.at(uv),
        }
    }
}

/// The parameters at a point.
struct Point {
    base_color: Rgb,
    metalness: f32,
    specular_weight: f32,
    specular_color: Rgb,
    roughness: f32,
    ior: f32,
    anisotropy: f32,
    rotation: f32,
}

/// A way of scattering, and what its light is multiplied by.
type Lobes = [Option<Lobe>; 2];

impl Point {
    fn lobes(&self) -> Lobes {
        let cover = Cover::NONE;
        let opaque = 1.0 - self.metalness;
        let ggx = Ggx::from_roughness(self.roughness, self.anisotropy, self.rotation * TAU);
        let eta = weakened(self.ior, self.specular_weight);
        let glass = if eta > 1.0 { self.specular_color * opaque } else { Rgb::BLACK };
        let metal = Fresnel::tinted(self.base_color * self.specular_weight, self.specular_color);
        let gloss = (self.metalness > 0.0 || !glass.is_black())
            .then(|| Lobe::Gloss(Gloss::new(ggx, eta, glass, metal, self.metalness, cover)));
        let albedo = self.base_color * opaque;
        let is_bare = eta <= 1.0 && cover.is_none();
        let base = (!albedo.is_black()).then(|| {
            if is_bare {
                Lobe::Lambert(Lambert { albedo })
            } else {
                Lobe::Matt(Matt::new(albedo, Albedo::new(&ggx, eta), cover))
            }
        });
        [gloss, base]
    }
}

/// The index of a boundary that reflects `weight` times what this one does, straight on. [OpenPBR 1.1, eq. 27]
fn weakened(eta: f32, weight: f32) -> f32 {
    let amplitude = weight.sqrt() * (eta - 1.0) / (eta + 1.0);
    (1.0 + amplitude) / (1.0 - amplitude)
}

struct Principled {
    maps: Maps,
    /// What it comes to where it is the same everywhere.
    even: Option<Lobes>,
}

impl Principled {
    fn point(&self, surface: &Surface) -> Point {
        let vertex = surface.vertex_kd.unwrap_or(Rgb::WHITE);
        let point = self.maps.at(surface.uv);
        Point { base_color: (point.base_color * vertex).clamp(0.0, 1.0), ..point }
    }
}

impl Material for Principled {
    fn bsdf(&self, surface: &Surface) -> Bsdf {
        let lobes = match self.even {
            Some(lobes) if surface.vertex_kd.is_none() => lobes,
            _ => self.point(surface).lobes(),
        };
        Bsdf::new(surface.n_shade, surface.n_geom, lobes).along(surface.tangent)
    }

    fn classic(&self, surface: &Surface) -> ClassicMaterial {
        let point = self.point(surface);
        let alpha = point.roughness * point.roughness;
        let kd = point.base_color * (1.0 - point.metalness);
        let amplitude = (point.ior - 1.0) / (point.ior + 1.0);
        let glass = point.specular_color * (amplitude * amplitude * (1.0 - point.metalness));
        ClassicMaterial {
            ka: kd,
            kd,
            ks: (point.base_color * point.metalness + glass) * point.specular_weight,
            exponent: (2.0 / (alpha * alpha) - 2.0).min(500.0),
            reflectivity: 1.0,
            gloss: atan(alpha),
            ..ClassicMaterial::default()
        }
    }

    fn needs_tangents(&self) -> bool {
        self.maps.anisotropy.texture.is_some() || self.maps.anisotropy.number > 0.0
    }

    fn most_lobes(&self) -> usize {
        2
    }
}
