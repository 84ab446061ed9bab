//! Converts materials of any kind to `principled`, the only one that glTF can represent.

use super::Document;
use crate::values::{self, number};
use crate::writing::Writing;
use bilux_scene::materials::with_indices;
use bilux_scene::{Spec, Value};

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
    let spec = &*with_indices(spec);
    if let Some(principled) = values::as_principled(spec, "glTF", writing) {
        return principled;
    }
    let first = spec.parameters.find("a").and_then(|(value, _)| match value {
        Value::Material(index) => document.scene.materials.get(*index),
        _ => None,
    });
    let instead = if first.is_some() { "its first part is" } else { "a plain one with its name is" };
    writing.warn(format!("glTF files cannot store the material '{}': {instead} written instead", spec.kind));
    match first.filter(|first| first.kind != "mix") {
        Some(first) => Spec { name: spec.name.clone(), ..as_principled(first, document, writing) },
        None => Spec::new(&spec.name, "principled"),
    }
}
