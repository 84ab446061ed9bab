//! What reading meshes needs besides the meshes.

use crate::budget::Budget;
use crate::oddities::Oddities;

/// What a reader of meshes needs besides the mesh.
pub(in crate::fbx) struct Workshop<'r> {
    pub(in crate::fbx) budget: &'r mut Budget,
    pub(in crate::fbx) oddities: &'r mut Oddities,
    /// Faces that meet at a smaller angle are smooth, in degrees.
    pub(in crate::fbx) crease_angle: f32,
}
