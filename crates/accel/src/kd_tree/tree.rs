//! Nodes, and the traversal of a ray through them.

use crate::accelerator::TreeShape;
use crate::counters::Count;
use crate::slab::SlabRay;
use bilux_math::Aabb;
use std::ops::ControlFlow;

/// Maximum number of nodes on a path from the root to a leaf.
pub(super) const MAX_DEPTH: usize = 64;

/// Maximum number of nodes that the links in nodes can address.
pub(super) const MAX_NODES: usize = (u32::MAX >> 2) as usize;

#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    /// The child below the plane directly follows its parent.
    pub(super) nodes: Vec<KdNode>,
    /// Triangles of all leaves, leaf by leaf.
    pub(super) references: Vec<u32>,
}

/// 8 bytes, so that eight nodes share a cache line.
#[derive(Clone, Copy, Debug)]
pub(super) struct KdNode {
    /// The position of the plane, or the first reference of a leaf.
    payload: u32,
    /// The lower two bits hold the axis, or 3 for a leaf; the other bits hold the child above the plane, or the
    /// number of references.
    link: u32,
}

const LEAF: u32 = 3;

impl KdNode {
    pub(super) fn leaf(first: usize, count: usize) -> KdNode {
        KdNode { payload: first as u32, link: (count as u32) << 2 | LEAF }
    }

    pub(super) fn inner(axis: usize, plane: f32, above: usize) -> KdNode {
        KdNode { payload: plane.to_bits(), link: (above as u32) << 2 | axis as u32 }
    }

    /// This node in a tree where other nodes and references come first.
    pub(super) fn behind(self, nodes: usize, references: usize) -> KdNode {
        match self.is_leaf() {
            true => KdNode { payload: self.payload + references as u32, ..self },
            false => KdNode { link: self.link + ((nodes as u32) << 2), ..self },
        }
    }

    fn is_leaf(self) -> bool {
        self.link & 3 == LEAF
    }

    fn references(self) -> std::ops::Range<usize> {
        let first = self.payload as usize;
        first..first + (self.link >> 2) as usize
    }
}

/// A cell that is still to be visited, and the ray's interval in it.
#[derive(Clone, Copy)]
struct StackEntry {
    node: u32,
    enter: f32,
    leave: f32,
}

impl Tree {
    /// Visits the leaves that the ray hits up to `limit` (an `s` of [`SlabRay`]), front to back. `visit` receives a
    /// leaf's references and returns the limit that applies from then on, or a break.
    ///
    /// The ray's intervals in the two cells next to a plane overlap by the pad on both sides of it, so it does not
    /// matter where exactly the ray crosses the plane, or whether it does. [Havran 2000, for the cases to distinguish
    /// otherwise]
    #[inline(always)]
    pub(super) fn walk<C: Count>(
        &self,
        ray: &SlabRay,
        bounds: &Aabb,
        mut limit: f32,
        count: &mut C,
        mut visit: impl FnMut(&[u32], &mut C) -> ControlFlow<(), f32>,
    ) {
        let [enter, leave] = ray.span_of(bounds);
        if self.nodes.is_empty() || enter > leave || enter > limit || leave < ray.nearest {
            return;
        }
        let mut stack = [StackEntry { node: 0, enter: 0.0, leave: 0.0 }; MAX_DEPTH];
        let mut height = 0;
        let mut at = StackEntry { node: 0, enter: enter.max(ray.nearest), leave };
        loop {
            count.node();
            let node = self.nodes[at.node as usize];
            if node.is_leaf() {
                match visit(&self.references[node.references()], count) {
                    ControlFlow::Continue(lower) => limit = lower,
                    ControlFlow::Break(()) => return,
                }
            } else {
                let (axis, plane) = ((node.link & 3) as usize, f32::from_bits(node.payload));
                let into_far = (plane - ray.enter_origin[axis]) * ray.inverse[axis];
                let out_of_near = (plane - ray.leave_origin[axis]) * ray.inverse[axis];
                let children = [at.node + 1, node.link >> 2];
                let high = ray.enters_high[axis] & 1;
                let (near, far) = (children[high], children[high ^ 1]);
                let (skip_near, skip_far) = (at.enter > out_of_near, into_far > at.leave);
                if !skip_near {
                    if !skip_far {
                        if into_far > limit {
                            count.early_out();
                        } else {
                            stack[height] =
                                StackEntry { node: far, enter: at.enter.max(into_far), leave: at.leave };
                            height += 1;
                        }
                    }
                    at = StackEntry { node: near, leave: at.leave.min(out_of_near), ..at };
                    continue;
                }
                if !skip_far {
                    at = StackEntry { node: far, enter: at.enter.max(into_far), ..at };
                    continue;
                }
            }
            loop {
                if height == 0 {
                    return;
                }
                height -= 1;
                at = stack[height];
                let late = at.enter > limit;
                if !late {
                    break;
                }
                count.early_out();
            }
        }
    }

    pub(super) fn memory_bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.references.as_slice())
    }

    pub(super) fn shape(&self) -> TreeShape {
        let mut shape = TreeShape::default();
        let mut stack = if self.nodes.is_empty() { Vec::new() } else { vec![(0, 1)] };
        while let Some((index, depth)) = stack.pop() {
            let node = self.nodes[index];
            if node.is_leaf() {
                shape.add_leaf(depth, node.references().len());
            } else {
                shape.nodes += 1;
                stack.extend([(index + 1, depth + 1), ((node.link >> 2) as usize, depth + 1)]);
            }
        }
        shape
    }
}
