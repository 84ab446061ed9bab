//! Objects with their places.

use crate::mesh::Mesh;
use bilux_math::motion::Motion;
use std::sync::Arc;

/// An object with its place, as [`crate::geometry::Geometry::build`] takes it.
pub struct Placed {
    /// Its triangles, in their own space.
    pub mesh: Arc<Mesh>,
    /// Index of its material.
    pub material: u32,
    /// Where it is, and when.
    pub motion: Motion,
    /// Keep a tree of its own.
    pub instanced: bool,
    /// Its material gives light.
    pub gives_light: bool,
    /// Its material asks for tangents.
    pub has_tangents: bool,
    /// It has textures that are filtered.
    pub is_filtered: bool,
}

impl Placed {
    /// True for what does not stand in the common tree.
    pub(crate) fn in_own_tree(&self) -> bool {
        self.instanced || !self.motion.is_still()
    }
}
