//! Trees over single objects in world space, and how trees of triangles are built.

use crate::geometry::accel_choice::AccelChoice;
use crate::kept::{Kept, Place, Same};
use crate::mesh::Mesh;
use crate::messages::error::SceneError;
use crate::parameters::Span;
use bilux_accel::{Accelerator, TriangleMesh};
use std::sync::Arc;

/// A mesh, and where it stands.
pub(super) type StillKey = (Same<Mesh>, Place);

/// The trees of single objects, kept from one build to the next.
#[derive(Clone, Default)]
pub(super) struct ObjectTrees {
    pub(super) kept: Kept<StillKey, Arc<dyn Accelerator>>,
    pub(super) work: TreeWork,
}

/// Numbers of trees that were built, and of triangles in them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TreeWork {
    /// Trees, whatever they hold.
    pub trees: u64,
    /// The triangles in them.
    pub triangles: u64,
}

/// Builds a tree of triangles.
pub(super) fn tree(
    mesh: Arc<TriangleMesh>,
    accel: &AccelChoice,
    work: &mut TreeWork,
) -> Result<Arc<dyn Accelerator>, SceneError> {
    work.trees += 1;
    work.triangles += mesh.len() as u64;
    Ok(Arc::from(bilux_accel::build(&accel.name, mesh, &accel.options).map_err(|e| failed(&e))?))
}

pub(super) fn failed(error: &dyn std::fmt::Display) -> SceneError {
    SceneError::invalid(error.to_string(), &Span::default())
}
