//! Merges one scene into another.

use super::scene::Native;
use crate::FormatError;
use crate::bake::transformed;
use bilux_math::Motion;
use bilux_scene::{Object, SceneBuilder, SceneError, Span, Spec, Value};
use std::sync::Arc;

impl Native<'_, '_> {
    /// Adds the textures and materials of a scene; returns the new index of its first material.
    pub(super) fn add_materials_of(&mut self, model: &SceneBuilder) -> usize {
        let first = self.scene.materials.len();
        for spec in &model.materials {
            let spec = self.moved(spec, first);
            self.scene.materials.push(spec);
        }
        self.scene.textures.extend(model.textures.iter().cloned());
        first
    }

    /// A spec of a scene whose textures follow those of this scene, and whose materials begin at `first`.
    pub(super) fn moved(&self, spec: &Spec, first: usize) -> Spec {
        let mut spec = spec.clone();
        for (_, value, _) in &mut spec.parameters.0 {
            match value {
                Value::Texture(index) => *index += self.scene.textures.len(),
                Value::Material(index) => *index += first,
                _ => {}
            }
        }
        spec
    }
}

/// An object transformed by the motion of its model.
pub(super) fn moved(object: &Object, by: &Motion, at: &Span) -> Result<Object, FormatError> {
    let is_unmoved = |motion: &Motion| motion.is_still() && motion.at(0.0).is_identity();
    let object = object.clone();
    if is_unmoved(by) {
        return Ok(object);
    }
    if is_unmoved(&object.motion) {
        return Ok(Object { motion: by.clone(), ..object });
    }
    match (object.motion.is_still(), by.is_still()) {
        (true, true) => {
            let motion = Motion::still(object.motion.at(0.0).then(&by.at(0.0)));
            Ok(Object { motion, ..object })
        }
        (true, false) => {
            let mesh = Arc::new(transformed(&object.mesh, &object.motion.at(0.0)));
            Ok(Object { mesh, motion: by.clone(), ..object })
        }
        _ => {
            let name = &object.name;
            let message = format!(
                "'{name}' in this model is animated, so the model cannot be placed as well: remove its \
                         transform"
            );
            Err(SceneError::invalid(message, at).into())
        }
    }
}
