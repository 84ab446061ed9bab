//! Holes in a surface: how much of it there is.
//!
//! A ray meets a surface of opacity o with probability o, and else goes on as if nothing were there: leaves that are
//! drawn on squares, lace, gauze. Every ray decides for itself, so that what light passes through holes does is the
//! same from both ends. See [`crate::Tracer`].

use super::{MaterialInputs, number_map};
use crate::error::SceneError;
use crate::parameters::Reader;
use crate::texture::NumberMap;
use bilux_math::registry::{Parameter, ParameterKind};

/// Shared by all materials.
pub(super) const OPACITY: Parameter = Parameter {
    name: "opacity",
    summary: "how much of the surface there is: 0 is a hole; a picture cuts out leaves and lace",
    unit: "",
    kind: ParameterKind::NumberTexture { min: 0.0, max: 1.0 },
    default: "1",
};

/// What it is where there may be holes.
pub(super) fn read(reader: &Reader, ingredients: &MaterialInputs) -> Result<Option<NumberMap>, SceneError> {
    let map = number_map(reader, OPACITY.name, ingredients)?;
    Ok((map.texture.is_some() || map.number < 1.0).then_some(map))
}
