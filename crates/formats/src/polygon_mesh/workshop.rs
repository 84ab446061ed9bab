//! What reading meshes needs besides the meshes.

use crate::budget::Budget;
use crate::oddities::Oddities;

/// What a reader of meshes needs besides the mesh.
pub(crate) struct Workshop<'r> {
    pub(crate) budget: &'r mut Budget,
    pub(crate) oddities: &'r mut Oddities,
    /// Faces that meet at a smaller angle are smooth, in degrees.
    pub(crate) crease_angle: f32,
}
