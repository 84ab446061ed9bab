//! The parameters as they vary over a surface.

use super::super::normal_map::{self, NormalMap};
use super::super::{MaterialInputs, colour_map, number_map};
use super::point::{Point, Subsurface};
use crate::bsdf::{OpaqueBaseInputs, ThinFilm, is_rough};
use crate::messages::error::SceneError;
use crate::parameters::Reader;
use crate::surface::Surface;
use crate::texture::{AT_ONCE, ColourMap, LookUps, NumberMap, Patch, Seen};
use bilux_math::{Rgb, Vec3};

/// The parameters, each a constant or a texture.
pub(super) struct Maps {
    pub(super) base_color: ColourMap,
    pub(super) base_roughness: NumberMap,
    pub(super) base_metalness: NumberMap,
    pub(super) specular_weight: NumberMap,
    pub(super) specular_color: ColourMap,
    pub(super) specular_roughness: NumberMap,
    pub(super) specular_ior: NumberMap,
    pub(super) anisotropy: NumberMap,
    pub(super) rotation: NumberMap,
    pub(super) transmission_weight: NumberMap,
    pub(super) transmission_color: ColourMap,
    pub(super) subsurface_weight: NumberMap,
    pub(super) subsurface_color: ColourMap,
    /// Mean cosine; of a thin wall, it says how much is transmitted.
    pub(super) subsurface_anisotropy: f32,
    /// True if transmission_color tints the surface rather than the interior.
    pub(super) tints_surface: bool,
    pub(super) thin: bool,
    /// 1 over the Abbe number of the clear part; 0 if light does not enter it.
    pub(super) dispersion: f32,
    pub(super) coat_weight: NumberMap,
    pub(super) coat_color: ColourMap,
    pub(super) coat_roughness: NumberMap,
    pub(super) coat_ior: NumberMap,
    pub(super) coat_normals: Option<NormalMap>,
    pub(super) fuzz_weight: NumberMap,
    pub(super) fuzz_color: ColourMap,
    pub(super) fuzz_roughness: NumberMap,
    pub(super) passing: NumberMap,
    pub(super) passing_color: ColourMap,
    pub(super) film_weight: NumberMap,
    pub(super) film_thickness: NumberMap,
    pub(super) film_ior: NumberMap,
    /// The textures of an opaque base, in the order of [`Maps::base_of`].
    of_base: LookUps,
    /// The other textures, in the order of [`Maps::at`].
    of_rest: LookUps,
}

/// The maximum number of textures of an opaque base.
const BASE: usize = 6;
/// The maximum number of the others.
const REST: usize = 17;

impl Maps {
    pub(super) fn read(reader: &Reader, inputs: &MaterialInputs) -> Result<Maps, SceneError> {
        let colour = |key| colour_map(reader, key, inputs);
        let number = |key| number_map(reader, key, inputs);
        let transmission_weight = number("transmission_weight")?;
        let is_solid = is_there(&transmission_weight) && !reader.bool("thin_walled");
        let scale = if is_solid { reader.number("transmission_dispersion_scale") } else { 0.0 };
        let mut maps = Maps {
            base_color: colour("base_color")?,
            base_roughness: number("base_diffuse_roughness")?,
            base_metalness: number("base_metalness")?,
            specular_weight: number("specular_weight")?,
            specular_color: colour("specular_color")?,
            specular_roughness: number("specular_roughness")?,
            specular_ior: number("specular_ior")?,
            anisotropy: number("specular_roughness_anisotropy")?,
            rotation: number("anisotropy_rotation")?,
            transmission_weight,
            transmission_color: colour("transmission_color")?,
            subsurface_weight: number("subsurface_weight")?,
            subsurface_color: colour("subsurface_color")?,
            subsurface_anisotropy: reader.number("subsurface_scatter_anisotropy"),
            tints_surface: reader.number("transmission_depth") == 0.0 || reader.bool("thin_walled"),
            thin: reader.bool("thin_walled"),
            dispersion: scale / reader.number("transmission_dispersion_abbe_number"),
            coat_weight: number("coat_weight")?,
            coat_color: colour("coat_color")?,
            coat_roughness: number("coat_roughness")?,
            coat_ior: number("coat_ior")?,
            coat_normals: normal_map::read_of_coat(reader, inputs)?,
            fuzz_weight: number("fuzz_weight")?,
            fuzz_color: colour("fuzz_color")?,
            fuzz_roughness: number("fuzz_roughness")?,
            passing: number("diffuse_transmission_weight")?,
            passing_color: colour("diffuse_transmission_color")?,
            film_weight: number("thin_film_weight")?,
            film_thickness: number("thin_film_thickness")?,
            film_ior: number("thin_film_ior")?,
            of_base: LookUps::default(),
            of_rest: LookUps::default(),
        };
        (maps.of_base, maps.of_rest) = maps.look_ups();
        Ok(maps)
    }

    /// True for a clear surface that neither takes a share of light nor adds one, but for what its index reflects and bends.
    pub(super) fn only_refract(&self) -> bool {
        let is = |map: &NumberMap, number: f32| map.texture.is_none() && map.number == number;
        let is_white = |map: &ColourMap| map.texture.is_none() && map.colour == Rgb::WHITE;
        let others = [&self.base_metalness, &self.coat_weight, &self.fuzz_weight, &self.film_weight];
        is(&self.transmission_weight, 1.0)
            && self.specular_ior.texture.is_none()
            && others.iter().all(|weight| is(weight, 0.0))
            && (!self.tints_surface || is_white(&self.transmission_color))
    }

