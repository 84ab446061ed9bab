//! Collapses nodes of two children into nodes of eight, at the lowest cost that the binary tree allows [Ylitie 2017,
//! section 3.1].
//!
//! The [`Costs`] are known from the bottom up: every subtree has computed the lowest cost of representing it by at most so many wide subtrees.

use super::binary::{Binary, BinaryNode};
use super::costs::{Costs, LARGEST_LEAF, NODE_COST, as_leaf};
use crate::bvh8::layout::WIDTH;

/// Number of `places` slots for the left child at the lowest cost, and that cost.
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
