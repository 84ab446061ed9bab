//! How rough a surface is, as users say it.

use crate::bsdf::Ggx;
use crate::parameters::Reader;
use bilux_math::registry::{Parameter, ParameterKind};
use bilux_math::transcendental::atan;

/// Roughness, the same in all directions or smoother along a brushing.
#[derive(Clone, Copy)]
pub(super) struct Roughness {
    pub(super) ggx: Ggx,
    anisotropy: f32,
    /// The square of the roughness.
    alpha: f32,
}

impl Roughness {
    pub(super) fn read(reader: &Reader) -> Roughness {
        let (roughness, anisotropy) = (reader.number("roughness"), reader.number("anisotropy"));
        let ggx = Ggx::from_roughness(roughness, anisotropy, reader.number("rotation").to_radians());
        Roughness { ggx, anisotropy, alpha: roughness * roughness }
    }

    /// True when it matters how the surface is turned.
    pub(super) fn has_direction(&self) -> bool {
        self.anisotropy > 0.0 && !self.ggx.is_smooth()
    }

    /// The greatest angle by which the classic modes spread rays, in radians.
    pub(super) fn spread(&self) -> f32 {
        atan(self.alpha)
    }

    /// The exponent of a highlight about as wide, in the classic modes.
    pub(super) fn exponent(&self) -> f32 {
        (2.0 / (self.alpha * self.alpha) - 2.0).min(500.0)
    }
}

pub(super) const fn roughness(default: &'static str) -> Parameter {
    Parameter {
        name: "roughness",
        summary: "0 is polished, 1 as rough as can be; the square root of GGX's alpha",
        unit: "",
        kind: ParameterKind::Number { min: 0.0, max: 1.0 },
        default,
    }
}

pub(super) const ANISOTROPY: Parameter = Parameter {
    name: "anisotropy",
    summary: "how much smoother it is along its brushing than across",
    unit: "",
    kind: ParameterKind::Number { min: 0.0, max: 1.0 },
    default: "0",
};

pub(super) const ROTATION: Parameter = Parameter {
    name: "rotation",
    summary: "turns the brushing, which goes along u, or around the y axis of meshes without texture coordinates",
    unit: "degrees",
    kind: ParameterKind::Number { min: -360.0, max: 360.0 },
    default: "0",
};
