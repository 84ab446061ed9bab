//! `principled`: one surface for nearly everything, in the terms of OpenPBR 1.1: plastic, metal, glass, or a mixture,
//! below a clear coat, below fuzz.
//!
//! The base scatters diffusely, or is metal; at the surface, microfacets reflect by Fresnel's equations. The diffuse
//! part loses exactly what they reflect, so that a white surface loses no light. [OpenPBR 1.1; Kulla 2017]

mod inside;
mod maps;
mod point;

use super::dielectric::PRIORITY;
use super::opacity::ABSENT;
use super::{
    COAT_NORMAL, COAT_NORMAL_SCALE, EMISSION, EMISSION_SCALE, EMISSION_SIDES, Material, MaterialEntry,
    NORMAL, NORMAL_SCALE, Nested, OPACITY, THIN, VISIBLE_SIDES, reflectance,
};
use crate::bsdf::{Bsdf, Lobe, OpaqueBase, OpaqueBaseInputs, is_rough};
use crate::classic::ClassicMaterial;
use crate::media::Medium;
use crate::messages::error::SceneError;
use crate::surface::Surface;
use crate::texture::NumberMap;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::transcendental::atan;
use bilux_math::{Frame, Rgb, Vec2, Vec3};
use inside::Inside;
use maps::{Maps, is_there};
use point::Point;
use std::sync::Arc;

