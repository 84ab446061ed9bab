//! Merges one scene into another.

use super::reader::Native;
use bilux_scene::{SceneBuilder, Spec, Value};

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
