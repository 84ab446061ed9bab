//! Writes the wide tree, each subtree to its own stretch of memory, so that threads do not meet.

use super::binary::{Binary, Node};
use super::collapse::children_of;
use super::item::Item;
use crate::bvh8::layout::{
    BLOCK_UNITS, LANES, MAX_UNITS, NODE_UNITS, Planes, Ref, Unit, WIDTH, write_leaf, write_node,
};
use crate::mesh::TriangleMesh;
use crate::registry::BuildError;
use rayon::prelude::*;

/// From this many items on, a subtree is measured and written by many threads.
const PARALLEL: usize = 1 << 14;

/// How many units a wide subtree takes; of large ones, its parts too.
struct Plan {
    units: usize,
    parts: Vec<Plan>,
}

fn plan(binary: &Binary, node: &Node) -> Plan {
    if node.count() < PARALLEL {
        return Plan { units: measure(binary, node, &mut Vec::new()), parts: Vec::new() };
    }
    let mut children = Vec::new();
    children_of(binary, node, &mut children);
    let parts: Vec<Plan> = children.par_iter().map(|child| plan(binary, child)).collect();
    Plan { units: NODE_UNITS + parts.iter().map(|part| part.units).sum::<usize>(), parts }
}

fn leaf_units(node: &Node) -> usize {
    node.count().div_ceil(LANES) * BLOCK_UNITS
}

fn measure(binary: &Binary, node: &Node, children: &mut Vec<Node>) -> usize {
    children_of(binary, node, children);
    if children.is_empty() {
        return leaf_units(node);
    }
    let mut below = [*node; WIDTH];
    let count = children.len();
    below[..count].copy_from_slice(children);
    NODE_UNITS + below[..count].iter().map(|child| measure(binary, child, children)).sum::<usize>()
}

/// The tree in its final form, and the root.
pub(super) fn emit(
    binary: &Binary,
    items: &[Item],
    mesh: &TriangleMesh,
) -> Result<(Vec<Unit>, Ref), BuildError> {
    let plan = plan(binary, &binary.root);
    if plan.units > MAX_UNITS {
        return Err(BuildError::TooManyNodes);
    }
    let mut units = vec![Unit::default(); plan.units];
    let writer = Writer { binary, items, triangles: mesh.triangles() };
    let (_, root) = writer.write(&binary.root, &plan, &mut units, 0);
    Ok((units, root))
}

struct Writer<'a> {
    binary: &'a Binary,
    items: &'a [Item],
    triangles: &'a [[[f32; 3]; 3]],
}

impl Writer<'_> {
    /// Writes a wide subtree into the whole of `units`, the first of which has the number `at`.
    fn write(&self, node: &Node, plan: &Plan, units: &mut [Unit], at: usize) -> (Planes, Ref) {
        if plan.parts.is_empty() {
            return self.write_small(node, units, at, &mut Vec::new()).0;
        }
        let mut children = Vec::new();
        children_of(self.binary, node, &mut children);
        let (own, mut rest) = units.split_at_mut(NODE_UNITS);
        let mut at_child = at + NODE_UNITS;
        let mut tasks = Vec::new();
        for (child, part) in children.iter().zip(&plan.parts) {
            let (stretch, behind) = rest.split_at_mut(part.units);
            tasks.push((child, part, stretch, at_child));
            (rest, at_child) = (behind, at_child + part.units);
        }
        let written: Vec<_> = tasks
            .into_par_iter()
            .map(|(child, part, units, at)| self.write(child, part, units, at))
            .collect();
        write_node(own, &written);
        (node.planes(), Ref::node(at))
    }

    /// Writes a wide subtree to the front of `units` and says how many it took.
    fn write_small(
        &self,
        node: &Node,
        units: &mut [Unit],
        at: usize,
        children: &mut Vec<Node>,
    ) -> ((Planes, Ref), usize) {
        children_of(self.binary, node, children);
        if children.is_empty() {
            let size = leaf_units(node);
            let indices = self.items[node.items()].iter().map(Item::index);
            let triangles = indices.map(|index| (self.triangles[index as usize], index));
            write_leaf(&mut units[..size], triangles);
            return ((node.planes(), Ref::leaf(at, size / BLOCK_UNITS)), size);
        }
        let mut below = [*node; WIDTH];
        let count = children.len();
        below[..count].copy_from_slice(children);
        let mut written = [(node.planes(), Ref::EMPTY); WIDTH];
        let mut end = NODE_UNITS;
        for (child, written) in below[..count].iter().zip(&mut written) {
            let (entry, size) = self.write_small(child, &mut units[end..], at + end, children);
            *written = entry;
            end += size;
        }
        write_node(&mut units[..NODE_UNITS], &written[..count]);
        ((node.planes(), Ref::node(at)), end)
    }
}
