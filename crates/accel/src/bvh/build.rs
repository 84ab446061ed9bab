//! Top-down building by the binned surface-area heuristic [Wald 2007].
//!
//! No step depends on the number of threads: boxes are merged by minima and maxima and items are counted in integers,
//! so the order in which chunks finish does not matter.

use super::tree::{BvhNode, EMPTY, MAX_DEPTH, Pair, Tree, planes_of, union};
use bilux_math::Aabb;
use bilux_math::parallel::{join, map, ranges};
use std::ops::Range;

/// Bins per axis.
const BINS: usize = 16;
/// Cost of visiting a pair of nodes, in triangle tests.
const NODE_COST: f32 = 1.0;
/// Maximum number of items in a leaf.
const MAX_LEAF: usize = 8;
/// Below this many items a subtree is built on one thread.
const PARALLEL: usize = 4096;

/// An item on its way into a leaf.
#[derive(Clone, Copy)]
struct Item {
    planes: [[f32; 3]; 2],
    index: u32,
}

impl Item {
    #[inline(always)]
    fn centre(&self, axis: usize) -> f32 {
        self.planes[0][axis] * 0.5 + self.planes[1][axis] * 0.5
    }
}

impl Tree {
    /// Builds a tree over items `0..len`, and the order that its leaves' ranges refer to. Items with an empty box are
    /// left out.
    pub(crate) fn over(len: usize, bounds: impl Fn(u32) -> Aabb + Sync) -> (Tree, Vec<u32>) {
        let item = |index: usize| {
            let index = index as u32;
            let bounds = bounds(index);
            (!bounds.is_empty()).then(|| Item { planes: planes_of(&bounds), index })
        };
        let of = |some: Range<usize>| some.filter_map(item).collect::<Vec<_>>();
        let mut items = map(ranges(len, PARALLEL), of).concat();
        if items.is_empty() {
            return (Tree { root: BvhNode::default(), pairs: Vec::new() }, Vec::new());
        }
        let planes = items.iter().fold(EMPTY, |all, item| union(&all, &item.planes));
        let mut pairs = vec![Pair::default(); items.len() - 1];
        let root = subtree(
            Task { items: &mut items, first_item: 0, pairs: &mut pairs, first_pair: 0, depth: 1 },
            planes,
        );
        let order = items.iter().map(|item| item.index).collect();
        (compact(root, pairs), order)
    }
}

/// Items to put under one node, and space for the pairs below it: one fewer than there are items.
struct Task<'a> {
    items: &'a mut [Item],
    first_item: u32,
    pairs: &'a mut [Pair],
    first_pair: u32,
    depth: usize,
}

fn subtree(task: Task<'_>, planes: [[f32; 3]; 2]) -> BvhNode {
    let Task { items, first_item, pairs, first_pair, depth } = task;
    let leaf = BvhNode { planes, first: first_item, count: items.len() as u32 };
    if items.len() == 1 {
        return leaf;
    }
    let split = best_split(items, &planes).filter(|split| depth_allows(depth, split.counts));
    let leaf_cost = items.len() as f32;
    if items.len() <= MAX_LEAF && split.as_ref().is_none_or(|split| split.cost >= leaf_cost) {
        return leaf;
    }
    let (middle, halves) = match split {
        Some(split) => (partition(items, &split), split.halves),
        None => halve(items),
    };
    let Some((pair, pairs)) = pairs.split_first_mut() else { return leaf };
    let (left_items, right_items) = items.split_at_mut(middle);
    let (left_pairs, right_pairs) = pairs.split_at_mut(middle - 1);
    let left = Task {
        items: left_items,
        first_item,
        pairs: left_pairs,
        first_pair: first_pair + 1,
        depth: depth + 1,
    };
    let right = Task {
        items: right_items,
        first_item: first_item + middle as u32,
        pairs: right_pairs,
        first_pair: first_pair + middle as u32,
        depth: depth + 1,
    };
    pair.0 = if left.items.len() + right.items.len() >= PARALLEL {
        let (a, b) = join(|| subtree(left, halves[0]), || subtree(right, halves[1]));
        [a, b]
    } else {
        [subtree(left, halves[0]), subtree(right, halves[1])]
    };
    BvhNode { planes, first: first_pair, count: 0 }
}

/// True when both children of a node at this depth can still be halved down to single items before the depth limit.
fn depth_allows(depth: usize, counts: [usize; 2]) -> bool {
    let levels = |count: usize| count.next_power_of_two().ilog2() as usize;
    counts.iter().all(|&count| depth + 1 + levels(count) <= MAX_DEPTH)
}

/// Position and cost of a split, and the items on both sides.
struct Split {
    axis: usize,
    grid: Grid,
    /// The first bin that goes to the right.
    bin: usize,
    /// Expected cost in triangle tests.
    cost: f32,
    counts: [usize; 2],
    halves: [[[f32; 3]; 2]; 2],
}

/// Maps centres to bins along each axis.
#[derive(Clone, Copy)]
struct Grid {
    least: [f32; 3],
    scale: [f32; 3],
}

impl Grid {
    #[inline(always)]
    fn bin(&self, item: &Item, axis: usize) -> usize {
        // A float cast saturates, and turns NaN into 0.
        (((item.centre(axis) - self.least[axis]) * self.scale[axis]) as usize).min(BINS - 1)
    }
}

#[derive(Clone, Copy)]
struct Bin {
    planes: [[f32; 3]; 2],
    count: usize,
}

const NO_ITEMS: Bin = Bin { planes: EMPTY, count: 0 };

impl Bin {
    #[inline(always)]
    fn with(&self, other: &Bin) -> Bin {
        Bin { planes: union(&self.planes, &other.planes), count: self.count + other.count }
    }
}