    /// The textures, in the order in which points take their colours.
    fn look_ups(&self) -> (LookUps, LookUps) {
        let (mut base, mut rest) = (LookUps::default(), LookUps::default());
        base.add_colour(&self.base_color);
        base.add_number(&self.base_metalness);
        base.add_number(&self.specular_roughness);
        base.add_number(&self.specular_weight);
        base.add_colour(&self.specular_color);
        base.add_number(&self.specular_ior);
        let numbers = [
            &self.base_roughness,
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
        let colours = [&self.transmission_color, &self.coat_color, &self.fuzz_color, &self.passing_color];
        numbers.into_iter().for_each(|map| rest.add_number(map));
        colours.into_iter().for_each(|map| rest.add_colour(map));
        (base, rest)
    }

    /// True if no texture varies over the surface.
    pub(super) fn are_constant(&self) -> bool {
        let below = [self.subsurface_weight.texture.as_ref(), self.subsurface_color.texture.as_ref()];
        self.of_base.are_none() && self.of_rest.are_none() && below.iter().all(Option::is_none)
    }

    /// True when nothing is above the base, and the base is opaque, reflects at its surface in the same way in all
    /// directions, and is not polished everywhere.
    pub(super) fn are_of_opaque_base(&self) -> bool {
        let roughness = &self.specular_roughness;
        let is_rough = roughness.texture.is_some() || is_rough(roughness.number);
        self.are_bare() && !self.are_lambertian() && !is_there(&self.anisotropy) && is_rough
    }

    /// True when there is nothing but a Lambertian base.
    pub(super) fn are_lambertian(&self) -> bool {
        self.are_bare() && !is_there(&self.specular_weight) && !is_there(&self.base_metalness)
    }

    /// True when nothing is above the base, which is opaque, and whose diffuse part is Lambertian.
    fn are_bare(&self) -> bool {
        let absent = [
            &self.transmission_weight,
            &self.subsurface_weight,
            &self.coat_weight,
            &self.fuzz_weight,
            &self.passing,
            &self.film_weight,
            &self.base_roughness,
        ];
        !absent.into_iter().any(is_there)
    }

    /// Inputs of an opaque base at a point; `vertex` is a factor on its colour.
    pub(super) fn opaque_base_at(&self, uv: impl Into<Patch>, vertex: Rgb) -> OpaqueBaseInputs {
        self.base_of(self.of_base.at(&uv.into()), vertex)
    }

    /// [`Maps::opaque_base_at`] for many points, in their order.
    pub(super) fn opaque_bases_at(&self, surfaces: &[Surface], mut found: impl FnMut(OpaqueBaseInputs)) {
        for surfaces in surfaces.chunks(AT_ONCE) {
            let seen = self.of_base.at_each(surfaces.iter().map(Surface::uvs));
            for (surface, seen) in surfaces.iter().zip(seen) {
                found(self.base_of(seen, surface.vertex_kd.unwrap_or(Rgb::WHITE)));
            }
        }
    }

    /// The opaque base of these colours.
    #[inline(always)]
    fn base_of(&self, mut seen: Seen<BASE>, vertex: Rgb) -> OpaqueBaseInputs {
        // In the order of `look_ups`.
        OpaqueBaseInputs {
            base_color: (seen.colour(&self.base_color) * vertex).clamp(0.0, 1.0),
            metalness: seen.number(&self.base_metalness),
            roughness: seen.number(&self.specular_roughness),
            specular_weight: seen.number(&self.specular_weight),
            specular_color: seen.colour(&self.specular_color).clamp(0.0, 1.0),
            ior: seen.number(&self.specular_ior),
        }
    }

    /// All but what is scattered below the surface.
    pub(super) fn at(&self, uv: impl Into<Patch>) -> Point {
        let uv = uv.into();
        let base = self.opaque_base_at(uv, Rgb::WHITE);
        let seen = &mut self.of_rest.at::<REST>(&uv);
        // In the order of `look_ups`.
        let base_roughness = seen.number(&self.base_roughness);
        let (anisotropy, rotation) = (seen.number(&self.anisotropy), seen.number(&self.rotation));
        let transmission = seen.number(&self.transmission_weight);
        let coat = seen.number(&self.coat_weight);
        let (coat_roughness, coat_ior) = (seen.number(&self.coat_roughness), seen.number(&self.coat_ior));
        let (fuzz, fuzz_roughness) = (seen.number(&self.fuzz_weight), seen.number(&self.fuzz_roughness));
        let passing = seen.number(&self.passing);
        let film = ThinFilm {
            weight: seen.number(&self.film_weight),
            thickness: seen.number(&self.film_thickness) * 1e3,
            eta: seen.number(&self.film_ior),
        };
        let passed = seen.colour(&self.transmission_color).clamp(0.0, 1.0);
        Point {
            base_color: base.base_color,
            base_roughness,
            metalness: base.metalness,
            specular_weight: base.specular_weight,
            specular_color: base.specular_color,
            roughness: base.roughness,
            ior: base.ior,
            anisotropy,
            rotation,
            transmission,
            passed: if self.tints_surface { passed } else { Rgb::WHITE },
            subsurface: Subsurface::None,
            body_ior: base.ior,
            thin: self.thin,
            dispersion: self.dispersion,
            coat,
            coat_color: seen.colour(&self.coat_color).clamp(0.0, 1.0),
            coat_roughness,
            coat_ior,
            coat_up: Vec3::Z,
            fuzz,
            fuzz_color: seen.colour(&self.fuzz_color).clamp(0.0, 1.0),
            fuzz_roughness,
            passing,
            passing_color: seen.colour(&self.passing_color).clamp(0.0, 1.0),
            film,
        }
    }
}

/// True if a weight is above 0, or may be somewhere.
pub(super) fn is_there(weight: &NumberMap) -> bool {
    weight.texture.is_some() || weight.number > 0.0
}
