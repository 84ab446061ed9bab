//! Objects placed in the scene.

use crate::mesh::Mesh;
use bilux_math::motion::Motion;
use std::sync::Arc;

/// An object placed in the scene, the input of [`crate::geometry::Geometry::build`].
pub struct Placed {
    /// Its triangles, in object space.
    pub mesh: Arc<Mesh>,
    /// Index of its material.
    pub material: u32,
    /// Its position and motion.
    pub motion: Motion,
    /// Whether it keeps a tree of its own.
    pub instanced: bool,
    /// Whether its material emits light.
    pub gives_light: bool,
    /// Whether its material needs tangents.
    pub has_tangents: bool,
    /// Whether it has filtered textures.
    pub is_filtered: bool,
}

impl Placed {
    /// True for an object outside of the common tree.
    pub(crate) fn in_own_tree(&self) -> bool {
        self.instanced || !self.motion.is_still()
    }
}
