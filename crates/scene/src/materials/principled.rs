//! `principled`: one surface for nearly everything, in the terms of OpenPBR 1.1: plastic, metal, glass, or
//! a mixture, below a clear coat, below fuzz.
//!
//! Below is what scatters diffusely, or metal; at the surface, facets reflect by Fresnel's equations. What they reflect
//! the diffuse part lacks, and no more: a white surface loses nothing. [OpenPBR 1.1; Kulla 2017]

use super::dielectric::PRIORITY;
use super::{
    EMISSION, EMISSION_SCALE, EMISSION_SIDES, Ingredients, Material, MaterialEntry, NORMAL, NORMAL_SCALE,
    Nested, OPACITY, THIN, colour_map, number_map, reflectance,
};
use crate::bsdf::{
    Albedo, Bsdf, Clear, Cover, Film, Fresnel, Fuzz, FuzzAlbedo, Ggx, Gloss, Lambert, Lobe, Matt,
};
use crate::classic::ClassicMaterial;
use crate::error::SceneError;
use crate::parameters::Reader;
use crate::surface::Surface;
use crate::texture::{ColourMap, NumberMap};
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::transcendental::{atan, ln};
use bilux_math::{Rgb, Vec2};
use std::f32::consts::TAU;
use std::sync::Arc;

pub(super) const ENTRY: MaterialEntry = MaterialEntry {
    entry: Entry {
        name: "principled",
        summary: "plastic, metal, paint, glass: one surface for nearly everything",
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
            index("specular_ior", "refractive index of what is not metal", "1.5"),
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
            number("transmission_weight", "how much of what is not metal is clear", 1.0, "0"),
            reflectance(
                "transmission_color",
                "what is left of light that passes: at each surface, or after transmission_depth inside",
                "1",
            ),
            Parameter {
                name: "transmission_depth",
                summary: "how far light goes inside until it has transmission_color; 0 tints at the surface",
                unit: "m",
                kind: ParameterKind::Number { min: 0.0, max: 1e6 },
                default: "0",
            },
            Parameter { name: "thin_walled", ..THIN },
            PRIORITY,
            number("coat_weight", "how much of the surface has a clear coat", 1.0, "0"),
            reflectance("coat_color", "what is left of light that passes the coat and comes back", "1"),
            number("coat_roughness", ROUGHNESS, 1.0, "0"),
            index("coat_ior", "refractive index of the coat", "1.6"),
            number("fuzz_weight", "how much of the surface has fine fibres on top, as velvet has", 1.0, "0"),
            reflectance("fuzz_color", "colour of the fibres", "1"),
            number(
                "fuzz_roughness",
                "low for fibres that stand upright and are seen only along the surface",
                1.0,
                "0.5",
            ),
            number(
                "diffuse_transmission_weight",
                "how much of the diffuse part comes out behind, as in a leaf",
                1.0,
                "0",
            ),
            reflectance(
                "diffuse_transmission_color",
                "what comes out behind of light that scatters there",
                "1",
            ),
            number(
                "thin_film_weight",
                "how much of the surface has a film as thin as light's waves",
                1.0,
                "0",
            ),
            Parameter {
                name: "thin_film_thickness",
                summary: "thickness of that film",
                unit: "µm",
                kind: ParameterKind::NumberTexture { min: 0.0, max: 10.0 },
                default: "0.5",
            },
            index("thin_film_ior", "refractive index of that film", "1.4"),
            EMISSION,
            EMISSION_SCALE,
            EMISSION_SIDES,
            OPACITY,
            NORMAL,
            NORMAL_SCALE,
        ],
    },
    build: |reader, ingredients| {
        let maps = Maps::read(reader, ingredients)?;
        let even = maps.are_even().then(|| maps.at(Vec2::ZERO).lobes());
        let depth = reader.number("transmission_depth");
        let is_deep = !maps.tints_surface;
        if is_deep && maps.transmission_color.texture.is_some() {
            let message =
                "with a transmission_depth transmission_color is of the inside, which has no texture";
            return Err(SceneError::invalid(message, reader.span("transmission_color")));
        }
        let sigma_a = if is_deep && is_there(&maps.transmission_weight) {
            maps.transmission_color.colour.map(|c| -ln(c.clamp(DARKEST, 1.0)) / depth)
        } else {
            Rgb::BLACK
        };
        Ok(Arc::new(Principled { maps, even, sigma_a, priority: reader.integer("priority") as u32 }))
    },
};

/// What is clear lets this much through at least, or no number would tell how much it absorbs.
const DARKEST: f32 = 1e-6;

