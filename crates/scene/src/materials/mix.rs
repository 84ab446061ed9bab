//! `mix`: a mixture of two materials, weighted by `amount`.

use super::{Material, MaterialEntry, MaterialInputs, NORMAL, NORMAL_SCALE, Nested, OPACITY, number_map};
use crate::bsdf::{Bsdf, MAX_LOBES};
use crate::classic::ClassicMaterial;
use crate::media::Medium;
use crate::mesh::sides::Sides;
use crate::messages::error::SceneError;
use crate::parameters::Reader;
use crate::surface::Surface;
use crate::texture::NumberMap;
use bilux_math::Rgb;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use std::sync::Arc;

pub(super) const ENTRY: MaterialEntry = MaterialEntry {
    entry: Entry {
        name: "mix",
        summary: "a mixture of two materials",
        source: "",
        parameters: &[
            part("a", "the name of the first material"),
            part("b", "the name of the second material, which may be a mix itself"),
            Parameter {
                name: "amount",
                summary: "weight of the second material",
                unit: "",
                kind: ParameterKind::NumberTexture { min: 0.0, max: 1.0 },
                default: "0.5",
            },
            OPACITY,
            NORMAL,
            NORMAL_SCALE,
        ],
    },
    build: |reader, inputs| {
        let (a, b) = (read_part(reader, inputs, "a")?, read_part(reader, inputs, "b")?);
        let lobes = a.max_lobes() + b.max_lobes();
        if lobes > MAX_LOBES {
            let message = format!(
                "these materials have {lobes} lobes together, but a mix has at most {MAX_LOBES}: a phong material has \
                 3, others have 1"
            );
            return Err(SceneError::invalid(message, reader.span("a")));
        }
        Ok(Arc::new(Mix { a, b, amount: number_map(reader, "amount", inputs)? }))
    },
    principled: None,
};

const fn part(name: &'static str, summary: &'static str) -> Parameter {
    Parameter { name, summary, unit: "", kind: ParameterKind::Material, default: "" }
}

fn read_part(reader: &Reader, inputs: &MaterialInputs, key: &str) -> Result<Arc<dyn Material>, SceneError> {
    let index = reader.material(key);
    let material = inputs.material(index, reader.span(key))?;
    if inputs.materials[index].parameters.find("normal").is_some() {
        let message =
            format!("'{key}' has a normal map, which the mix would ignore: give the map to the mix");
        return Err(SceneError::invalid(message, reader.span(key)));
    }
    if material.opacity().is_some() {
        let message =
            format!("'{key}' has an opacity, which the mix would ignore: give the opacity to the mix");
        return Err(SceneError::invalid(message, reader.span(key)));
    }
    if material.visible_sides() != Sides::Both {
        let message = format!(
            "'{key}' is visible only from its front, but a mix is visible from both sides: remove \
                               its visible_sides"
        );
        return Err(SceneError::invalid(message, reader.span(key)));
    }
    if !material.emission().is_black() {
        let message =
            format!("'{key}' emits light, which a mix cannot: give that material to an object of its own");
        return Err(SceneError::invalid(message, reader.span(key)));
    }
    Ok(material)
}

struct Mix {
    a: Arc<dyn Material>,
    b: Arc<dyn Material>,
    amount: NumberMap,
}

impl Mix {
    /// The weight of the second material.
    fn share(&self, surface: &Surface) -> f32 {
        self.amount.at(surface.uvs())
    }
}

impl Material for Mix {
    fn bsdf(&self, surface: &Surface) -> Bsdf {
        match self.share(surface) {
            0.0 => self.a.bsdf(surface),
            1.0 => self.b.bsdf(surface),
            share => self.a.bsdf(surface).mixed(&self.b.bsdf(surface), share),
        }
    }

    fn classic(&self, surface: &Surface) -> ClassicMaterial {
        let (a, b, share) = (self.a.classic(surface), self.b.classic(surface), self.share(surface));
        let number = |a: f32, b: f32| a + (b - a) * share;
        // The interior is that of the material that transmits light.
        let clear = if a.kt.is_black() { b } else { a };
        ClassicMaterial {
            ka: a.ka.lerp(b.ka, share),
            kd: a.kd.lerp(b.kd, share),
            ks: a.ks.lerp(b.ks, share),
            kt: a.kt.lerp(b.kt, share),
            exponent: number(a.exponent, b.exponent),
            reflectivity: number(a.reflectivity, b.reflectivity),
            gloss: number(a.gloss, b.gloss),
            ..clear
        }
    }

    fn needs_tangents(&self) -> bool {
        self.a.needs_tangents() || self.b.needs_tangents()
    }

    fn max_lobes(&self) -> usize {
        self.a.max_lobes() + self.b.max_lobes()
    }

    fn disperses(&self) -> bool {
        self.a.disperses() || self.b.disperses()
    }

    fn nested(&self) -> Option<Nested> {
        self.a.nested().or(self.b.nested())
    }

    fn in_contact(&self) -> Option<Nested> {
        self.a.in_contact().or(self.b.in_contact())
    }

    fn is_pane(&self) -> bool {
        (self.a.is_pane() || self.b.is_pane()) && self.medium().is_none()
    }

    /// The interior does not depend on where light entered: use the denser of the two.
    fn medium(&self) -> Option<Medium<'_>> {
        let (a, b) = match (self.a.medium(), self.b.medium()) {
            (Some(a), Some(b)) => (a, b),
            (a, b) => return a.or(b),
        };
        let denser = |a: Rgb, b: Rgb| Rgb::new(a.r.max(b.r), a.g.max(b.g), a.b.max(b.b));
        let phase = if a.scatters() { a.phase } else { b.phase };
        let (sigma_a, sigma_s) = (denser(a.sigma_a, b.sigma_a), denser(a.sigma_s, b.sigma_s));
        Some(Medium { sigma_a, sigma_s, phase, density: a.density.or(b.density), glow: a.glow.or(b.glow) })
    }
}
