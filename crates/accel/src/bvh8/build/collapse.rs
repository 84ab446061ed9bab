//! From two children a node to eight, at the least cost that the binary tree allows [Ylitie 2017, section 3.1].
//!
//! A visit to a node costs [`NODE_COST`], one to a leaf a test for each of its blocks, each weighed by the area of
//! the box. From below, every subtree learns the least cost of showing it as at most so many wide subtrees.

use super::binary::{Binary, Node};
use super::item::Bounds;
use super::split::blocks;
use crate::bvh8::layout::{LANES, MAX_BLOCKS, WIDTH};

/// What a visit to a node costs, in tests of a block.
const NODE_COST: f32 = 1.2;
/// Larger leaves are not considered.
const LARGEST_LEAF: usize = 4 * LANES;
const _: () = assert!(LARGEST_LEAF <= MAX_BLOCKS * LANES);

/// `costs[i]`: the least cost of a subtree as at most `i + 1` wide ones.
pub(super) type Costs = [f32; WIDTH - 1];

/// Of one block.
pub(super) fn costs_of_leaf(bounds: &Bounds) -> Costs {
    [bounds.half_area(); WIDTH - 1]
}

/// Of a node with some items below, from what its children cost.
pub(super) fn costs_of_inner(bounds: &Bounds, count: usize, left: &Costs, right: &Costs) -> Costs {
    let mut costs = [0.0; WIDTH - 1];
    costs[0] = as_leaf(bounds.half_area(), count).min(as_node(bounds.half_area(), left, right));
    for i in 1..WIDTH - 1 {
        costs[i] = costs[i - 1].min(share(i + 1, left, right).1);
    }
    costs
}

fn as_leaf(half_area: f32, count: usize) -> f32 {
    if count <= LARGEST_LEAF { half_area * blocks(count as u32) } else { f32::INFINITY }
}

fn as_node(half_area: f32, left: &Costs, right: &Costs) -> f32 {
    half_area * NODE_COST + share(WIDTH, left, right).1
}

/// How many of `places` go to the left at best, and the cost of that.
#[inline(always)]
fn share(places: usize, left: &Costs, right: &Costs) -> (usize, f32) {
    let mut best = (1, left[0] + right[places - 2]);
    for k in 2..places {
        let cost = left[k - 1] + right[places - k - 1];
        if cost < best.1 {
            best = (k, cost);
        }
    }
    best
}

/// The children of a wide node, or none if a leaf is cheaper.
pub(super) fn children_of(binary: &Binary, node: &Node, children: &mut Vec<Node>) {
    children.clear();
    if node.is_leaf() {
        return;
    }
    let [left, right] = binary.children(node);
    let (costs, half_area) = ([left.costs(), right.costs()], node.half_area());
    let cheap = as_leaf(half_area, node.count()) <= as_node(half_area, &costs[0], &costs[1]);
    if cheap && node.count() <= LARGEST_LEAF {
        return;
    }
    let (k, _) = share(WIDTH, &costs[0], &costs[1]);
    collect(binary, &left, k, children);
    collect(binary, &right, WIDTH - k, children);
}

/// The wide subtrees that show a subtree at the least cost, at most so many.
fn collect(binary: &Binary, node: &Node, places: usize, children: &mut Vec<Node>) {
    let costs = node.costs();
    let mut places = places;
    while places > 1 && costs[places - 2] <= costs[places - 1] {
        places -= 1;
    }
    if places == 1 || node.is_leaf() {
        children.push(*node);
        return;
    }
    let [left, right] = binary.children(node);
    let (k, _) = share(places, &left.costs(), &right.costs());
    collect(binary, &left, k, children);
    collect(binary, &right, places - k, children);
}
