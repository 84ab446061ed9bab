//! Building: a binary tree by the surface-area heuristic, from it the wide one of least cost, from that the units.

pub(super) mod binary;
mod collapse;
mod emit;
mod item;
mod reinsert;
mod spatial;
mod split;

use super::layout::{BLOCK_UNITS, EMPTY, LANES, MAX_UNITS, Planes, Ref, Unit};
use crate::mesh::TriangleMesh;
use crate::registry::{BuildError, Quality};
use binary::Binary;
use item::Bounds;
use spatial::Cutter;

/// A tree in its final form.
pub(super) struct Built {
    pub(super) units: Vec<Unit>,
    pub(super) root: Ref,
    pub(super) planes: Planes,
}

/// Builds a tree over the triangles that are finite. The same tree whatever the number of threads.
pub(super) fn build(mesh: &TriangleMesh, quality: Quality) -> Result<Built, BuildError> {
    let mut items = item::items_of(mesh);
    if items.is_empty() {
        return Ok(Built { units: Vec::new(), root: Ref::EMPTY, planes: EMPTY });
    }
    // More than can be numbered in the end, whatever the tree.
    if items.len() > MAX_UNITS / BLOCK_UNITS * LANES {
        return Err(BuildError::TooManyNodes);
    }
    let binary = if quality == Quality::Best {
        let cutter = Cutter::new(mesh.triangles(), &Bounds::of(&items));
        // Cuts may make them twice as many; few scenes come halfway.
        let room = items.len();
        reinsert::improve(Binary::over(&mut items, Some((&cutter, room))))
    } else {
        Binary::over(&mut items, None)
    };
    let (units, root) = emit::emit(&binary, &items, mesh)?;
    Ok(Built { units, root, planes: binary.root.planes() })
}
