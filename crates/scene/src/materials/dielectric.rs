//! `dielectric`: glass, water, diamond, smooth or rough.

use super::glasses::{NAMES, glass_indices};
use super::opacity::ABSENT;
use super::roughness::{ANISOTROPY, DISTRIBUTION, ROTATION, Roughness, roughness};
use super::{
    ABSORPTION, AsPrincipled, ETA, Material, MaterialEntry, NORMAL, NORMAL_SCALE, Nested, OPACITY, THIN,
    colour_map, reflectance, spread,
};
use crate::bsdf::{Bsdf, RoughDielectric, SmoothLobe};
use crate::classic::ClassicMaterial;
use crate::media::{DIAMETER, DRAINE_ALPHA, Medium, PHASE, PHASE_ANISOTROPY, SCATTERING};
use crate::messages::error::SceneError;
use crate::parameters::{Spec, Value};
use crate::surface::Surface;
use crate::texture::{ColourMap, NumberMap};
use bilux_math::Rgb;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::transcendental::exp;
use std::borrow::Cow;
use std::sync::Arc;

pub(super) const ENTRY: MaterialEntry = MaterialEntry {
    entry: Entry {
        name: "dielectric",
        summary: "glass, water or diamond; frosted glass if it is rough",
        source: "Fresnel 1823",
        parameters: &[
            GLASS,
            ETA,
            DISPERSION,
            reflectance("tint", "factor on reflected and transmitted light; white for real glass", "1"),
            ABSORPTION,
            SCATTERING,
            PHASE,
            PHASE_ANISOTROPY,
            DRAINE_ALPHA,
            DIAMETER,
            PRIORITY,
            THIN,
            roughness("0"),
            ANISOTROPY,
            ROTATION,
            DISTRIBUTION,
            spread("gloss", "maximum angle by which reflected rays spread, in cook only"),
            spread("translucency", "maximum angle by which refracted rays spread, in cook only"),
            OPACITY,
            NORMAL,
            NORMAL_SCALE,
        ],
    },
    build: |reader, inputs| {
        let name = reader.text("glass");
        if let (Some(_), Some(key)) =
            (glass_indices(&name), ["eta", "dispersion"].into_iter().find(|key| reader.is_given(key)))
        {
            let message = format!("'glass' and '{key}' both define the material: remove one of them");
            return Err(SceneError::invalid(message, reader.span(key)));
        }
        let said = (reader.number("eta"), reader.number("dispersion") / 20.0);
        let (eta, dispersion) =
            glass_indices(&name).map_or(said, |(eta, abbe_number)| (eta, 1.0 / abbe_number));
        Ok(Arc::new(Glass {
            eta,
            dispersion: if reader.bool("thin") { 0.0 } else { dispersion },
            tint: colour_map(reader, "tint", inputs)?,
            medium: Medium::read(reader, reader.colour("absorption"))?,
            priority: reader.integer("priority") as u32,
            thin: reader.bool("thin"),
            roughness: Roughness::read(reader, inputs)?,
            gloss: reader.number("gloss").to_radians(),
            translucency: reader.number("translucency").to_radians(),
        }))
    },
    principled: Some(AsPrincipled {
        keeps: &["glass", "eta", "dispersion", "tint", "absorption", "thin", "roughness"],
        differs: "",
        convert: as_principled,
    }),
};

pub(super) const PRIORITY: Parameter = Parameter {
    name: "priority",
    summary: "nested dielectrics: where two overlap, the one with the higher priority fills the overlap, of equal ones \
              the one inside the other, and eta is relative to air; 0 ignores overlaps, but glass whose faces lie on \
              those of other glass touches it, and counts as 1",
    unit: "",
    kind: ParameterKind::Integer { min: 0, max: 1000 },
    default: "0",
};

const GLASS: Parameter = Parameter {
    name: "glass",
    summary: "instead of eta and dispersion: a measured glass",
    unit: "",
    kind: ParameterKind::Choice(NAMES),
    default: "none",
};

const DISPERSION: Parameter = Parameter {
    name: "dispersion",
    summary: "dispersion: 20 divided by the Abbe number, so 0.31 for window glass, 0.55 for flint glass, 0.36 for \
              diamond",
    unit: "",
    kind: ParameterKind::Number { min: 0.0, max: 20.0 },
    default: "0",
};

