//! Attributes that all kinds of geometry have.

use super::document::Look;
use super::text::{Text, push_number, rgb};
use bilux_scene::Mesh;

/// Follows the values of what vertices have.
pub(super) const BY_VERTEX: &str = " (\n        interpolation = \"vertex\"\n    )";
/// Follows the values of what faces have.
pub(super) const BY_FACE: &str = " (\n        interpolation = \"uniform\"\n    )";

pub(super) fn extent(mesh: &Mesh, text: &mut Text) {
    let bounds = mesh.bounds();
    if !bounds.is_empty() {
        text.tuples("float3[] extent", [bounds.min.to_array(), bounds.max.to_array()], "");
    }
}

/// The colours and opacities that a prim has itself.
pub(super) fn colours(mesh: &Mesh, look: &Look, text: &mut Text) {
    if !mesh.vertex_kd.is_empty() {
        let shown = mesh.vertex_kd.iter().map(|colour| (*colour * look.factor).to_array());
        text.tuples("color3f[] primvars:displayColor", shown, BY_VERTEX);
    } else if let Some(colour) = look.colour {
        text.line(&format!("color3f[] primvars:displayColor = [{}]", rgb(colour)));
    }
    if let Some(opacity) = look.opacity {
        text.list("float[] primvars:displayOpacity", [opacity], push_number, "");
    }
}
