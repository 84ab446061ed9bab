//! The binary tree that the wide one is made of.
//!
//! No step depends on the number of threads: boxes are joined by minima and maxima and items are counted
//! in whole numbers, so that the order in which pieces are done does not matter.

use super::collapse::{Costs, costs_of_inner, costs_of_leaf};
use super::item::{Bounds, Item};
use super::split::{Halves, best_split, halve, partition};
use crate::bvh8::layout::{LANES, Planes};
use std::ops::Range;

/// No way from the root to a leaf has more nodes than this.
pub(in crate::bvh8) const MAX_DEPTH: usize = 64;
/// Below this many items a subtree is built on one thread.
const PARALLEL: usize = 4096;

/// A box, what is in it, and what it costs: the planes, the first item, how many there are, one more than
/// the number of the pair of children (0 for a leaf), and [`Costs`]. A plain array of numbers, so that room
/// for many takes no memory until it is used.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node([f32; 16]);

impl Node {
    fn new(bounds: &Bounds, items: Range<u32>, pair: Option<u32>, costs: Costs) -> Node {
        let [[a, b, c], [d, e, f]] = bounds.planes();
        let [first, count, pair] =
            [items.start, items.len() as u32, pair.map_or(0, |pair| pair + 1)].map(f32::from_bits);
        let [p, q, r, s, t, u, v] = costs;
        Node([a, b, c, d, e, f, first, count, pair, p, q, r, s, t, u, v])
    }

    /// Least and greatest corner.
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

    pub(super) fn costs(&self) -> Costs {
        std::array::from_fn(|i| self.0[9 + i])
    }

    pub(super) fn half_area(&self) -> f32 {
        let [a, b, c, d, e, f, ..] = self.0;
        let (x, y, z) = (d - a, e - b, f - c);
        x * (y + z) + y * z
    }
}

/// Boxes in boxes, two by two.
pub(super) struct Binary {
    pub(super) root: Node,
    /// Siblings side by side: the pair of number `i` at `2i` and `2i + 1`. Not all are in use.
    nodes: Vec<[f32; 16]>,
}

impl Binary {
    /// Sorts items into a tree whose leaves hold one block at most, each a range of the new order.
    pub(super) fn over(items: &mut [Item]) -> Binary {
        let bounds = Bounds::of(items);
        let centres = items.iter().fold(Bounds::EMPTY, |all, item| all.with_point(item.centre()));
        let mut nodes = vec![[0.0; 16]; 2 * items.len().saturating_sub(1)];
        let task = Task { items, first_item: 0, room: &mut nodes, first_pair: 0, depth: 1 };
        let root = subtree(task, &bounds, &centres);
        Binary { root, nodes }
    }

    /// The children of a node that is not a leaf.
    pub(super) fn children(&self, node: &Node) -> [Node; 2] {
        let first = (node.0[8].to_bits() as usize - 1) * 2;
        [Node(self.nodes[first]), Node(self.nodes[first + 1])]
    }
}

/// Items to put under one node, and room for the pairs below it: one less than there are items.
struct Task<'a> {
    items: &'a mut [Item],
    first_item: u32,
    room: &'a mut [[f32; 16]],
    first_pair: u32,
    depth: usize,
}

fn subtree(task: Task<'_>, bounds: &Bounds, centres: &Bounds) -> Node {
    let Task { items, first_item, room, first_pair, depth } = task;
    let range = first_item..first_item + items.len() as u32;
    if items.len() <= LANES {
        return Node::new(bounds, range, None, costs_of_leaf(bounds));
    }
    let split = best_split(items, centres).filter(|split| depth_allows(depth, split.counts));
    let Halves { middle, bounds: halves, centres } = match split {
        Some(split) => partition(items, &split),
        None => halve(items, centres),
    };
    let (pair, room) = room.split_at_mut(2);
    let (left_items, right_items) = items.split_at_mut(middle);
    let (left_room, right_room) = room.split_at_mut(2 * (middle - 1));
    let depth = depth + 1;
    let right_pair = first_pair + middle as u32;
    let right_item = first_item + middle as u32;
    let left = Task { items: left_items, first_item, room: left_room, first_pair: first_pair + 1, depth };
    let right =
        Task { items: right_items, first_item: right_item, room: right_room, first_pair: right_pair, depth };
    let (a, b) = if range.len() >= PARALLEL {
        rayon::join(|| subtree(left, &halves[0], &centres[0]), || subtree(right, &halves[1], &centres[1]))
    } else {
        (subtree(left, &halves[0], &centres[0]), subtree(right, &halves[1], &centres[1]))
    };
    (pair[0], pair[1]) = (a.0, b.0);
    let costs = costs_of_inner(bounds, range.len(), &a.costs(), &b.costs());
    Node::new(bounds, range, Some(first_pair), costs)
}

/// True when both children of a node at this depth can still be halved down to single items in time.
fn depth_allows(depth: usize, counts: [usize; 2]) -> bool {
    let levels = |count: usize| count.next_power_of_two().ilog2() as usize;
    counts.iter().all(|&count| depth + 1 + levels(count) <= MAX_DEPTH)
}