/// The spec with numbers in place of the glass's name, for formats without named glasses.
pub fn with_indices(spec: &Spec) -> Cow<'_, Spec> {
    let name = spec.parameters.find("glass").map(|(value, _)| value);
    let Some(Value::Text(name)) = name.filter(|_| spec.kind == ENTRY.entry.name) else {
        return Cow::Borrowed(spec);
    };
    let mut spec = spec.clone();
    spec.parameters.0.retain(|(key, ..)| key != "glass");
    if let Some((eta, abbe_number)) = glass_indices(name) {
        spec.parameters.set("eta", eta);
        spec.parameters.set("dispersion", 20.0 / abbe_number);
    }
    Cow::Owned(spec)
}

fn as_principled(material: &Spec, principled: Spec) -> Spec {
    let material = &*with_indices(material);
    let absorbed = material.colour("absorption").unwrap_or(Rgb::BLACK);
    let mut out = principled
        .with("base_color", material.value_or("tint", 1.0))
        .with("transmission_weight", 1.0)
        .with("specular_ior", material.value_or("eta", 1.5))
        .with("specular_roughness", material.value_or("roughness", 0.0))
        .with("thin_walled", material.value_or("thin", false));
    if let Some(dispersion) = material.number("dispersion") {
        // A scale on the dispersion of an Abbe number, 20 by default.
        out = out
            .with("transmission_dispersion_scale", dispersion.min(1.0))
            .with("transmission_dispersion_abbe_number", 20.0 / dispersion.max(1.0));
    }
    if !absorbed.is_black() {
        out = out.with("transmission_depth", 1.0).with("transmission_color", absorbed.map(|a| exp(-a)));
    }
    out
}

struct Glass {
    eta: f32,
    dispersion: f32,
    tint: ColourMap,
    medium: Medium<'static>,
    priority: u32,
    thin: bool,
    roughness: Roughness,
    gloss: f32,
    translucency: f32,
}

impl Glass {
    fn is_air(&self) -> bool {
        self.only_refracts() && Nested::AIR.bends_like(&self.inside())
    }

    fn inside(&self) -> Nested {
        Nested { priority: self.priority.max(1), eta: self.eta, dispersion: self.dispersion }
    }
}

impl Material for Glass {
    fn bsdf(&self, surface: &Surface) -> Bsdf {
        let Glass { eta, dispersion, thin, .. } = *self;
        let (tint, facets) = (self.tint.at(surface.uvs()), self.roughness.at(surface));
        let glass = RoughDielectric { eta, dispersion, tint, thin, facets, film: None }.of_index(eta);
        Bsdf::of(surface.n_shade, surface.n_geom, glass).along(surface.tangent)
    }

    fn smooth_lobe(&self) -> Option<SmoothLobe> {
        let Glass { eta, thin, .. } = *self;
        let ColourMap { colour: tint, texture: None } = self.tint else { return None };
        let is_smooth =
            self.roughness.even().is_some_and(|facets| !RoughDielectric::is_rough(eta, thin, &facets));
        (is_smooth && self.dispersion == 0.0).then_some(SmoothLobe { tint, eta, is_mirror: false, thin })
    }

    fn classic(&self, surface: &Surface) -> ClassicMaterial {
        let spread = self.roughness.spread(surface);
        ClassicMaterial {
            ks: Rgb::WHITE,
            kt: self.tint.at(surface.uvs()),
            exponent: 500.0,
            reflectivity: 1.0,
            eta: self.eta,
            sigma_a: self.medium.sigma_a,
            thin: self.thin,
            gloss: self.gloss.max(spread),
            translucency: self.translucency.max(spread),
            fresnel: true,
            ..ClassicMaterial::default()
        }
    }

    fn opacity(&self) -> Option<&NumberMap> {
        (self.thin && self.is_air()).then_some(&ABSENT)
    }

    fn needs_tangents(&self) -> bool {
        self.roughness.has_direction()
    }

    fn disperses(&self) -> bool {
        self.dispersion > 0.0
    }

    fn nested(&self) -> Option<Nested> {
        // What is as clear as air has no surface of its own.
        self.in_contact().filter(|_| self.priority > 0 || self.is_air())
    }

    fn in_contact(&self) -> Option<Nested> {
        (!self.thin).then_some(self.inside())
    }

    fn is_pane(&self) -> bool {
        self.thin
    }

    fn only_refracts(&self) -> bool {
        self.tint.texture.is_none() && self.tint.colour == Rgb::WHITE
    }

    fn medium(&self) -> Option<Medium<'_>> {
        (!self.thin).then_some(self.medium)
    }
}
