//! Top-down building. No step depends on the number of threads.

use super::clip::{Planes, Reference, clipped_bounds};
use super::split::{Split, best_split};
use super::tree::{KdNode, MAX_DEPTH, MAX_NODES, Tree};
use crate::mesh::TriangleMesh;
use crate::registry::BuildError;
use bilux_math::parallel::{join, map, ranges};
use std::ops::Range;

/// Maximum number of references over all leaves, per triangle.
const MAX_REFERENCES_EACH: usize = 6;
/// Below this many references a subtree is built on one thread.
const PARALLEL: usize = 8192;

/// A tree over a mesh's finite triangles. Its references are indices of the mesh's triangles.
pub(super) fn build(mesh: &TriangleMesh) -> Result<Tree, BuildError> {
    let bounds = mesh.bounds();
    let reference = |index: usize| {
        let index = index as u32;
        let bounds = mesh.triangle_bounds(index);
        let planes = [bounds.min.to_array(), bounds.max.to_array()];
        (!bounds.is_empty()).then_some(Reference { planes, index })
    };
    let of = |some: Range<usize>| some.filter_map(reference).collect::<Vec<_>>();
    let references = map(ranges(mesh.len(), PARALLEL), of).concat();
    if references.is_empty() {
        return Ok(Tree::default());
    }
    let count = references.len();
    // [Havran 2000]'s rule for the depth of the tree, with some reserve.
    let max_depth = (12 + 2 * (count.ilog2() as usize)).min(MAX_DEPTH);
    let builder = Builder { triangles: mesh.triangles(), max_depth };
    let task = Task {
        references,
        cell: [bounds.min.to_array(), bounds.max.to_array()],
        depth: 1,
        spare: count.saturating_mul(MAX_REFERENCES_EACH - 1),
    };
    let mut tree = Tree::default();
    builder.grow(task, &mut tree);
    // Leaves without references count too, so both are checked.
    if tree.nodes.len() > MAX_NODES || tree.references.len() > MAX_NODES {
        return Err(BuildError::TooManyNodes);
    }
    tree.nodes.shrink_to_fit();
    tree.references.shrink_to_fit();
    Ok(tree)
}

struct Builder<'a> {
    triangles: &'a [[[f32; 3]; 3]],
    max_depth: usize,
}

/// A cell that is still to be built.
struct Task {
    references: Vec<Reference>,
    cell: Planes,
    depth: usize,
    /// Maximum number of additional references that may be created below.
    spare: usize,
}

impl Builder<'_> {
    /// Appends the subtree of a cell to a tree.
    fn grow(&self, task: Task, tree: &mut Tree) {
        let Some((split, [below, above])) = self.part(&task) else {
            tree.nodes.push(KdNode::leaf(tree.references.len(), task.references.len()));
            tree.references.extend(task.references.iter().map(|reference| reference.index));
            return;
        };
        drop(task);
        let node = tree.nodes.len();
        tree.nodes.push(KdNode::inner(split.axis, split.plane, 0));
        if below.references.len() + above.references.len() < PARALLEL {
            self.grow(below, tree);
            tree.nodes[node] = KdNode::inner(split.axis, split.plane, tree.nodes.len());
            self.grow(above, tree);
        } else {
            let alone = |task: Task| {
                let mut tree = Tree::default();
                self.grow(task, &mut tree);
                tree
            };
            let (below, above) = join(|| alone(below), || alone(above));
            append(tree, below);
            tree.nodes[node] = KdNode::inner(split.axis, split.plane, tree.nodes.len());
            append(tree, above);
        }
    }

    /// The tasks below and above the best plane; `None` if this becomes a leaf.
    fn part(&self, task: &Task) -> Option<(Split, [Task; 2])> {
        if task.depth >= self.max_depth || task.references.len() <= 1 {
            return None;
        }
        let split = best_split(&task.references, &task.cell, task.spare)?;
        let (mut low, mut high) = (task.cell, task.cell);
        (low[1][split.axis], high[0][split.axis]) = (split.plane, split.plane);
        let [below, above] = self.distribute(&task.references, &split);
        let made = below.len() + above.len();
        // Bins only estimate, so the actual numbers are checked.
        let stands_still = below.len() >= task.references.len() && above.len() >= task.references.len();
        if stands_still || made > task.references.len() + task.spare {
            return None;
        }
        let spare = task.spare + task.references.len() - made;
        let share = |references: &[Reference]| {
            (spare as u128 * references.len() as u128 / made.max(1) as u128) as usize
        };
        let depth = task.depth + 1;
        let below = Task { spare: share(&below), references: below, cell: low, depth };
        let above = Task { spare: share(&above), references: above, cell: high, depth };
        Some((split, [below, above]))
    }

    /// References below and above a plane, those on both sides clipped.
    fn distribute(&self, references: &[Reference], split: &Split) -> [Vec<Reference>; 2] {
        let of = |references: &[Reference]| {
            let (mut below, mut above) = (Vec::new(), Vec::new());
            for reference in references {
                let [low, high] = [reference.planes[0][split.axis], reference.planes[1][split.axis]];
                let in_plane = low == split.plane && high == split.plane;
                if high < split.plane || in_plane && split.planar_below || !in_plane && high == split.plane {
                    below.push(*reference);
                } else if low >= split.plane {
                    above.push(*reference);
                } else {
                    let [part_below, part_above] = self.cut(reference, split);
                    below.extend(part_below);
                    above.extend(part_above);
                }
            }
            [below, above]
        };
        if references.len() < PARALLEL * 4 {
            return of(references);
        }
        let parts = map(references.chunks(PARALLEL), of);
        let all = |side: usize| parts.iter().flat_map(|part| &part[side]).copied().collect();
        [all(0), all(1)]
    }

    /// The parts of a triangle on both sides of a plane that its box straddles.
    fn cut(&self, reference: &Reference, split: &Split) -> [Option<Reference>; 2] {
        let (mut low, mut high) = (reference.planes, reference.planes);
        (low[1][split.axis], high[0][split.axis]) = (split.plane, split.plane);
        [low, high].map(|region| {
            let planes = clipped_bounds(&self.triangles[reference.index as usize], &region)?;
            Some(Reference { planes, ..*reference })
        })
    }
}

/// Appends a tree to another.
fn append(tree: &mut Tree, other: Tree) {
    let (nodes, references) = (tree.nodes.len(), tree.references.len());
    tree.nodes.extend(other.nodes.into_iter().map(|node| node.behind(nodes, references)));
    tree.references.extend(other.references);
}
