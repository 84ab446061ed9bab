//! What reading meshes needs besides the meshes.

use crate::bytes::budget::Budget;
use crate::input::oddities::Oddities;

/// What a reader of meshes needs besides the mesh.
pub struct Workshop<'r> {
    pub budget: &'r mut Budget,
    pub oddities: &'r mut Oddities,
    /// Faces that meet at a smaller angle are smooth, in degrees.
    pub crease_angle: f32,
}
