//! The binary tree from which the wide one is made.
//!
//! No step depends on the number of threads: boxes are merged by minima and maxima and items are counted in integers,
//! so the order in which chunks finish does not matter.

use super::costs::{Costs, costs_of_inner, costs_of_leaf};
use super::item::{Bounds, Item};
use super::spatial::Cutter;
use super::split::{Halves, around, best_split, halve, partition};
use crate::bvh8::layout::{LANES, Planes};
use bilux_math::parallel::join;
use std::ops::Range;

/// Maximum number of nodes on a path from the root to a leaf.
pub(in crate::bvh8) const MAX_DEPTH: usize = 64;
/// Below this many items a subtree is built on one thread.
pub(super) const PARALLEL: usize = 4096;

/// A bounding box, its contents and its cost: the planes, the first item, the number of items, one more than the
/// number of the pair of children (0 for a leaf), and [`Costs`]. It is a plain array of numbers, so that space for
/// many nodes takes no memory until it is used.
#[derive(Clone, Copy, Debug)]
pub(super) struct BinaryNode(pub(super) [f32; 16]);

impl BinaryNode {
    pub(super) fn new(bounds: &Bounds, items: Range<u32>, pair: Option<u32>, costs: Costs) -> BinaryNode {
        let [[a, b, c], [d, e, f]] = bounds.planes();
        let [first, count, pair] =
            [items.start, items.len() as u32, pair.map_or(0, |pair| pair + 1)].map(f32::from_bits);
        let [p, q, r, s, t, u, v] = costs;
        BinaryNode([a, b, c, d, e, f, first, count, pair, p, q, r, s, t, u, v])
    }

    /// Minimum and maximum corner.
    pub(super) fn planes(&self) -> Planes {
        let [a, b, c, d, e, f, ..] = self.0;
        [[a, b, c], [d, e, f]]
    }

    /// The items below it.
    pub(super) fn items(&self) -> Range<usize> {
        let first = self.0[6].to_bits() as usize;
        first..first + self.count()
    }

    pub(super) fn count(&self) -> usize {
        self.0[7].to_bits() as usize
    }

    pub(super) fn is_leaf(&self) -> bool {
        self.0[8].to_bits() == 0
    }

    /// The number of the first of two children.
    pub(super) fn first_child(&self) -> u32 {
        (self.0[8].to_bits() - 1) * 2
    }

    pub(super) fn costs(&self) -> Costs {
        std::array::from_fn(|i| self.0[9 + i])
    }

    pub(super) fn half_area(&self) -> f32 {
        let [a, b, c, d, e, f, ..] = self.0;
        let (x, y, z) = (d - a, e - b, f - c);
        x * (y + z) + y * z
    }
}

/// A binary hierarchy of boxes.
pub(super) struct Binary {
    pub(super) root: BinaryNode,
    /// Siblings are adjacent: pair `i` is at `2i` and `2i + 1`. Not all are in use.
    pub(super) nodes: Vec<[f32; 16]>,
    /// Whether some triangle occurs in it more than once.
    pub(super) has_pieces: bool,
    /// Whether the items below any node are contiguous.
    pub(super) in_order: bool,
}

impl Binary {
    /// Sorts items into a tree whose leaves hold at most one block, each a range of the new order. Only the items of
    /// a leaf need be contiguous, not those below an inner node. With a cutter, triangles may be cut, and there may
    /// be up to `spare` more items in the end.
    pub(super) fn over(items: &mut Vec<Item>, cutter: Option<(&Cutter<'_>, usize)>) -> Binary {
        let (bounds, centres, count) = (Bounds::of(items), around(items), items.len());
        if let Some((_, spare)) = cutter {
            items.resize(count + spare, items[0]);
        }
        let mut nodes = vec![[0.0; 16]; 2 * items.len().saturating_sub(1)];
        let task = Task { items, count, first_item: 0, depth: 1 };
        let pairs = NodePairs { nodes: &mut nodes, first_pair: 0 };
        let (root, _) = subtree(task, pairs, &bounds, &centres, cutter.map(|(cutter, _)| cutter));
        Binary { root, nodes, has_pieces: root.count() > count, in_order: cutter.is_none() }
    }

    /// A node other than the root, by its number.
    pub(super) fn node(&self, number: u32) -> BinaryNode {
        BinaryNode(self.nodes[number as usize])
    }

    /// The children of a node that is not a leaf.
    pub(super) fn children(&self, node: &BinaryNode) -> [BinaryNode; 2] {
        [self.node(node.first_child()), self.node(node.first_child() + 1)]
    }
}

/// Items to put under one node, and space behind them for more.
struct Task<'a> {
    items: &'a mut [Item],
    count: usize,
    first_item: u32,
    depth: usize,
}

