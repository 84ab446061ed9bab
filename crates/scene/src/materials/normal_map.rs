//! Normal maps, for any material: red along the tangent, green across it, blue away from the surface, each from -1 to 1
//! (tangent space as in OpenGL and glTF: green is up).

use super::{MaterialInputs, texture};
use crate::error::SceneError;
use crate::parameters::Reader;
use crate::surface::Surface;
use crate::texture::Texture;
use bilux_math::Vec3;
use bilux_math::registry::{Parameter, ParameterKind};
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
    Ok(map.filter(|_| scale > 0.0).map(|map| NormalMap { map, scale }))
}

impl NormalMap {
    /// The normal at a point that has a tangent, on the same side as `n_geom`.
    pub(super) fn at(&self, surface: &Surface) -> Vec3 {
        // Use single texels: averaged normals would give a smoother surface.
        let texel = self.map.at(surface.uv_pair());
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
