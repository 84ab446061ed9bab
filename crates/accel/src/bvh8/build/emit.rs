//! Writes the wide tree, each subtree to its own range of memory, so that threads do not interfere.

use super::binary::{Binary, BinaryNode};
use super::collapse::children_of;
use super::item::Item;
use crate::bvh8::layout::{
    BLOCK_UNITS, LANES, MAX_UNITS, NODE_UNITS, Planes, Ref, Unit, WIDTH, write_leaf, write_node,
};
use crate::mesh::TriangleMesh;
use crate::registry::BuildError;
use bilux_math::parallel::{map, table};

/// From this many items on, a subtree is measured and written by many threads.
const PARALLEL: usize = 1 << 14;

/// Size of a wide subtree in units. For a large one, also its children and their plans; for others, the number of
/// children of each node in the order of writing (0 for a leaf), and all children.
struct Plan {
    units: usize,
    parts: Vec<(BinaryNode, Plan)>,
    counts: Vec<u8>,
    children: Vec<u32>,
}

fn leaf_units(triangles: usize) -> usize {
    triangles.div_ceil(LANES) * BLOCK_UNITS
}

/// Writes the tree in its final form, and returns it with its root.
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
    // On all threads, because the first touch of memory is the expensive one.
    let mut units = table(plan.units, PARALLEL, |_| Unit::default());
    let (_, root) = writer.write(&binary.root, &plan, &mut units, 0);
    Ok((units, root))
}

struct Writer<'a> {
    binary: &'a Binary,
    items: &'a [Item],
    triangles: &'a [[[f32; 3]; 3]],
}

impl Writer<'_> {
    fn plan(&self, node: &BinaryNode) -> Plan {
        let mut plan = Plan { units: 0, parts: Vec::new(), counts: Vec::new(), children: Vec::new() };
        let mut children = Vec::new();
        if node.count() < PARALLEL {
            plan.units = self.measure(node, &mut plan, &mut children);
            return plan;
        }
        children_of(self.binary, node, &mut children);
        let part = |&child: &u32| {
            let child = self.binary.node(child);
            (child, self.plan(&child))
        };
        plan.parts = map(&children, part);
        plan.units = NODE_UNITS + plan.parts.iter().map(|(_, part)| part.units).sum::<usize>();
        plan
    }

    fn measure(&self, node: &BinaryNode, plan: &mut Plan, scratch: &mut Vec<u32>) -> usize {
        children_of(self.binary, node, scratch);
        plan.counts.push(scratch.len() as u8);
        if scratch.is_empty() {
            let count = if self.binary.in_order { node.count() } else { self.triangles_below(node, scratch) };
            return leaf_units(count);
        }
        let first = plan.children.len();
        plan.children.extend_from_slice(scratch);
        let below = first..plan.children.len();
        NODE_UNITS
            + below.map(|k| self.measure(&self.binary.node(plan.children[k]), plan, scratch)).sum::<usize>()
    }

    /// The number of triangles of a leaf made from a binary subtree, and which they are, in ascending order; each
    /// once, however many pieces it was cut into.
    fn triangles_below(&self, node: &BinaryNode, primitives: &mut Vec<u32>) -> usize {
        primitives.clear();
        self.collect(node, primitives);
        primitives.sort_unstable();
        if self.binary.has_pieces {
            primitives.dedup();
        }
        primitives.len()
    }

    fn collect(&self, node: &BinaryNode, primitives: &mut Vec<u32>) {
        if self.binary.in_order || node.is_leaf() {
            primitives.extend(self.items[node.items()].iter().map(Item::index));
        } else {
            self.binary.children(node).iter().for_each(|child| self.collect(child, primitives));
        }
    }

    /// Writes a wide subtree into all of `units`, whose first unit has the number `at`.
    fn write(&self, node: &BinaryNode, plan: &Plan, units: &mut [Unit], at: usize) -> (Planes, Ref) {
        if plan.parts.is_empty() {
            let mut writing =
                Writing { counts: plan.counts.iter(), children: &plan.children, scratch: Vec::new() };
            return self.write_small(node, &mut writing, units, at).0;
        }
        let (own, mut rest) = units.split_at_mut(NODE_UNITS);
        let mut at_child = at + NODE_UNITS;
        let mut tasks = Vec::new();
        for (child, part) in &plan.parts {
            let (stretch, behind) = rest.split_at_mut(part.units);
            tasks.push((child, part, stretch, at_child));
            (rest, at_child) = (behind, at_child + part.units);
        }
        let written = map(tasks, |(child, part, units, at)| self.write(child, part, units, at));
        write_node(own, &written);
        (node.planes(), Ref::node(at))
    }

    /// Writes a wide subtree to the front of `units` and returns how many units it took.
    fn write_small(
        &self,
        node: &BinaryNode,
        writing: &mut Writing<'_>,
        units: &mut [Unit],
        at: usize,
    ) -> ((Planes, Ref), usize) {
        let count = writing.counts.next().map_or(0, |&count| usize::from(count));
        if count == 0 {
            let primitives = &mut writing.scratch;
            let size = leaf_units(self.triangles_below(node, primitives));
            let triangles = primitives.iter().map(|&index| (self.triangles[index as usize], index));
            write_leaf(&mut units[..size], triangles);
            return ((node.planes(), Ref::leaf(at, size / BLOCK_UNITS)), size);
        }
        let (below, rest) = writing.children.split_at(count);
        writing.children = rest;
        let mut written = [(node.planes(), Ref::EMPTY); WIDTH];
        let mut end = NODE_UNITS;
        for (&child, written) in below.iter().zip(&mut written) {
            let child = self.binary.node(child);
            let (entry, size) = self.write_small(&child, writing, &mut units[end..], at + end);
            *written = entry;
            end += size;
        }
        write_node(&mut units[..NODE_UNITS], &written[..count]);
        ((node.planes(), Ref::node(at)), end)
    }
}

/// The rest of a plan, not yet written.
struct Writing<'a> {
    counts: std::slice::Iter<'a, u8>,
    children: &'a [u32],
    scratch: Vec<u32>,
}
