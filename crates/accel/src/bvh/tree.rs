//! The bounding volume hierarchy itself, over any items that have a bounding box.

use crate::accelerator::TreeShape;
use crate::counters::Count;
use crate::slab::SlabRay;
use bilux_math::{Aabb, Vec3};
use std::ops::{ControlFlow, Range};

/// Maximum number of nodes on a path from the root to a leaf. A stack of this size never overflows: the builder
/// splits in halves where the tree would become deeper.
pub(crate) const MAX_DEPTH: usize = 64;

/// A hierarchy of boxes around items; leaves name the items by ranges of an order that the builder chose.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub(super) root: BvhNode,
    /// Both children of a node are adjacent, in one cache line. Parents come before their children.
    pub(super) pairs: Vec<Pair>,
}

/// Two siblings.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(crate) struct Pair(pub(super) [BvhNode; 2]);

/// A bounding box and its contents. 32 bytes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BvhNode {
    /// Minimum and maximum corner.
    pub(super) planes: [[f32; 3]; 2],
    /// The first item of a leaf, or the pair of children.
    pub(super) first: u32,
    /// Items of a leaf; 0 for an inner node.
    pub(super) count: u32,
}

impl Default for BvhNode {
    fn default() -> BvhNode {
        BvhNode { planes: EMPTY, first: 0, count: 0 }
    }
}

pub(super) const EMPTY: [[f32; 3]; 2] = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];

/// A node that is still to be visited, and the distance at which the ray enters it.
#[derive(Clone, Copy)]
struct StackEntry {
    first: u32,
    count: u32,
    enter: f32,
}

impl Tree {
    /// Whether `hits` is true of any slot of the order in the leaves that the ray passes through up to `limit`.
    #[inline(always)]
    pub(crate) fn find<C: Count>(
        &self,
        ray: &SlabRay,
        limit: f32,
        count: &mut C,
        mut hits: impl FnMut(usize) -> bool,
    ) -> bool {
        let mut found = false;
        self.walk(ray, limit, count, |mut leaf, count| {
            found = leaf.any(|slot| {
                count.triangles(1);
                hits(slot)
            });
            if found { ControlFlow::Break(()) } else { ControlFlow::Continue(limit) }
        });
        found
    }

    /// Visits the leaves that the ray hits up to `limit` (an `s` of [`SlabRay`]), the nearer sibling first. `leaf`
    /// receives a range of the order and returns the limit that applies from then on, or a break.
    #[inline(always)]
    pub(crate) fn walk<C: Count>(
        &self,
        ray: &SlabRay,
        mut limit: f32,
        count: &mut C,
        mut leaf: impl FnMut(Range<usize>, &mut C) -> ControlFlow<(), f32>,
    ) {
        let [enter, leave] = ray.span(&self.root.planes);
        // The comparisons are written so that a NaN, which overflow may produce, excludes nothing.
        if self.is_empty() || enter > leave || enter > limit || leave < ray.nearest {
            return;
        }
        let mut stack = [StackEntry { first: 0, count: 0, enter: 0.0 }; MAX_DEPTH];
        let mut height = 0;
        let mut node = StackEntry { first: self.root.first, count: self.root.count, enter };
        loop {
            count.node();
            if node.count == 0 {
                let [a, b] = &self.pairs[node.first as usize].0;
                let ([enter_a, leave_a], [enter_b, leave_b]) = (ray.span(&a.planes), ray.span(&b.planes));
                let meets_a = !(enter_a > leave_a || leave_a < ray.nearest);
                let meets_b = !(enter_b > leave_b || leave_b < ray.nearest);
                let (late_a, late_b) = (enter_a > limit, enter_b > limit);
                let (visit_a, visit_b) = (meets_a && !late_a, meets_b && !late_b);
                count_early_outs(count, [meets_a, meets_b], [visit_a, visit_b]);
                let a = StackEntry { first: a.first, count: a.count, enter: enter_a };
                let b = StackEntry { first: b.first, count: b.count, enter: enter_b };
                if visit_a && visit_b {
                    let (near, far) = if enter_b < enter_a { (b, a) } else { (a, b) };
                    stack[height] = far;
                    height += 1;
                    node = near;
                    continue;
                }
                if visit_a || visit_b {
                    node = if visit_a { a } else { b };
                    continue;
                }
            } else {
                let first = node.first as usize;
                match leaf(first..first + node.count as usize, count) {
                    ControlFlow::Continue(lower) => limit = lower,
                    ControlFlow::Break(()) => return,
                }
            }
            loop {
                if height == 0 {
                    return;
                }
                height -= 1;
                node = stack[height];
                let late = node.enter > limit;
                if !late {
                    break;
                }
                count.early_out();
            }
        }
    }

    /// Refits all boxes to items that have moved; `bounds` takes a position in the order.
    pub(crate) fn refit(&mut self, bounds: impl Fn(usize) -> Aabb) {
        let fitted = |node: &BvhNode, pairs: &[Pair]| {
            if node.count == 0 {
                let [a, b] = pairs[node.first as usize].0;
                return union(&a.planes, &b.planes);
            }
            let first = node.first as usize;
            (first..first + node.count as usize)
                .fold(EMPTY, |all, slot| union(&all, &planes_of(&bounds(slot))))
        };
        if self.is_empty() {
            return;
        }
        // Children come after their parents.
        for index in (0..self.pairs.len()).rev() {
            for side in 0..2 {
                self.pairs[index].0[side].planes = fitted(&self.pairs[index].0[side], &self.pairs);
            }
        }
        self.root.planes = fitted(&self.root, &self.pairs);
    }

    /// The bounding box of everything.
    pub(crate) fn bounds(&self) -> Aabb {
        Aabb { min: Vec3::from(self.root.planes[0]), max: Vec3::from(self.root.planes[1]) }
    }

    pub(crate) fn memory_bytes(&self) -> usize {
        size_of::<BvhNode>() + size_of_val(self.pairs.as_slice())
    }

    pub(crate) fn shape(&self) -> TreeShape {
        let mut shape = TreeShape::default();
        let mut stack = vec![(&self.root, 1)];
        while let Some((node, depth)) = stack.pop().filter(|_| !self.is_empty()) {
            if node.count > 0 {
                shape.add_leaf(depth, node.count as usize);
            } else {
                shape.nodes += 1;
                stack.extend(self.pairs[node.first as usize].0.iter().map(|child| (child, depth + 1)));
            }
        }
        shape
    }

    fn is_empty(&self) -> bool {
        self.root.count == 0 && self.pairs.is_empty()
    }
}

#[inline(always)]
fn count_early_outs<C: Count>(count: &mut C, hits: [bool; 2], visits: [bool; 2]) {
    for side in 0..2 {
        if hits[side] && !visits[side] {
            count.early_out();
        }
    }
}

#[inline(always)]
pub(crate) fn union(a: &[[f32; 3]; 2], b: &[[f32; 3]; 2]) -> [[f32; 3]; 2] {
    let low = std::array::from_fn(|k| if b[0][k] < a[0][k] { b[0][k] } else { a[0][k] });
    let high = std::array::from_fn(|k| if b[1][k] > a[1][k] { b[1][k] } else { a[1][k] });
    [low, high]
}

pub(super) fn planes_of(bounds: &Aabb) -> [[f32; 3]; 2] {
    [bounds.min.to_array(), bounds.max.to_array()]
}
