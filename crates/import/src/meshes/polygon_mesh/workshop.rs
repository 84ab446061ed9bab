//! Budget, diagnostics and options for reading meshes.

use crate::bytes::budget::Budget;
use crate::input::diagnostics::Diagnostics;

/// Budget, diagnostics and crease angle that a reader of meshes needs besides the mesh.
pub struct Workshop<'r> {
    pub budget: &'r mut Budget,
    pub diagnostics: &'r mut Diagnostics,
    /// Faces that meet at a smaller angle are smooth, in degrees.
    pub crease_angle: f32,
}