/// Space for pairs of nodes: one fewer than there may be items.
pub(super) struct NodePairs<'a> {
    pub(super) nodes: &'a mut [[f32; 16]],
    pub(super) first_pair: u32,
}

impl<'a> NodePairs<'a> {
    /// The first `pairs` pairs, and the rest.
    pub(super) fn split(self, pairs: usize) -> (NodePairs<'a>, NodePairs<'a>) {
        let (front, back) = self.nodes.split_at_mut(2 * pairs);
        let first_pair = self.first_pair;
        (
            NodePairs { nodes: front, first_pair },
            NodePairs { nodes: back, first_pair: first_pair + pairs as u32 },
        )
    }

    pub(super) fn lend(&mut self) -> NodePairs<'_> {
        NodePairs { nodes: self.nodes, first_pair: self.first_pair }
    }
}

impl<'a> Task<'a> {
    /// Two tasks, the second from item `middle` on; each gets a share of the spare space in proportion to its number
    /// of items.
    fn in_two(self, middle: usize) -> [Task<'a>; 2] {
        let Task { items, count, first_item, depth } = self;
        let spare = items.len() - count;
        let share = (spare as u64 * middle as u64 / count as u64) as usize;
        // Items of the second task that are in the way of the first's share move behind the others.
        let moved = share.min(count - middle);
        items.copy_within(middle..middle + moved, count + share - moved);
        let place = middle + share;
        let (left, right) = items.split_at_mut(place);
        let depth = depth + 1;
        let left = Task { items: left, count: middle, first_item, depth };
        let right =
            Task { items: right, count: count - middle, first_item: first_item + place as u32, depth };
        [left, right]
    }

    fn halve(&mut self, bounds: &Bounds, centres: &Bounds, cutter: Option<&Cutter<'_>>) -> Halves {
        let (items, depth) = (&self.items[..self.count], self.depth);
        let split = best_split(items, centres).filter(|split| depth_allows(depth, split.counts));
        // Items that share one centre, as copies of a triangle do, are halved: otherwise they would be cut again and
        // again.
        if let (Some(cutter), Some(split)) = (cutter, &split) {
            let spare = self.items.len() - self.count;
            let cut = cutter.best(items, bounds, &split.bounds, split.cost, spare);
            let cut = cut.filter(|cut| depth_allows(depth, cut.counts));
            if let Some((halves, count)) = cut.and_then(|cut| cutter.apply(self.items, self.count, &cut)) {
                self.count = count;
                return halves;
            }
        }
        let items = &mut self.items[..self.count];
        match split {
            Some(split) => partition(items, &split),
            None => halve(items, centres),
        }
    }
}

/// Returns the node, and how many pairs of the space were used, counted from its front.
fn subtree(
    mut task: Task<'_>,
    pairs: NodePairs<'_>,
    bounds: &Bounds,
    centres: &Bounds,
    cutter: Option<&Cutter<'_>>,
) -> (BinaryNode, usize) {
    let first = task.first_item;
    if task.count <= LANES {
        return (BinaryNode::new(bounds, first..first + task.count as u32, None, costs_of_leaf(bounds)), 0);
    }
    let Halves { middle, bounds: halves, centres } = task.halve(bounds, centres, cutter);
    let (count, first_pair) = (task.count, pairs.first_pair);
    let [left, right] = task.in_two(middle);
    let (pair, mut rest) = pairs.split(1);
    let (a, b, used) = if count >= PARALLEL {
        let (left_pairs, right_pairs) = rest.split(left.items.len() - 1);
        let used = left_pairs.nodes.len() / 2 + right_pairs.nodes.len() / 2;
        let (a, b) = join(
            || subtree(left, left_pairs, &halves[0], &centres[0], cutter),
            || subtree(right, right_pairs, &halves[1], &centres[1], cutter),
        );
        (a.0, b.0, used)
    } else {
        // Adjacent, so that no more memory is touched than is used.
        let (a, used) = subtree(left, rest.lend(), &halves[0], &centres[0], cutter);
        let (b, more) = subtree(right, rest.split(used).1, &halves[1], &centres[1], cutter);
        (a, b, used + more)
    };
    (pair.nodes[0], pair.nodes[1]) = (a.0, b.0);
    // Cuts further down may have added items.
    let count = a.count() + b.count();
    let costs = costs_of_inner(bounds, count, &a.costs(), &b.costs());
    (BinaryNode::new(bounds, first..first + count as u32, Some(first_pair), costs), 1 + used)
}

/// True when both children of a node at this depth can still be halved down to single items before the depth limit.
pub(super) fn depth_allows(depth: usize, counts: [usize; 2]) -> bool {
    let levels = |count: usize| count.next_power_of_two().ilog2() as usize;
    counts.iter().all(|&count| depth + 1 + levels(count) <= MAX_DEPTH)
}
