//! Collapses nodes of two children into nodes of eight, at the lowest cost that the binary tree allows [Ylitie 2017,
//! section 3.1].
//!
//! Visiting a node costs [`NODE_COST`], visiting a leaf one test per block, each weighted by the area of the box.
//! From the bottom up, every subtree computes the lowest cost of representing it by at most so many wide subtrees.

use super::binary::{Binary, BinaryNode};
use super::item::Bounds;
use super::split::blocks;
use crate::bvh8::layout::{LANES, MAX_BLOCKS, WIDTH};

/// Cost of visiting a node, in tests of a block.
const NODE_COST: f32 = 1.2;
/// Larger leaves are not considered.
const LARGEST_LEAF: usize = 4 * LANES;
const _: () = assert!(LARGEST_LEAF <= MAX_BLOCKS * LANES);

/// `costs[i]`: the lowest cost of a subtree as at most `i + 1` wide ones.
pub(super) type Costs = [f32; WIDTH - 1];

/// The costs of a leaf of one block.
pub(super) fn costs_of_leaf(bounds: &Bounds) -> Costs {
    [bounds.half_area(); WIDTH - 1]
}

/// The costs of a node with some items below it, from the costs of its children.
#[inline(always)]
pub(super) fn costs_of_inner(bounds: &Bounds, count: usize, left: &Costs, right: &Costs) -> Costs {
    // For one slot fewer than the index up to a node's full width; written so that it vectorises.
    let mut shifted = [f32::INFINITY; 2 * WIDTH];
    shifted[WIDTH..2 * WIDTH - 1].copy_from_slice(right);
    let mut shared = [f32::INFINITY; WIDTH];
    for (k, &left) in left.iter().enumerate() {
        let right = &shifted[WIDTH - 1 - k..2 * WIDTH - 1 - k];
        for (shared, &right) in shared.iter_mut().zip(right) {
            let cost = left + right;
            *shared = if cost < *shared { cost } else { *shared };
        }
    }
    let half_area = bounds.half_area();
    let mut costs = [0.0; WIDTH - 1];
    costs[0] = as_leaf(half_area, count).min(half_area * NODE_COST + shared[WIDTH - 1]);
    for i in 1..WIDTH - 1 {
        costs[i] = costs[i - 1].min(shared[i]);
    }
    costs
}

fn as_leaf(half_area: f32, count: usize) -> f32 {
    if count <= LARGEST_LEAF { half_area * blocks(count as u32) } else { f32::INFINITY }
}

/// How many of `places` slots to give the left child for the lowest cost, and that cost.
#[inline(always)]
fn share(places: usize, left: &Costs, right: &Costs) -> (usize, f32) {
    let (mut best, mut least) = (1, left[0] + right[places - 2]);
    for k in 2..places {
        let cost = left[k - 1] + right[places - k - 1];
        // No branch predictor can guess this: no branch.
        let better = cost < least;
        best = if better { k } else { best };
        least = if better { cost } else { least };
    }
    (best, least)
}

/// The children of a wide node, by their numbers, or none if a leaf is cheaper.
pub(super) fn children_of(binary: &Binary, node: &BinaryNode, children: &mut Vec<u32>) {
    children.clear();
    if node.is_leaf() {
        return;
    }
    let [left, right] = binary.children(node);
    let (costs, half_area) = ([left.costs(), right.costs()], node.half_area());
    let (k, shared) = share(WIDTH, &costs[0], &costs[1]);
    if node.count() <= LARGEST_LEAF && as_leaf(half_area, node.count()) <= half_area * NODE_COST + shared {
        return;
    }
    let first = node.first_child();
    collect(binary, first, k, children);
    collect(binary, first + 1, WIDTH - k, children);
}

/// The wide subtrees, at most so many, that represent a subtree at the lowest cost.
fn collect(binary: &Binary, number: u32, places: usize, children: &mut Vec<u32>) {
    let node = binary.node(number);
    let costs = node.costs();
    let mut places = places;
    while places > 1 && costs[places - 2] <= costs[places - 1] {
        places -= 1;
    }
    if places == 1 || node.is_leaf() {
        children.push(number);
        return;
    }
    let [left, right] = binary.children(&node);
    let (k, _) = share(places, &left.costs(), &right.costs());
    let first = node.first_child();
    collect(binary, first, k, children);
    collect(binary, first + 1, places - k, children);
}
