//! Opacity masks (alpha): how much of a surface is present.
//!
//! A ray hits a surface of opacity o with probability o, and otherwise continues as if it were not there: leaves cut
//! out of squares, lace, gauze. The decision is made per ray, so that transport through cut-outs is the same from both
//! ends of a path. See [`crate::Tracer`].

use super::{MaterialInputs, number_map};
use crate::messages::error::SceneError;
use crate::parameters::Reader;
use crate::texture::NumberMap;
use bilux_math::registry::{Parameter, ParameterKind};

/// Shared by all materials.
pub(super) const OPACITY: Parameter = Parameter {
    name: "opacity",
    summary: "opacity: 0 is a hole; a texture makes cut-outs such as leaves and lace",
    unit: "",
    kind: ParameterKind::NumberTexture { min: 0.0, max: 1.0 },
    default: "1",
};

/// Opacity of a pane that is as clear as air.
pub(super) static ABSENT: NumberMap = NumberMap { number: 0.0, range: [0.0; 2], texture: None };

/// The opacity, if it may be below 1.
pub(super) fn read(reader: &Reader, inputs: &MaterialInputs) -> Result<Option<NumberMap>, SceneError> {
    let map = number_map(reader, OPACITY.name, inputs)?;
    Ok((map.texture.is_some() || map.number < 1.0).then_some(map))
}
