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

fn leaf_units(triangles: usize) -> usize {
    triangles.div_ceil(LANES) * BLOCK_UNITS
}

/// The tree in its final form, and the root.
pub(super) fn emit(
    binary: &Binary,
    items: &[Item],
    mesh: &TriangleMesh,
) -> Result<(Vec<Unit>, Ref), BuildError> {
    let writer = Writer { binary, items, triangles: mesh.triangles() };
    let plan = writer.plan(&binary.root);
    if plan.units > MAX_UNITS {
        return Err(BuildError::TooManyNodes);
    }
    let mut units = vec![Unit::default(); plan.units];
    let (_, root) = writer.write(&binary.root, &plan, &mut units, 0);
    Ok((units, root))
}

struct Writer<'a> {
    binary: &'a Binary,
    items: &'a [Item],
    triangles: &'a [[[f32; 3]; 3]],
}

/// Room that is used again and again.
#[derive(Default)]
struct Scratch {
    children: Vec<Node>,
    primitives: Vec<u32>,
}

impl Writer<'_> {
    fn plan(&self, node: &Node) -> Plan {
        if node.count() < PARALLEL {
            return Plan { units: self.measure(node, &mut Scratch::default()), parts: Vec::new() };
        }
        let mut children = Vec::new();
        children_of(self.binary, node, &mut children);
        let parts: Vec<Plan> = children.par_iter().map(|child| self.plan(child)).collect();
        Plan { units: NODE_UNITS + parts.iter().map(|part| part.units).sum::<usize>(), parts }
    }

    fn measure(&self, node: &Node, scratch: &mut Scratch) -> usize {
        children_of(self.binary, node, &mut scratch.children);
        if scratch.children.is_empty() {
            return leaf_units(self.triangles_below(node, &mut scratch.primitives));
        }
        let mut below = [*node; WIDTH];
        let count = scratch.children.len();
        below[..count].copy_from_slice(&scratch.children);
        NODE_UNITS + below[..count].iter().map(|child| self.measure(child, scratch)).sum::<usize>()
    }

    /// How many triangles a leaf made of a binary subtree has, and which; each once, whatever pieces there are.
    fn triangles_below(&self, node: &Node, primitives: &mut Vec<u32>) -> usize {
        primitives.clear();
        self.collect(node, primitives);
        if self.binary.has_pieces {
            primitives.sort_unstable();
            primitives.dedup();
        }
        primitives.len()
    }

    fn collect(&self, node: &Node, primitives: &mut Vec<u32>) {
        if node.is_leaf() {
            primitives.extend(self.items[node.items()].iter().map(Item::index));
        } else {
            self.binary.children(node).iter().for_each(|child| self.collect(child, primitives));
        }
    }

    /// Writes a wide subtree into the whole of `units`, the first of which has the number `at`.
    fn write(&self, node: &Node, plan: &Plan, units: &mut [Unit], at: usize) -> (Planes, Ref) {
        if plan.parts.is_empty() {
            return self.write_small(node, units, at, &mut Scratch::default()).0;
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
        scratch: &mut Scratch,
    ) -> ((Planes, Ref), usize) {
        children_of(self.binary, node, &mut scratch.children);
        if scratch.children.is_empty() {
            let size = leaf_units(self.triangles_below(node, &mut scratch.primitives));
            let triangles = scratch.primitives.iter().map(|&index| (self.triangles[index as usize], index));
            write_leaf(&mut units[..size], triangles);
            return ((node.planes(), Ref::leaf(at, size / BLOCK_UNITS)), size);
        }
        let mut below = [*node; WIDTH];
        let count = scratch.children.len();
        below[..count].copy_from_slice(&scratch.children);
        let mut written = [(node.planes(), Ref::EMPTY); WIDTH];
        let mut end = NODE_UNITS;
        for (child, written) in below[..count].iter().zip(&mut written) {
            let (entry, size) = self.write_small(child, &mut units[end..], at + end, scratch);
            *written = entry;
            end += size;
        }
        write_node(&mut units[..NODE_UNITS], &written[..count]);
        ((node.planes(), Ref::node(at)), end)
    }
}
