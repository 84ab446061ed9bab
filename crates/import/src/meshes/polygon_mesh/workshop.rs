//! Budget, oddities and options for reading meshes.

use crate::bytes::budget::Budget;
use crate::input::oddities::Oddities;

/// Budget, oddities and crease angle that a reader of meshes needs besides the mesh.
pub struct Workshop<'r> {
    pub budget: &'r mut Budget,
    pub oddities: &'r mut Oddities,
    /// Faces that meet at a smaller angle are smooth, in degrees.
    pub crease_angle: f32,
}