type Bins = [[Bin; BINS]; 3];

/// The cheapest split between two bins; `None` when there is nothing to choose, as when all centres coincide.
fn best_split(items: &[Item], planes: &[[f32; 3]; 2]) -> Option<Split> {
    let grid = grid_over(items);
    let bins = fill_bins(items, &grid);
    let area = half_area(planes);
    let mut best: Option<Split> = None;
    for axis in (0..3).filter(|&axis| grid.scale[axis] > 0.0) {
        let mut right = [NO_ITEMS; BINS];
        right[BINS - 1] = bins[axis][BINS - 1];
        for bin in (1..BINS - 1).rev() {
            right[bin] = right[bin + 1].with(&bins[axis][bin]);
        }
        let mut left = NO_ITEMS;
        for bin in 1..BINS {
            left = left.with(&bins[axis][bin - 1]);
            let right = &right[bin];
            let tests =
                half_area(&left.planes) * left.count as f32 + half_area(&right.planes) * right.count as f32;
            let cost = NODE_COST + tests / area;
            // Boxes without area, or that overflow, give meaningless costs.
            let usable = left.count > 0 && right.count > 0 && cost.is_finite();
            if usable && best.as_ref().is_none_or(|best| cost < best.cost) {
                let (counts, halves) = ([left.count, right.count], [left.planes, right.planes]);
                best = Some(Split { axis, grid, bin, cost, counts, halves });
            }
        }
    }
    best
}

fn grid_over(items: &[Item]) -> Grid {
    let of = |items: &[Item]| {
        items.iter().fold(EMPTY, |all, item| {
            let centre = std::array::from_fn(|axis| item.centre(axis));
            union(&all, &[centre, centre])
        })
    };
    let [least, greatest] = if items.len() >= PARALLEL * 8 {
        map(items.chunks(PARALLEL), of).iter().fold(EMPTY, |a, b| union(&a, b))
    } else {
        of(items)
    };
    let scale = std::array::from_fn(|axis| {
        let scale = BINS as f32 / (greatest[axis] - least[axis]);
        if scale.is_finite() { scale } else { 0.0 }
    });
    Grid { least, scale }
}

fn fill_bins(items: &[Item], grid: &Grid) -> Bins {
    let fill = |items: &[Item]| {
        let mut bins = [[NO_ITEMS; BINS]; 3];
        for item in items {
            for (axis, bins) in bins.iter_mut().enumerate() {
                let bin = &mut bins[grid.bin(item, axis)];
                bin.planes = union(&bin.planes, &item.planes);
                bin.count += 1;
            }
        }
        bins
    };
    let merge = |a: Bins, b: &Bins| {
        std::array::from_fn(|axis| std::array::from_fn(|bin| a[axis][bin].with(&b[axis][bin])))
    };
    if items.len() >= PARALLEL * 8 {
        map(items.chunks(PARALLEL), fill).iter().fold([[NO_ITEMS; BINS]; 3], merge)
    } else {
        fill(items)
    }
}

fn half_area(planes: &[[f32; 3]; 2]) -> f32 {
    let [x, y, z] = std::array::from_fn(|k| planes[1][k] - planes[0][k]);
    x * y + y * z + z * x
}

/// Moves the items of the left side to the front and returns their number.
fn partition(items: &mut [Item], split: &Split) -> usize {
    let goes_left = |item: &Item| split.grid.bin(item, split.axis) < split.bin;
    let (mut front, mut back) = (0, items.len());
    loop {
        while front < back && goes_left(&items[front]) {
            front += 1;
        }
        while front < back && !goes_left(&items[back - 1]) {
            back -= 1;
        }
        if front == back {
            return front;
        }
        items.swap(front, back - 1);
    }
}

/// Splits into halves by count, along the axis on which the centres spread furthest.
fn halve(items: &mut [Item]) -> (usize, [[[f32; 3]; 2]; 2]) {
    let middle = items.len() / 2;
    let spread = |axis: usize| {
        let centres = || items.iter().map(|item| item.centre(axis));
        centres().fold(f32::MIN, f32::max) * 0.5 - centres().fold(f32::MAX, f32::min) * 0.5
    };
    let axis = (1..3).fold(0, |best, axis| if spread(axis) > spread(best) { axis } else { best });
    items.select_nth_unstable_by(middle, |a, b| {
        a.centre(axis).total_cmp(&b.centre(axis)).then(a.index.cmp(&b.index))
    });
    let around = |items: &[Item]| items.iter().fold(EMPTY, |all, item| union(&all, &item.planes));
    (middle, [around(&items[..middle]), around(&items[middle..])])
}

/// Removes the space that was not needed. The order stays the same: parents before their children, left before right.
/// Each pair moves forward or stays, onto one that has already moved.
fn compact(mut root: BvhNode, mut pairs: Vec<Pair>) -> Tree {
    let mut count = 0;
    // Slots that hold the old index of a pair; `None` for the root's.
    let mut waiting: Vec<(Option<(usize, usize)>, u32)> =
        if root.count == 0 { vec![(None, root.first)] } else { Vec::new() };
    while let Some((place, old)) = waiting.pop() {
        let new = count;
        count += 1;
        match place {
            None => root.first = new as u32,
            Some((parent, side)) => pairs[parent].0[side].first = new as u32,
        }
        let pair = pairs[old as usize];
        pairs[new] = pair;
        for side in [1, 0] {
            if pair.0[side].count == 0 {
                waiting.push((Some((new, side)), pair.0[side].first));
            }
        }
    }
    pairs.truncate(count);
    pairs.shrink_to_fit();
    Tree { root, pairs }
}
