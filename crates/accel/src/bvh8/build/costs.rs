//! The costs of subtrees: visiting a node costs [`NODE_COST`], visiting a leaf one test per block, each weighted by the area
//! of the box.

use super::item::Bounds;
use super::split::blocks;
use crate::bvh8::layout::{LANES, MAX_BLOCKS, WIDTH};

/// Cost of visiting a node, in tests of a block.
pub(super) const NODE_COST: f32 = 1.2;
/// Larger leaves are not considered.
pub(super) const LARGEST_LEAF: usize = 4 * LANES;
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

/// The cost of a leaf with so many items.
pub(super) fn as_leaf(half_area: f32, count: usize) -> f32 {
    if count <= LARGEST_LEAF { half_area * blocks(count as u32) } else { f32::INFINITY }
}
