//! `diffuse`: matt, equally bright from everywhere.

use super::{
    EMISSION, EMISSION_SCALE, EMISSION_SIDES, Material, MaterialEntry, NORMAL, NORMAL_SCALE, OPACITY,
    colour_map, reflectance,
};
use crate::bsdf::{Bsdf, Lambert, Lobe};
use crate::classic::ClassicMaterial;
use crate::surface::Surface;
use crate::texture::ColourMap;
use bilux_math::Rgb;
use bilux_math::registry::Entry;
use std::sync::Arc;

pub(super) const ENTRY: MaterialEntry = MaterialEntry {
    entry: Entry {
        name: "diffuse",
        summary: "matt, equally bright from everywhere",
        source: "Lambert 1760",
        parameters: &[
            reflectance("reflectance", "reflected fraction of the light", "0.7"),
            EMISSION,
            EMISSION_SCALE,
            EMISSION_SIDES,
            OPACITY,
            NORMAL,
            NORMAL_SCALE,
        ],
    },
    build: |reader, ingredients| {
        Ok(Arc::new(Diffuse { reflectance: colour_map(reader, "reflectance", ingredients)? }))
    },
};

struct Diffuse {
    reflectance: ColourMap,
}

impl Diffuse {
    fn albedo(&self, surface: &Surface) -> Rgb {
        let vertex = surface.vertex_kd.unwrap_or(Rgb::WHITE);
        (self.reflectance.at(surface.uvs()) * vertex).clamp(0.0, 1.0)
    }
}

impl Material for Diffuse {
    fn bsdf(&self, surface: &Surface) -> Bsdf {
        let lambert = Lobe::Lambert(Lambert { albedo: self.albedo(surface) });
        Bsdf::of(surface.n_shade, surface.n_geom, lambert)
    }

    fn classic(&self, surface: &Surface) -> ClassicMaterial {
        let kd = self.albedo(surface);
        ClassicMaterial { ka: kd, kd, ..ClassicMaterial::default() }
    }
}
