//! Parts that earlier builds of a scene leave for the next one.

use crate::geometry::{TreeWork, Trees};
use crate::kept::{Kept, MeshPool, SpecKey};
use crate::lights::{self, BuiltLight};
use crate::materials::{self, Material, MaterialInputs};
use crate::messages::error::SceneError;
use crate::parameters::Spec;
use crate::scene::{MeshLights, Top};
use crate::texture::Texture;
use std::sync::Arc;

/// Trees, materials, lights and their tables, each with what it was made from, so that
/// [`SceneBuilder::build_with`](crate::SceneBuilder::build_with) does not make it again. After a build it holds what
/// that build used, and nothing else.
///
/// The scenes that come out of it are those of [`SceneBuilder::build`](crate::SceneBuilder::build), bit for bit. What
/// is shared by an [`Arc`] (meshes, textures) is recognised by its address; equal meshes are found to be equal.
#[derive(Clone, Default)]
pub struct BuiltParts {
    pub(super) meshes: MeshPool,
    materials: Kept<SpecKey, Arc<dyn Material>>,
    lights: Kept<SpecKey, BuiltLight>,
    pub(super) trees: Trees,
    pub(super) mesh_lights: MeshLights,
    pub(super) top: Top,
}

impl BuiltParts {
    /// The trees that were built so far, all builds together.
    pub fn tree_work(&self) -> TreeWork {
        self.trees.work()
    }

    /// The number of parts that are kept: meshes, trees, materials and lights.
    pub fn len(&self) -> usize {
        self.meshes.len()
            + self.trees.len()
            + self.materials.len()
            + self.lights.len()
            + self.mesh_lights.0.len()
    }

    /// True before the first build.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Forgets all parts.
    pub fn clear(&mut self) {
        let mut trees = std::mem::take(&mut self.trees);
        trees.clear();
        *self = BuiltParts { trees, ..BuiltParts::default() };
    }

    pub(super) fn begin(&mut self) {
        self.materials.begin();
        self.lights.begin();
        self.trees.begin();
        self.mesh_lights.0.begin();
    }

    pub(super) fn end(&mut self, succeeded: bool) {
        self.meshes.end(succeeded);
        self.materials.end(succeeded);
        self.lights.end(succeeded);
        self.trees.end(succeeded);
        self.mesh_lights.0.end(succeeded);
    }

    pub(super) fn material(
        &mut self,
        spec: &Spec,
        inputs: &MaterialInputs,
    ) -> Result<Arc<dyn Material>, SceneError> {
        match SpecKey::of(spec, inputs.textures, inputs.materials) {
            Some(key) => self.materials.or_make(key, || materials::build(spec, inputs)),
            None => materials::build(spec, inputs),
        }
    }

    pub(super) fn light(&mut self, spec: &Spec, textures: &[Arc<Texture>]) -> Result<BuiltLight, SceneError> {
        match SpecKey::of(spec, textures, &[]) {
            Some(key) => self.lights.or_make(key, || lights::build(spec, textures)),
            None => lights::build(spec, textures),
        }
    }
}
