//! Normal maps, for any material: red along the tangent, green across it, blue away from the surface, each from -1 to 1
//! (tangent space as in OpenGL and glTF: green is up).

use super::{MaterialInputs, texture};
use crate::messages::error::SceneError;
use crate::parameters::Reader;
use crate::surface::Surface;
use crate::texture::{AT_ONCE, LookUps, Texture};
use bilux_math::registry::{Parameter, ParameterKind};
use bilux_math::{Rgb, Vec3};
use std::sync::Arc;

pub(super) const NORMAL: Parameter = Parameter {
    name: "normal",
    summary: "normal map in tangent space, with green up as in OpenGL and glTF",
    unit: "",
    kind: ParameterKind::Texture,
    default: "none",
};

pub(super) const NORMAL_SCALE: Parameter = Parameter {
    name: "normal_scale",
    summary: "strength of the normal map",
    unit: "",
    kind: ParameterKind::Number { min: 0.0, max: 10.0 },
    default: "1",
};

pub(super) const COAT_NORMAL: Parameter = Parameter {
    name: "coat_normal",
    summary: "normal map of the coat; without it the coat is as smooth as the mesh",
    ..NORMAL
};

pub(super) const COAT_NORMAL_SCALE: Parameter = Parameter { name: "coat_normal_scale", ..NORMAL_SCALE };

/// A normal map.
pub(super) struct NormalMap {
    map: Arc<Texture>,
    /// The map, for many points at a time.
    look_ups: LookUps,
    scale: f32,
}

/// The normal map of a material, if any.
pub(super) fn read(reader: &Reader, inputs: &MaterialInputs) -> Result<Option<NormalMap>, SceneError> {
    read_named(reader, [NORMAL.name, NORMAL_SCALE.name], inputs)
}

/// The normal map of its coat, if any.
pub(super) fn read_of_coat(
    reader: &Reader,
    inputs: &MaterialInputs,
) -> Result<Option<NormalMap>, SceneError> {
    read_named(reader, [COAT_NORMAL.name, COAT_NORMAL_SCALE.name], inputs)
}

fn read_named(
    reader: &Reader,
    [map, scale]: [&str; 2],
    inputs: &MaterialInputs,
) -> Result<Option<NormalMap>, SceneError> {
    let scale = reader.number(scale);
    let map = texture(reader, map, inputs)?;
    Ok(map.filter(|_| scale > 0.0).map(|map| NormalMap { look_ups: LookUps::of_points(&map), map, scale }))
}

impl NormalMap {
    /// The normal at a point that has a tangent, on the same side as `n_geom`.
    pub(super) fn at(&self, surface: &Surface) -> Vec3 {
        // Use single texels: averaged normals would give a smoother surface.
        self.turned(surface, self.map.at(surface.uv_pair()))
    }

    /// Sets the shading normals of many points that have tangents.
    pub(super) fn set_on(&self, surfaces: &mut [Surface]) {
        for surfaces in surfaces.chunks_mut(AT_ONCE) {
            let seen = self.look_ups.at_each::<1>(surfaces.iter().map(|surface| surface.uv_pair().into()));
            for (surface, mut seen) in surfaces.iter_mut().zip(seen) {
                surface.n_shade = self.turned(surface, seen.take());
            }
        }
    }

    /// The normal that a texel gives.
    #[inline]
    fn turned(&self, surface: &Surface, texel: Rgb) -> Vec3 {
        let lean = |c: f32| (2.0 * c - 1.0) * self.scale;
        let (x, y, z) = (lean(texel.r), lean(texel.g), 2.0 * texel.b - 1.0);
        let n = surface.n_smooth;
        let Some(tangent) = (surface.tangent - n * n.dot(surface.tangent)).try_normalize() else { return n };
        let across = n.cross(tangent) * surface.handedness;
        let Some(turned) = (tangent * x + across * y + n * z).try_normalize() else { return n };
        // No normal points inside the surface.
        let depth = turned.dot(surface.n_geom).min(0.0);
        (turned - surface.n_geom * (2.0 * depth)).try_normalize().unwrap_or(n)
    }
}
