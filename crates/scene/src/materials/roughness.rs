//! Surface roughness, in the parameters that users set.

use super::{MaterialInputs, number_map};
use crate::bsdf::{Beckmann, Facets, Ggx};
use crate::messages::error::SceneError;
use crate::parameters::Reader;
use crate::surface::Surface;
use crate::texture::NumberMap;
use bilux_math::registry::{Parameter, ParameterKind};
use bilux_math::transcendental::atan;

/// Makes microfacets of a roughness, an anisotropy and a rotation in radians.
type Distribution = fn(f32, f32, f32) -> Facets;

/// Roughness, isotropic or smoother along a brushing.
pub(super) struct Roughness {
    roughness: NumberMap,
    anisotropy: NumberMap,
    /// Rotation of the brushing, in radians.
    rotation: f32,
    of: Distribution,
    /// The precomputed microfacets, if no texture varies them.
    even: Option<Facets>,
}

impl Roughness {
    pub(super) fn read(reader: &Reader, inputs: &MaterialInputs) -> Result<Roughness, SceneError> {
        let (roughness, anisotropy) =
            (number_map(reader, "roughness", inputs)?, number_map(reader, "anisotropy", inputs)?);
        let rotation = reader.number("rotation").to_radians();
        let of: Distribution = match reader.text(DISTRIBUTION.name).as_ref() {
            "beckmann" => |roughness, anisotropy, rotation| {
                Beckmann::from_roughness(roughness, anisotropy, rotation).into()
            },
            _ => {
                |roughness, anisotropy, rotation| Ggx::from_roughness(roughness, anisotropy, rotation).into()
            }
        };
        let even = (roughness.texture.is_none() && anisotropy.texture.is_none())
            .then(|| of(roughness.number, anisotropy.number, rotation));
        Ok(Roughness { roughness, anisotropy, rotation, of, even })
    }

    /// The microfacets, but for their rotation, if they are the same everywhere.
    pub(super) fn even(&self) -> Option<Facets> {
        self.even
    }

    /// The microfacets at a point.
    #[inline]
    pub(super) fn at(&self, surface: &Surface) -> Facets {
        // The rotation is from u towards v, whichever side of u that is on.
        let rotation = self.rotation * surface.handedness;
        self.even.filter(|_| rotation == self.rotation).unwrap_or_else(|| {
            let uv = surface.uvs();
            (self.of)(self.roughness.at(uv), self.anisotropy.at(uv), rotation)
        })
    }

    /// True when the surface may be anisotropic.
    pub(super) fn has_direction(&self) -> bool {
        let is_rough = self.even.is_none_or(|facets| !facets.is_smooth());
        is_rough && (self.anisotropy.texture.is_some() || self.anisotropy.number > 0.0)
    }

    /// The square of the roughness.
    fn alpha(&self, surface: &Surface) -> f32 {
        let roughness = self.roughness.at(surface.uvs());
        roughness * roughness
    }

    /// The maximum angle by which the classic modes spread rays, in radians.
    pub(super) fn spread(&self, surface: &Surface) -> f32 {
        atan(self.alpha(surface))
    }

    /// The exponent of a highlight of about the same width, in the classic modes.
    pub(super) fn exponent(&self, surface: &Surface) -> f32 {
        let alpha = self.alpha(surface);
        (2.0 / (alpha * alpha) - 2.0).min(500.0)
    }
}

pub(super) const fn roughness(default: &'static str) -> Parameter {
    Parameter {
        name: "roughness",
        summary: "microfacet roughness: 0 is perfectly smooth; the square root of the distribution's alpha",
        unit: "",
        kind: ParameterKind::NumberTexture { min: 0.0, max: 1.0 },
        default,
    }
}

pub(super) const ANISOTROPY: Parameter = Parameter {
    name: "anisotropy",
    summary: "anisotropy: how much smoother the surface is along its tangent than across it",
    unit: "",
    kind: ParameterKind::NumberTexture { min: 0.0, max: 1.0 },
    default: "0",
};

pub(super) const ROTATION: Parameter = Parameter {
    name: "rotation",
    summary: "rotation of the anisotropy's direction, which is along u, or around the y axis of meshes without texture coordinates",
    unit: "degrees",
    kind: ParameterKind::Number { min: -360.0, max: 360.0 },
    default: "0",
};

pub(super) const DISTRIBUTION: Parameter = Parameter {
    name: "distribution",
    summary: "distribution of the normals of microfacets, with long tails or without",
    unit: "",
    kind: ParameterKind::Choice(&["ggx", "beckmann"]),
    default: "ggx",
};
