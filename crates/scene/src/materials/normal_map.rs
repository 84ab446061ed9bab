//! Normals from a picture, for any material: red along the tangent, green across it, blue away from the surface, each
//! from -1 to 1 (tangent space, as OpenGL and glTF have it: green is up).

use super::{Ingredients, Material, Nested, texture};
use crate::bsdf::Bsdf;
use crate::classic::ClassicMaterial;
use crate::error::SceneError;
use crate::lights::Sides;
use crate::parameters::Reader;
use crate::surface::Surface;
use crate::texture::{ColourMap, Texture};
use bilux_math::registry::{Parameter, ParameterKind};
use bilux_math::{Rgb, Vec3};
use std::sync::Arc;

pub(super) const NORMAL: Parameter = Parameter {
    name: "normal",
    summary: "normals as a picture, in tangent space, green up as in OpenGL and glTF",
    unit: "",
    kind: ParameterKind::Texture,
    default: "none",
};

pub(super) const NORMAL_SCALE: Parameter = Parameter {
    name: "normal_scale",
    summary: "factor on how far the picture's normals lean",
    unit: "",
    kind: ParameterKind::Number { min: 0.0, max: 10.0 },
    default: "1",
};

/// A material with the normals of a picture, if one is given.
pub(super) fn apply(
    material: Arc<dyn Material>,
    reader: &Reader,
    ingredients: &Ingredients,
) -> Result<Arc<dyn Material>, SceneError> {
    let scale = reader.number("normal_scale");
    Ok(match texture(reader, "normal", ingredients)? {
        Some(map) if scale > 0.0 => Arc::new(NormalMapped { material, map, scale }),
        _ => material,
    })
}

struct NormalMapped {
    material: Arc<dyn Material>,
    map: Arc<Texture>,
    scale: f32,
}

impl Material for NormalMapped {
    fn n_shade(&self, surface: &Surface) -> Vec3 {
        let texel = self.map.at(surface.uv);
        let lean = |c: f32| (2.0 * c - 1.0) * self.scale;
        let (x, y, z) = (lean(texel.r), lean(texel.g), 2.0 * texel.b - 1.0);
        let n = surface.n_shade;
        let Some(tangent) = (surface.tangent - n * n.dot(surface.tangent)).try_normalize() else { return n };
        let across = n.cross(tangent) * surface.handedness;
        let Some(turned) = (tangent * x + across * y + n * z).try_normalize() else { return n };
        // No normal is on the inside.
        let depth = turned.dot(surface.n_geom).min(0.0);
        (turned - surface.n_geom * (2.0 * depth)).try_normalize().unwrap_or(n)
    }

    fn bsdf(&self, surface: &Surface) -> Bsdf {
        self.material.bsdf(surface).bending()
    }

    fn classic(&self, surface: &Surface) -> ClassicMaterial {
        self.material.classic(surface)
    }

    fn needs_tangents(&self) -> bool {
        true
    }

    fn most_lobes(&self) -> usize {
        self.material.most_lobes()
    }

    fn emission(&self) -> Rgb {
        self.material.emission()
    }

    fn emission_map(&self) -> Option<&ColourMap> {
        self.material.emission_map()
    }

    fn emission_sides(&self) -> Sides {
        self.material.emission_sides()
    }

    fn nested(&self) -> Option<Nested> {
        self.material.nested()
    }

    fn sigma_a(&self) -> Rgb {
        self.material.sigma_a()
    }
}
