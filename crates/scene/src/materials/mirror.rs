//! `mirror`: reflects like polished metal.

use super::{
    AsPrincipled, EMISSION, EMISSION_SCALE, EMISSION_SIDES, Material, MaterialEntry, NORMAL, NORMAL_SCALE,
    OPACITY, VISIBLE_SIDES, colour_map, reflectance, spread,
};
use crate::bsdf::{Bsdf, Lobe, Mirror, SmoothLobe};
use crate::classic::ClassicMaterial;
use crate::surface::Surface;
use crate::texture::ColourMap;
use bilux_math::registry::Entry;
use std::sync::Arc;

pub(super) const ENTRY: MaterialEntry = MaterialEntry {
    entry: Entry {
        name: "mirror",
        summary: "a perfect mirror",
        source: "",
        parameters: &[
            reflectance("reflectance", "reflected fraction of the light", "0.95"),
            spread("gloss", "maximum angle by which reflected rays spread, in cook only"),
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
        Ok(Arc::new(MirrorMaterial {
            reflectance: colour_map(reader, "reflectance", inputs)?,
            gloss: reader.number("gloss").to_radians(),
        }))
    },
    principled: Some(AsPrincipled {
        keeps: &["reflectance"],
        differs: "",
        convert: |material, principled| {
            principled
                .with("base_color", material.value_or("reflectance", 0.95))
                .with("base_metalness", 1.0)
                .with("specular_roughness", 0.0)
        },
    }),
};

struct MirrorMaterial {
    reflectance: ColourMap,
    gloss: f32,
}

impl Material for MirrorMaterial {
    fn bsdf(&self, surface: &Surface) -> Bsdf {
        let mirror = Lobe::Mirror(Mirror { reflectance: self.reflectance.at(surface.uvs()) });
        Bsdf::of(surface.n_shade, surface.n_geom, mirror)
    }

    fn smooth_lobe(&self) -> Option<SmoothLobe> {
        let ColourMap { colour: tint, texture: None } = self.reflectance else { return None };
        Some(SmoothLobe { tint, eta: 1.0, is_mirror: true, thin: false })
    }

    fn classic(&self, surface: &Surface) -> ClassicMaterial {
        ClassicMaterial {
            ks: self.reflectance.at(surface.uvs()),
            exponent: 500.0,
            reflectivity: 1.0,
            gloss: self.gloss,
            ..ClassicMaterial::default()
        }
    }
}
