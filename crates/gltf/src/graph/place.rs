//! Node transforms: a matrix, or translation, rotation and scale.

use crate::document::json::JsonNode;
use crate::graph::animation::{AnimatedProperty, Pose};
use bilux_import::FormatError;
use bilux_math::glam::{DQuat, DVec4};
use bilux_math::{DMat4, DVec3};

/// The transform from the space of the node with this index to its parent's, as it is posed.
pub(crate) fn local(node: JsonNode, index: usize, pose: &Pose) -> Result<DMat4, FormatError> {
    if let Some(columns) = node.numbers::<16>("matrix")? {
        let matrix = DMat4::from_cols_array(&columns);
        let last = matrix.row(3).to_array();
        if last != [0.0, 0.0, 0.0, 1.0] {
            let message = format!("the last row of this matrix is {last:?}, but must be [0, 0, 0, 1]");
            return Err(FormatError::malformed(message, node.at_key("matrix")));
        }
        return Ok(matrix);
    }
    let (translation, rotation, scale) =
        (node.numbers::<3>("translation")?, node.numbers::<4>("rotation")?, node.numbers::<3>("scale")?);
    let translation = pose.numbers(index, AnimatedProperty::Translation).or(translation).unwrap_or([0.0; 3]);
    let rotation =
        pose.numbers(index, AnimatedProperty::Rotation).or(rotation).unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let scale = pose.numbers(index, AnimatedProperty::Scale).or(scale).unwrap_or([1.0; 3]);
    compose(translation, rotation, scale).ok_or_else(|| {
        FormatError::malformed("this rotation is zero and has no effect", node.at_key("rotation"))
    })
}

/// Scale, then rotation (x, y, z, w), then translation; `None` if the rotation is zero.
pub(crate) fn compose(translation: [f64; 3], rotation: [f64; 4], scale: [f64; 3]) -> Option<DMat4> {
    let rotation = DVec4::from(rotation).try_normalize()?;
    let (scale, rotation) = (DVec3::from(scale), DQuat::from_vec4(rotation));
    Some(DMat4::from_scale_rotation_translation(scale, rotation, DVec3::from(translation)))
}