const fn index(name: &'static str, summary: &'static str, default: &'static str) -> Parameter {
    let kind = ParameterKind::NumberTexture { min: 1.0, max: 10.0 };
    Parameter { name, summary, unit: "", kind, default }
}

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
    transmission_weight: NumberMap,
    transmission_color: ColourMap,
    /// True where transmission_color is of the surface, and not of what is inside.
    tints_surface: bool,
    thin: bool,
    coat_weight: NumberMap,
    coat_color: ColourMap,
    coat_roughness: NumberMap,
    coat_ior: NumberMap,
    fuzz_weight: NumberMap,
    fuzz_color: ColourMap,
    fuzz_roughness: NumberMap,
    passing: NumberMap,
    passing_color: ColourMap,
    film_weight: NumberMap,
    film_thickness: NumberMap,
    film_ior: NumberMap,
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
            transmission_weight: number("transmission_weight")?,
            transmission_color: colour("transmission_color")?,
            tints_surface: reader.number("transmission_depth") == 0.0 || reader.bool("thin_walled"),
            thin: reader.bool("thin_walled"),
            coat_weight: number("coat_weight")?,
            coat_color: colour("coat_color")?,
            coat_roughness: number("coat_roughness")?,
            coat_ior: number("coat_ior")?,
            fuzz_weight: number("fuzz_weight")?,
            fuzz_color: colour("fuzz_color")?,
            fuzz_roughness: number("fuzz_roughness")?,
            passing: number("diffuse_transmission_weight")?,
            passing_color: colour("diffuse_transmission_color")?,
            film_weight: number("thin_film_weight")?,
            film_thickness: number("thin_film_thickness")?,
            film_ior: number("thin_film_ior")?,
        })
    }

    /// True where no texture changes anything over the surface.
    fn are_even(&self) -> bool {
        let colours = [
            &self.base_color,
            &self.specular_color,
            &self.transmission_color,
            &self.coat_color,
            &self.fuzz_color,
            &self.passing_color,
        ];
        let numbers = [
            &self.base_metalness,
            &self.specular_weight,
            &self.specular_roughness,
            &self.specular_ior,
            &self.anisotropy,
            &self.rotation,
            &self.transmission_weight,
            &self.coat_weight,
            &self.coat_roughness,
            &self.coat_ior,
            &self.fuzz_weight,
            &self.fuzz_roughness,
            &self.passing,
            &self.film_weight,
            &self.film_thickness,
            &self.film_ior,
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
            transmission: self.transmission_weight.at(uv),
            passed: if self.tints_surface {
                self.transmission_color.at(uv).clamp(0.0, 1.0)
            } else {
                Rgb::WHITE
            },
            thin: self.thin,
            coat: self.coat_weight.at(uv),
            coat_color: self.coat_color.at(uv).clamp(0.0, 1.0),
            coat_roughness: self.coat_roughness.at(uv),
            coat_ior: self.coat_ior.at(uv),
            fuzz: self.fuzz_weight.at(uv),
            fuzz_color: self.fuzz_color.at(uv).clamp(0.0, 1.0),
            fuzz_roughness: self.fuzz_roughness.at(uv),
            passing: self.passing.at(uv),
            passing_color: self.passing_color.at(uv).clamp(0.0, 1.0),
            film: Film {
                weight: self.film_weight.at(uv),
                thickness: self.film_thickness.at(uv) * 1e3,
                eta: self.film_ior.at(uv),
            },
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
    transmission: f32,
    passed: Rgb,
    thin: bool,
    coat: f32,
    coat_color: Rgb,
    coat_roughness: f32,
    coat_ior: f32,
    fuzz: f32,
    fuzz_color: Rgb,
    fuzz_roughness: f32,
    /// How much of the diffuse part comes out behind.
    passing: f32,
    passing_color: Rgb,
    film: Film,
}

/// Fuzz, coat, boundary, base, clear part.
type Lobes = [Option<Lobe>; 5];

impl Point {
    fn lobes(&self) -> Lobes {
        let ggx = Ggx::from_roughness(self.roughness, self.anisotropy, self.rotation * TAU);
        let (fuzz, bloom) = self.fuzz_and_cover();
        let (coat, cover) = self.coat_and_cover(bloom);
        let tint = Rgb::WHITE.lerp(self.coat_color, self.coat);
        let (opaque, clear) = (tint * self.opaque(), tint * self.clear());
        let eta = self.eta();
        let glass = if eta > 1.0 { self.specular_color * opaque } else { Rgb::BLACK };
        let metal = Fresnel::tinted(self.base_color * self.specular_weight, self.specular_color);
        let metal_weight = tint * self.metalness;
        let gloss = (!metal_weight.is_black() || !glass.is_black()).then(|| {
            let gloss = Gloss::new(ggx, eta, glass, metal, metal_weight, cover);
            Lobe::Gloss(if self.film.weight > 0.0 { gloss.below(self.film) } else { gloss })
        });
        let (albedo, passing) =
            (self.base_color * opaque * (1.0 - self.passing), self.passing_color * opaque * self.passing);
        let is_bare = eta <= 1.0 && cover.is_none() && passing.is_black();
        let base = (!albedo.is_black() || !passing.is_black()).then(|| {
            if is_bare {
                return Lobe::Lambert(Lambert { albedo });
            }
            // What a film reflects at its brightest colour does not get in at any.
            let most = if self.film.weight > 0.0 { self.film.most(eta) } else { eta };
            Lobe::Matt(Matt::sheet(albedo, passing, Albedo::new(&ggx, most), cover))
        });
        let clear = (!clear.is_black()).then(|| {
            let (reflected, passed) = (self.specular_color * clear, self.passed * clear);
            Lobe::Clear(Clear::new(self.ior, ggx, self.thin, reflected, passed, cover))
        });
        [fuzz, coat, gloss, base, clear]
    }

    /// How much of the surface is neither metal nor clear.
    fn opaque(&self) -> f32 {
        (1.0 - self.metalness) * (1.0 - self.transmission)
    }

    fn clear(&self) -> f32 {
        (1.0 - self.metalness) * self.transmission
    }

    /// The index of the boundary of what is neither metal nor clear. Below a coat it is over that of the coat; where
    /// that is greater it is taken the other way round, or too much would be reflected totally. [OpenPBR 1.1]
    fn eta(&self) -> f32 {
        let ratio = self.ior / self.coat_ior;
        let eta = self.ior + (ratio.max(1.0 / ratio) - self.ior) * self.coat;
        weakened(eta, self.specular_weight)
    }

    /// Fibres, and what they cover.
    fn fuzz_and_cover(&self) -> (Option<Lobe>, Cover) {
        if self.fuzz == 0.0 {
            return (None, Cover::NONE);
        }
        let albedo = FuzzAlbedo::new(self.fuzz_roughness);
        let fuzz = Fuzz::new(self.fuzz_color * self.fuzz, albedo).from_below(self.outside());
        (Some(Lobe::Fuzz(fuzz)), Cover::NONE.below(self.fuzz, albedo))
    }

    /// A coat below what covers that, and all of it together.
    fn coat_and_cover(&self, above: Cover) -> (Option<Lobe>, Cover) {
        if self.coat == 0.0 || self.coat_ior <= 1.0 {
            return (None, above);
        }
        let ggx = Ggx::from_roughness(self.coat_roughness, 0.0, 0.0);
        let none = Fresnel::tinted(Rgb::BLACK, Rgb::WHITE);
        let coat = Gloss::new(ggx, self.coat_ior, Rgb::grey(self.coat), none, Rgb::BLACK, above);
        let cover = above.coated(self.coat, Albedo::new(&ggx, self.coat_ior));
        (Some(Lobe::Gloss(coat.from_below(self.outside()))), cover)
    }

    /// Who is inside of what is clear sees neither coat nor fuzz: how much of them is seen from below.
    fn outside(&self) -> f32 {
        if self.thin { 1.0 } else { 1.0 - self.clear() }
    }
}

/// True where a weight is above 0, or may be somewhere.
fn is_there(weight: &NumberMap) -> bool {
    weight.texture.is_some() || weight.number > 0.0
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
    sigma_a: Rgb,
    priority: u32,
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
        let (kd, kt) = (point.base_color * point.opaque(), point.passed * point.clear());
        let amplitude = (point.ior - 1.0) / (point.ior + 1.0);
        let glass = point.specular_color * (amplitude * amplitude * (1.0 - point.metalness));
        let ks = (point.base_color * point.metalness + glass) * point.specular_weight;
        ClassicMaterial {
            ka: kd,
            kd,
            ks: if kt.is_black() { ks } else { Rgb::WHITE },
            kt,
            exponent: (2.0 / (alpha * alpha) - 2.0).min(500.0),
            reflectivity: 1.0,
            eta: point.ior,
            sigma_a: self.sigma_a,
            thin: point.thin,
            gloss: atan(alpha),
            translucency: atan(alpha),
            fresnel: !kt.is_black(),
        }
    }

    fn needs_tangents(&self) -> bool {
        is_there(&self.maps.anisotropy)
    }

    fn most_lobes(&self) -> usize {
        2 + usize::from(is_there(&self.maps.transmission_weight))
            + usize::from(is_there(&self.maps.coat_weight))
            + usize::from(is_there(&self.maps.fuzz_weight))
    }

    fn nested(&self) -> Option<Nested> {
        let is_solid = !self.maps.thin && is_there(&self.maps.transmission_weight);
        (is_solid && self.priority > 0)
            .then_some(Nested { priority: self.priority, eta: self.maps.specular_ior.number })
    }

    fn sigma_a(&self) -> Rgb {
        self.sigma_a
    }
}
