//! `conductor`: polished, satin or brushed metal.

use super::metals::{METALS, NAMES};
use super::roughness::{ANISOTROPY, DISTRIBUTION, ROTATION, Roughness, roughness};
use super::{
    AsPrincipled, Material, MaterialEntry, NORMAL, NORMAL_SCALE, OPACITY, VISIBLE_SIDES, colour_map,
    reflectance,
};
use crate::bsdf::{Bsdf, Conductor, Fresnel, Lobe};
use crate::classic::ClassicMaterial;
use crate::messages::error::SceneError;
use crate::parameters::{Reader, Spec};
use crate::surface::Surface;
use crate::texture::ColourMap;
use bilux_math::Rgb;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use std::sync::Arc;

pub(super) const ENTRY: MaterialEntry = MaterialEntry {
    entry: Entry {
        name: "conductor",
        summary: "metal: polished, satin or brushed",
        source: "Walter 2007",
        parameters: &[
            Parameter {
                name: "metal",
                summary: "a measured metal",
                unit: "",
                kind: ParameterKind::Choice(NAMES),
                default: "aluminium",
            },
            index("eta", "instead of 'metal': the real part of the refractive index", 1e-3),
            index("k", "instead of 'metal': the imaginary part, the extinction coefficient", 0.0),
            reflectance("reflectance", "instead of 'metal': reflectance at normal incidence", "1"),
            Parameter {
                name: "edge",
                summary: "with 'reflectance': factor on Schlick's approximation at 82 degrees",
                unit: "",
                kind: ParameterKind::Colour { min: 0.0, max: 1.0 },
                default: "1",
            },
            roughness("0.3"),
            ANISOTROPY,
            ROTATION,
            DISTRIBUTION,
            OPACITY,
            VISIBLE_SIDES,
            NORMAL,
            NORMAL_SCALE,
        ],
    },
    build: |reader, inputs| {
        one_colour(reader)?;
        let tint = colour_map(reader, "reflectance", inputs)?;
        let named = reader.text("metal");
        let named = METALS.iter().find(|metal| metal.name == named);
        let colour = match named {
            _ if reader.is_given("reflectance") => Colour::Tinted { tint, edge: reader.colour("edge") },
            Some(metal) if !reader.is_given("eta") => {
                Colour::Metal(Fresnel::Complex { eta: metal.eta, k: metal.k })
            }
            _ => Colour::Metal(Fresnel::Complex { eta: reader.colour("eta"), k: reader.colour("k") }),
        };
        Ok(Arc::new(ConductorMaterial { colour, roughness: Roughness::read(reader, inputs)? }))
    },
    principled: Some(AsPrincipled {
        keeps: &["metal", "eta", "k", "reflectance", "roughness"],
        differs: "",
        convert: |material, principled| {
            let colour = normal_incidence_reflectance(material).unwrap_or(Rgb::grey(0.9));
            principled
                .with("base_color", material.value_or("reflectance", colour))
                .with("base_metalness", 1.0)
                .with("specular_roughness", material.value_or("roughness", 0.3))
        },
    }),
};

/// A metal's reflectance at normal incidence; `None` if the spec is not a valid conductor.
pub fn normal_incidence_reflectance(spec: &Spec) -> Option<Rgb> {
    let reader = Reader::new(spec, &ENTRY.entry).ok().filter(|_| spec.kind == ENTRY.entry.name)?;
    if reader.is_given("reflectance") {
        return Some(reader.colour("reflectance"));
    }
    let named = METALS.iter().find(|metal| metal.name == reader.text("metal"));
    let metal = match named.filter(|_| !reader.is_given("eta")) {
        Some(metal) => Fresnel::Complex { eta: metal.eta, k: metal.k },
        None => Fresnel::Complex { eta: reader.colour("eta"), k: reader.colour("k") },
    };
    Some(metal.at(1.0))
}

const fn index(name: &'static str, summary: &'static str, min: f64) -> Parameter {
    Parameter { name, summary, unit: "", kind: ParameterKind::Colour { min, max: 100.0 }, default: "1" }
}

/// Rejects contradictory or incomplete descriptions of the metal.
fn one_colour(reader: &Reader) -> Result<(), SceneError> {
    let given: Vec<&str> =
        ["metal", "eta", "reflectance"].into_iter().filter(|key| reader.is_given(key)).collect();
    if let [first, second, ..] = given[..] {
        let message = format!("'{first}' and '{second}' both define the metal: remove one of them");
        return Err(SceneError::invalid(message, reader.span(second)));
    }
    let alone = [("eta", "k"), ("k", "eta"), ("edge", "reflectance")];
    match alone.into_iter().find(|(key, with)| reader.is_given(key) && !reader.is_given(with)) {
        Some((key, with)) => Err(SceneError::invalid(
            format!(
                "'{key}' has no effect without '{with}': add '{with}', or remove \
                                             '{key}'"
            ),
            reader.span(key),
        )),
        None => Ok(()),
    }
}

struct ConductorMaterial {
    colour: Colour,
    roughness: Roughness,
}

enum Colour {
    Metal(Fresnel),
    Tinted { tint: ColourMap, edge: Rgb },
}

impl ConductorMaterial {
    fn fresnel(&self, surface: &Surface) -> Fresnel {
        match &self.colour {
            Colour::Metal(fresnel) => *fresnel,
            Colour::Tinted { tint, edge } => Fresnel::tinted(tint.at(surface.uvs()), *edge),
        }
    }
}

impl Material for ConductorMaterial {
    fn bsdf(&self, surface: &Surface) -> Bsdf {
        let metal = Conductor { fresnel: self.fresnel(surface), facets: self.roughness.at(surface) };
        Bsdf::of(surface.n_shade, surface.n_geom, Lobe::Conductor(metal)).along(surface.tangent)
    }

    fn classic(&self, surface: &Surface) -> ClassicMaterial {
        ClassicMaterial {
            ks: self.fresnel(surface).at(1.0),
            exponent: self.roughness.exponent(surface),
            reflectivity: 1.0,
            gloss: self.roughness.spread(surface),
            ..ClassicMaterial::default()
        }
    }

    fn needs_tangents(&self) -> bool {
        self.roughness.has_direction()
    }
}
