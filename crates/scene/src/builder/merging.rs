//! Scenes put together.

use super::{Object, SceneBuilder};
use crate::parameters::{Spec, Value};
use bilux_math::Motion;
use std::sync::Arc;

impl SceneBuilder {
    /// Adds the objects of another scene, moved by `place`, with their materials and textures; those that this scene has already
    /// are not added again. Returns the index of the first object.
    pub fn add_objects_of(&mut self, other: &SceneBuilder, place: &Motion) -> usize {
        let textures = self.textures_of(other);
        let materials = self.materials_of(other, &textures);
        let first = self.objects.len();
        let moved = |object: &Object| Object {
            motion: object.motion.then(place),
            material: materials.get(object.material).copied().unwrap_or(object.material),
            ..object.clone()
        };
        self.objects.extend(other.objects.iter().map(moved));
        first
    }

    /// The index here of each material of another scene, whose textures have these indices here.
    fn materials_of(&mut self, other: &SceneBuilder, textures: &[usize]) -> Vec<usize> {
        let names_others =
            |spec: &Spec| spec.parameters.0.iter().any(|(_, value, _)| matches!(value, Value::Material(_)));
        let first = self.materials.len();
        if other.materials.iter().any(names_others) {
            let all: Vec<usize> = (first..first + other.materials.len()).collect();
            self.materials.extend(other.materials.iter().map(|spec| renumbered(spec, textures, &all)));
            return all;
        }
        let mut index = |spec: &Spec| {
            let spec = renumbered(spec, textures, &[]);
            let known = self.materials[..first].iter().position(|known| *known == spec);
            known.unwrap_or_else(|| self.add_material(spec))
        };
        other.materials.iter().map(&mut index).collect()
    }

    /// Adds the lights of another scene, as they are there.
    pub fn add_lights_of(&mut self, other: &SceneBuilder) {
        let textures = self.textures_of(other);
        self.lights.extend(other.lights.iter().map(|light| renumbered(light, &textures, &[])));
    }

    /// The index here of each texture of another scene.
    fn textures_of(&mut self, other: &SceneBuilder) -> Vec<usize> {
        let mut index = |texture: &Arc<_>| {
            let known = self.textures.iter().position(|known| Arc::ptr_eq(known, texture));
            known.unwrap_or_else(|| {
                self.textures.push(texture.clone());
                self.textures.len() - 1
            })
        };
        other.textures.iter().map(&mut index).collect()
    }
}

/// A spec with other indices of textures and materials.
fn renumbered(spec: &Spec, textures: &[usize], materials: &[usize]) -> Spec {
    let mut spec = spec.clone();
    for (_, value, _) in &mut spec.parameters.0 {
        match value {
            Value::Texture(index) => *index = textures.get(*index).copied().unwrap_or(*index),
            Value::Material(index) => *index = materials.get(*index).copied().unwrap_or(*index),
            _ => {}
        }
    }
    spec
}
