//! Building: a binary tree, from it the wide tree of lowest cost, from that the units. The binary tree comes from a
//! space-filling curve (fast), from the surface-area heuristic (balanced), or from the latter with triangles cut and
//! subtrees reinserted afterwards (best). `docs/adr/0009-builders.md` records what was tried.

pub(super) mod binary;
mod collapse;
mod costs;
mod emit;
mod item;
mod morton;
mod reinsert;
mod spatial;
mod split;

use super::layout::{BLOCK_UNITS, EMPTY, LANES, MAX_UNITS, NO_TRIANGLE, Planes, Ref, Unit};
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

/// Builds a tree over the finite triangles. The tree is the same whatever the number of threads.
pub(super) fn build(mesh: &TriangleMesh, quality: Quality) -> Result<Built, BuildError> {
    let mut items = item::items_of(mesh);
    if items.is_empty() {
        return Ok(Built { units: Vec::new(), root: Ref::EMPTY, planes: EMPTY });
    }
    // More than can be numbered in the end, whatever the tree.
    if items.len() > MAX_UNITS / BLOCK_UNITS * LANES || mesh.len() > NO_TRIANGLE as usize / 2 {
        return Err(BuildError::TooManyNodes);
    }
    let binary = match quality {
        Quality::Fast => morton::along_a_curve(&mut items),
        Quality::Balanced => Binary::over(&mut items, None),
        Quality::Best => {
            let cutter = Cutter::new(mesh.triangles(), &Bounds::of(&items));
            // Cuts may double the number of items; few scenes come halfway.
            let spare = items.len();
            reinsert::improve(Binary::over(&mut items, Some((&cutter, spare))))
        }
    };
    let (units, root) = emit::emit(&binary, &items, mesh)?;
    Ok(Built { units, root, planes: binary.root.planes() })
}
