//! Converts materials of any kind to `principled`, the only one that glTF can represent.

use super::Document;
use bilux_import::output::values::{self, number};
use bilux_import::output::writing::Writing;
use bilux_scene::Spec;

/// Converts any material to `principled`; textures are checked after that.
pub(super) fn as_principled(spec: &Spec, document: &Document, writing: &mut Writing) -> Spec {
    if spec.kind == "principled" {
        let mut same = spec.clone();
        // glTF tints transmitted light by the base colour.
        if number(spec, "transmission_depth").unwrap_or(0.0) == 0.0
            && number(spec, "transmission_weight") == Some(1.0)
        {
            same.parameters.set("base_color", spec.value_or("transmission_color", 1.0));
        }
        return same;
    }
    values::nearest_principled(spec, document.scene, "glTF", writing)
}
