//! `dielectric`: smooth glass, water, diamond.

use super::{ABSORPTION, ETA, Material, MaterialEntry, THIN, colour_map, reflectance, spread};
use crate::bsdf::{Bsdf, Dielectric, Lobe};
use crate::classic::ClassicMaterial;
use crate::surface::Surface;
use crate::texture::ColourMap;
use bilux_math::Rgb;
use bilux_math::registry::Entry;
use std::sync::Arc;

pub(super) const ENTRY: MaterialEntry = MaterialEntry {
    entry: Entry {
        name: "dielectric",
        summary: "smooth glass, water, diamond",
        source: "Fresnel 1823",
        parameters: &[
            ETA,
            reflectance("tint", "factor on all light; white for real glass", "1"),
            ABSORPTION,
            THIN,
            spread("gloss", "greatest angle by which reflected rays spread, in cook only"),
            spread("translucency", "greatest angle by which refracted rays spread, in cook only"),
        ],
    },
    build: |reader, textures| {
        Ok(Arc::new(Glass {
            eta: reader.number("eta"),
            tint: colour_map(reader, "tint", textures)?,
            sigma_a: reader.colour("absorption"),
            thin: reader.bool("thin"),
            gloss: reader.number("gloss").to_radians(),
            translucency: reader.number("translucency").to_radians(),
        }))
    },
};

struct Glass {
    eta: f32,
    tint: ColourMap,
    sigma_a: Rgb,
    thin: bool,
    gloss: f32,
    translucency: f32,
}

impl Material for Glass {
    fn bsdf(&self, surface: &Surface) -> Bsdf {
        let glass = Dielectric { eta: self.eta, tint: self.tint.at(surface.uv), thin: self.thin };
        Bsdf::new(surface.n_shade, surface.n_geom, [Some(Lobe::Dielectric(glass)), None, None])
    }

    fn classic(&self, surface: &Surface) -> ClassicMaterial {
        ClassicMaterial {
            ks: Rgb::WHITE,
            kt: self.tint.at(surface.uv),
            exponent: 500.0,
            reflectivity: 1.0,
            eta: self.eta,
            sigma_a: self.sigma_a,
            thin: self.thin,
            gloss: self.gloss,
            translucency: self.translucency,
            fresnel: true,
            ..ClassicMaterial::default()
        }
    }

    fn sigma_a(&self) -> Rgb {
        if self.thin { Rgb::BLACK } else { self.sigma_a }
    }
}
