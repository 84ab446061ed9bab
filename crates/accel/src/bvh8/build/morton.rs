//! The fast builder: items in space-filling-curve order, split where the highest bits change [Lauterbach 2009].

use super::binary::{Binary, BinaryNode, NodePairs, PARALLEL, depth_allows};
use super::costs::{costs_of_inner, costs_of_leaf};
use super::item::{Bounds, Item};
use super::split::around;
use crate::bvh8::layout::LANES;
use bilux_math::glam::Vec4;
use bilux_math::parallel::{fill, join, table};
use rayon::slice::ParallelSliceMut;

/// Bits per axis: cells are a millionth of the whole extent wide, so that small things in large scenes are
/// distinguished.
const BITS: u32 = 20;

/// Number of items that one thread places at a time.
const CHUNK: usize = 4096;

/// Up to this many items are split at block boundaries.
const FEW: usize = 4 * LANES;

/// The position of a centre on the curve, and its item.
type PlaceCode = (u64, u32);

/// Sorts items into a tree whose leaves hold at most one block, each a range of the new order.
pub(super) fn along_a_curve(items: &mut Vec<Item>) -> Binary {
    let centres = around(items);
    let extent = centres.high * 0.5 - centres.low * 0.5;
    let sound = |x: f32| if x.is_finite() { x } else { 0.0 };
    let scale = Vec4::splat((1u32 << (BITS - 1)) as f32 * 0.999_999) / extent;
    let scale = Vec4::new(sound(scale.x), sound(scale.y), sound(scale.z), 0.0);
    let place = |item: &Item| {
        let cell = (item.centre() * 0.5 - centres.low * 0.5) * scale * 2.0;
        let spread = |x: f32| spread((x as u32).min((1 << BITS) - 1));
        spread(cell.x) << 2 | spread(cell.y) << 1 | spread(cell.z)
    };
    let mut places: Vec<PlaceCode> = vec![(0, 0); items.len()];
    fill(&mut places, CHUNK, |k| (place(&items[k]), k as u32));
    places.par_sort_unstable();
    *items = table(items.len(), CHUNK, |k| items[places[k].1 as usize]);
    let mut nodes = vec![[0.0; 16]; 2 * items.len().saturating_sub(1)];
    let pairs = NodePairs { nodes: &mut nodes, first_pair: 0 };
    let (_, root, _) = subtree(items, &places, 0, pairs, 1);
    Binary { root, nodes, has_pieces: false, in_order: true }
}

/// Puts two zeros before each bit.
fn spread(x: u32) -> u64 {
    let mut x = u64::from(x);
    for (shift, mask) in [
        (32, 0x001f_0000_0000_ffff),
        (16, 0x001f_0000_ff00_00ff),
        (8, 0x100f_00f0_0f00_f00f),
        (4, 0x10c3_0c30_c30c_30c3),
        (2, 0x1249_2492_4924_9249),
    ] {
        x = (x | x << shift) & mask;
    }
    x
}

/// Returns the box, the node, and how many pairs of the space were used, counted from its front.
fn subtree(
    items: &[Item],
    places: &[PlaceCode],
    first: u32,
    pairs: NodePairs<'_>,
    depth: usize,
) -> (Bounds, BinaryNode, usize) {
    let count = items.len();
    if count <= LANES {
        let bounds = Bounds::of(items);
        return (
            bounds,
            BinaryNode::new(&bounds, first..first + count as u32, None, costs_of_leaf(&bounds)),
            0,
        );
    }
    let middle = middle_of(places, depth);
    let (left, right) = (items.split_at(middle), places.split_at(middle));
    let first_pair = pairs.first_pair;
    let (pair, mut rest) = pairs.split(1);
    let next = first + middle as u32;
    let (a, b, used) = if count >= PARALLEL {
        let (left_pairs, right_pairs) = rest.split(middle - 1);
        let used = count - 2;
        let (a, b) = join(
            || subtree(left.0, right.0, first, left_pairs, depth + 1),
            || subtree(left.1, right.1, next, right_pairs, depth + 1),
        );
        (a, b, used)
    } else {
        let a = subtree(left.0, right.0, first, rest.lend(), depth + 1);
        let used = a.2;
        let b = subtree(left.1, right.1, next, rest.split(used).1, depth + 1);
        let more = b.2;
        (a, b, used + more)
    };
    (pair.nodes[0], pair.nodes[1]) = (a.1.0, b.1.0);
    let bounds = a.0.union(b.0);
    let costs = costs_of_inner(&bounds, count, &a.1.costs(), &b.1.costs());
    (bounds, BinaryNode::new(&bounds, first..first + count as u32, Some(first_pair), costs), 1 + used)
}

/// Position where the highest bit changes that is not the same in all places; the middle by count if no bit does, or
/// if the tree is too deep.
fn middle_of(places: &[PlaceCode], depth: usize) -> usize {
    let count = places.len();
    let (low, high) = (places[0].0, places[count - 1].0);
    if low == high {
        return count / 2;
    }
    let bit = 1u64 << (63 - (low ^ high).leading_zeros());
    let middle = places.partition_point(|place| place.0 & bit == 0);
    // Full blocks are worth more than the best split position.
    let whole = |n: usize| n / LANES * LANES;
    let middle = if count <= FEW { whole(middle + LANES / 2).clamp(LANES, whole(count - 1)) } else { middle };
    if depth_allows(depth, [middle, count - middle]) { middle } else { count / 2 }
}

#[cfg(test)]
mod tests {
    use super::{BITS, spread};

    #[test]
    fn bits_are_spread_by_three() {
        for bit in 0..BITS {
            assert_eq!(spread(1 << bit), 1 << (3 * bit));
        }
        assert_eq!(spread((1 << BITS) - 1).count_ones(), BITS);
    }
}
