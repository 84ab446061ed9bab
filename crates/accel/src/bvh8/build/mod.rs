//! Building: a binary tree by the surface-area heuristic, from it the wide one of least cost, from that the units.

pub(super) mod binary;
mod collapse;
mod emit;
mod item;
mod split;

use super::layout::{EMPTY, Planes, Ref, Unit};
use crate::mesh::TriangleMesh;
use crate::registry::BuildError;
use binary::Binary;

/// A tree in its final form.
pub(super) struct Built {
    pub(super) units: Vec<Unit>,
    pub(super) root: Ref,
    pub(super) planes: Planes,
}

/// Builds a tree over the triangles that are finite. The same tree whatever the number of threads.
pub(super) fn build(mesh: &TriangleMesh) -> Result<Built, BuildError> {
    let mut items = item::items_of(mesh);
    if items.is_empty() {
        return Ok(Built { units: Vec::new(), root: Ref::EMPTY, planes: EMPTY });
    }
    let binary = Binary::over(&mut items);
    let (units, root) = emit::emit(&binary, &items, mesh)?;
    Ok(Built { units, root, planes: binary.root.planes() })
}