pub(super) const ENTRY: MaterialEntry = MaterialEntry {
    entry: Entry {
        name: "principled",
        summary: "plastic, metal, paint, glass: one material for nearly everything",
        source: "OpenPBR 1.1",
        parameters: &[
            reflectance("base_color", "colour of the diffuse part, and of metal at normal incidence", "0.8"),
            number(
                "base_diffuse_roughness",
                "roughness of the diffuse part: 0 is Lambertian, 1 is like clay or the moon",
                1.0,
                "0",
            ),
            number("base_metalness", "fraction of the surface that is metal", 1.0, "0"),
            number("specular_weight", "factor on specular reflection at normal incidence", 1.0, "1"),
            reflectance(
                "specular_color",
                "colour of specular reflection; of metal, near grazing angles",
                "1",
            ),
            number("specular_roughness", ROUGHNESS, 1.0, "0.3"),
            index("specular_ior", "refractive index of the non-metallic part", "1.5"),
            number(
                "specular_roughness_anisotropy",
                "anisotropy: how much smoother the surface is along its tangent than across it",
                1.0,
                "0",
            ),
            Parameter {
                name: "anisotropy_rotation",
                summary: "rotation of the anisotropy's direction, which is along u",
                unit: "turns",
                kind: ParameterKind::NumberTexture { min: -1.0, max: 1.0 },
                default: "0",
            },
            number("transmission_weight", "fraction of the non-metallic part that transmits light", 1.0, "0"),
            reflectance(
                "transmission_color",
                "colour of transmitted light: at each surface, or after transmission_depth inside",
                "1",
            ),
            Parameter {
                name: "transmission_depth",
                summary: "distance inside after which light has transmission_color; 0 tints it at the surface",
                unit: "m",
                kind: ParameterKind::Number { min: 0.0, max: 1e6 },
                default: "0",
            },
            Parameter {
                name: "transmission_scatter",
                summary: "scattering inside, per transmission_depth: milky glass, juice, murky water; ignored without a depth",
                unit: "",
                kind: ParameterKind::Colour { min: 0.0, max: 1e3 },
                default: "0",
            },
            anisotropy(
                "transmission_scatter_anisotropy",
                "mean cosine of scattering inside: 0 is even, 0.9 nearly straight on, negative back",
            ),
            Parameter {
                name: "transmission_dispersion_scale",
                summary: "scale of the dispersion that transmission_dispersion_abbe_number gives",
                unit: "",
                kind: ParameterKind::Number { min: 0.0, max: 1.0 },
                default: "0",
            },
            Parameter {
                name: "transmission_dispersion_abbe_number",
                summary: "Abbe number; lower values disperse more: 64 for window glass, 36 for flint glass",
                unit: "",
                kind: ParameterKind::Number { min: 1.0, max: 1e4 },
                default: "20",
            },
            number(
                "subsurface_weight",
                "fraction of the opaque part that lets light in and scatters it below the surface: skin, wax, milk, marble",
                1.0,
                "0",
            ),
            reflectance(
                "subsurface_color",
                "colour that a thick body of it has, seen straight on, between its highlights",
                "0.8",
            ),
            Parameter {
                name: "subsurface_radius",
                summary: "how far light travels inside, on average, before it is scattered; 0 is a diffuse surface",
                unit: "m",
                kind: ParameterKind::Number { min: 0.0, max: 1e6 },
                default: "1",
            },
            Parameter {
                name: "subsurface_radius_scale",
                summary: "factor on subsurface_radius for red, green and blue",
                unit: "",
                kind: ParameterKind::Colour { min: 0.0, max: 1.0 },
                default: "1 0.5 0.25",
            },
            anisotropy(
                "subsurface_scatter_anisotropy",
                "mean cosine of scattering below the surface; of thin walls, from -1, all reflected, to 1, all transmitted",
            ),
            Parameter { name: "thin_walled", ..THIN },
            PRIORITY,
            number("coat_weight", "weight of the clear coat", 1.0, "0"),
            reflectance("coat_color", "colour of light that passes the coat and returns", "1"),
            number("coat_roughness", ROUGHNESS, 1.0, "0"),
            index("coat_ior", "refractive index of the coat", "1.6"),
            COAT_NORMAL,
            COAT_NORMAL_SCALE,
            number("fuzz_weight", "weight of the fuzz: fine fibres, as on velvet", 1.0, "0"),
            reflectance("fuzz_color", "colour of the fibres", "1"),
            number(
                "fuzz_roughness",
                "roughness of the fuzz; low for upright fibres that show only at grazing angles",
                1.0,
                "0.5",
            ),
            number(
                "diffuse_transmission_weight",
                "fraction of the diffuse part that is transmitted to the back, as in a leaf",
                1.0,
                "0",
            ),
            reflectance("diffuse_transmission_color", "colour of diffuse transmission", "1"),
            number("thin_film_weight", "weight of the thin film", 1.0, "0"),
            Parameter {
                name: "thin_film_thickness",
                summary: "thickness of the thin film",
                unit: "µm",
                kind: ParameterKind::NumberTexture { min: 0.0, max: 10.0 },
                default: "0.5",
            },
            index("thin_film_ior", "refractive index of the thin film", "1.4"),
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
        let maps = Maps::read(reader, inputs)?;
        let inside = Inside::read(reader, &maps)?;
        let is_opaque_base = maps.are_of_opaque_base();
        let even = maps.are_constant().then(|| {
            let inputs = maps.opaque_base_at(Vec2::ZERO, Rgb::WHITE);
            match is_opaque_base {
                true => opaque_base([Vec3::Z; 2], &inputs),
                false => Bsdf::new(Vec3::Z, Vec3::Z, inside.point(&maps, Vec2::ZERO).lobes()),
            }
        });
        let is_solid = inside.medium.is_some();
        if is_solid && reader.text("visible_sides") == "front" {
            let message = "a transmissive material is visible from both sides: remove visible_sides";
            return Err(SceneError::invalid(message, reader.span("visible_sides")));
        }
        Ok(Arc::new(Principled {
            maps,
            even,
            is_opaque_base,
            inside,
            priority: reader.integer("priority") as u32,
        }))
    },
    principled: None,
};

/// The opaque base about a shading normal; the other is geometric.
fn opaque_base([n_shade, n_geom]: [Vec3; 2], inputs: &OpaqueBaseInputs) -> Bsdf {
    Bsdf::of(n_shade, n_geom, Lobe::OpaqueBase(OpaqueBase::new(inputs)))
}

const fn anisotropy(name: &'static str, summary: &'static str) -> Parameter {
    Parameter { name, summary, unit: "", kind: ParameterKind::Number { min: -1.0, max: 1.0 }, default: "0" }
}

const fn index(name: &'static str, summary: &'static str, default: &'static str) -> Parameter {
    let kind = ParameterKind::NumberTexture { min: 1.0, max: 10.0 };
    Parameter { name, summary, unit: "", kind, default }
}

const ROUGHNESS: &str = "microfacet roughness: 0 is perfectly smooth; the square root of GGX's alpha";

const fn number(name: &'static str, summary: &'static str, max: f64, default: &'static str) -> Parameter {
    Parameter { name, summary, unit: "", kind: ParameterKind::NumberTexture { min: 0.0, max }, default }
}

struct Principled {
    maps: Maps,
    /// The precomputed BSDF, if no texture varies over the surface.
    even: Option<Bsdf>,
    /// Nothing is above the opaque base.
    is_opaque_base: bool,
    inside: Inside,
    priority: u32,
}

impl Principled {
    fn point(&self, surface: &Surface) -> Point {
        let vertex = surface.vertex_kd.unwrap_or(Rgb::WHITE);
        let point = self.inside.point(&self.maps, surface.uvs());
        // The rotation is from u towards v, whichever side of u that is on.
        let rotation = point.rotation * surface.handedness;
        Point { base_color: (point.base_color * vertex).clamp(0.0, 1.0), rotation, ..point }
    }

    /// [`Material::bsdf`] where the coat has its own normal.
    #[inline(never)]
    fn below_coat(&self, surface: &Surface, n: Vec3) -> Bsdf {
        let frame = Frame::from_normal(surface.n_shade).along(surface.tangent);
        let lobes = Point { coat_up: frame.to_local(n), ..self.point(surface) }.lobes();
        let [fuzz, coat, ..] = &lobes;
        let mut bsdf = Bsdf::of_lobes(surface.n_shade, surface.n_geom, &lobes);
        bsdf.turn_along(surface.tangent);
        if coat.is_some() {
            bsdf.set_lobe_frame(usize::from(fuzz.is_some()), n);
        }
        bsdf
    }

    fn body(&self) -> Nested {
        let (eta, dispersion) = (self.inside.ior, self.maps.dispersion);
        Nested { priority: self.priority.max(1), eta, dispersion }
    }

    fn is_air(&self) -> bool {
        self.only_refracts() && Nested::AIR.bends_like(&self.body())
    }

    /// The coat's normal at a point.
    #[inline]
    fn coat_normal(&self, surface: &Surface) -> Vec3 {
        match &self.maps.coat_normals {
            Some(normals) if surface.tangent != Vec3::ZERO => normals.at(surface),
            _ => surface.n_smooth,
        }
    }
}

impl Material for Principled {
    fn is_lambertian(&self) -> bool {
        self.maps.are_lambertian()
    }

    fn lambertian_reflectance(&self, surface: &Surface) -> Rgb {
        let vertex = surface.vertex_kd.unwrap_or(Rgb::WHITE);
        (self.maps.base_color.at(surface.uvs()).clamp(0.0, 1.0) * vertex).clamp(0.0, 1.0)
    }

    fn constant_lambertian_reflectance(&self) -> Option<Rgb> {
        let is_constant = self.is_lambertian() && self.maps.base_color.texture.is_none();
        is_constant.then(|| self.maps.base_color.colour.clamp(0.0, 1.0))
    }

    fn is_opaque_base(&self) -> bool {
        self.is_opaque_base
    }

    fn opaque_base(&self, surface: &Surface) -> Option<OpaqueBaseInputs> {
        let vertex = surface.vertex_kd.unwrap_or(Rgb::WHITE);
        let inputs = self.maps.opaque_base_at(surface.uvs(), vertex);
        (self.is_opaque_base && is_rough(inputs.roughness)).then_some(inputs)
    }

    fn opaque_bases(&self, surfaces: &[Surface], inputs: &mut Vec<Option<OpaqueBaseInputs>>) {
        self.maps.opaque_bases_at(surfaces, |base| {
            inputs.push((self.is_opaque_base && is_rough(base.roughness)).then_some(base));
        });
    }

    fn bsdf(&self, surface: &Surface) -> Bsdf {
        if is_there(&self.maps.coat_weight) {
            let n = self.coat_normal(surface);
            if n != surface.n_shade {
                return self.below_coat(surface, n);
            }
        }
        let mut bsdf = match &self.even {
            Some(even) if surface.vertex_kd.is_none() && surface.handedness > 0.0 => {
                even.moved_to(surface.n_shade, surface.n_geom)
            }
            _ if self.is_opaque_base => match self.opaque_base(surface) {
                Some(inputs) => opaque_base([surface.n_shade, surface.n_geom], &inputs),
                None => Bsdf::of_lobes(surface.n_shade, surface.n_geom, &self.point(surface).lobes()),
            },
            _ => Bsdf::of_lobes(surface.n_shade, surface.n_geom, &self.point(surface).lobes()),
        };
        if self.needs_tangents() {
            bsdf.turn_along(surface.tangent);
        }
        bsdf
    }

    fn classic(&self, surface: &Surface) -> ClassicMaterial {
        let point = self.point(surface);
        let alpha = point.roughness * point.roughness;
        let opaque = point.base_color * point.opaque() + point.body_color() * point.body();
        let (kd, kt) = (opaque, point.passed * point.clear());
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
            sigma_a: if kt.is_black() { Rgb::BLACK } else { self.inside.absorbed },
            thin: point.thin,
            gloss: atan(alpha),
            translucency: atan(alpha),
            fresnel: !kt.is_black(),
        }
    }

    fn opacity(&self) -> Option<&NumberMap> {
        (self.maps.thin && self.is_air()).then_some(&ABSENT)
    }

    fn needs_tangents(&self) -> bool {
        is_there(&self.maps.anisotropy) || self.maps.coat_normals.is_some()
    }

    fn max_lobes(&self) -> usize {
        2 + usize::from(is_there(&self.maps.transmission_weight) || self.inside.is_body)
            + usize::from(is_there(&self.maps.coat_weight))
            + usize::from(is_there(&self.maps.fuzz_weight))
    }

    fn disperses(&self) -> bool {
        self.maps.dispersion > 0.0
    }

    fn nested(&self) -> Option<Nested> {
        self.in_contact().filter(|_| self.priority > 0 || self.is_air())
    }

    fn in_contact(&self) -> Option<Nested> {
        self.inside.medium.map(|_| self.body())
    }

    fn is_pane(&self) -> bool {
        self.maps.thin && is_there(&self.maps.transmission_weight) && !self.disperses()
    }

    fn only_refracts(&self) -> bool {
        self.maps.only_refract()
    }

    fn medium(&self) -> Option<Medium<'_>> {
        self.inside.medium
    }
}
