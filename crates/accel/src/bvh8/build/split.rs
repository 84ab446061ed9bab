//! Choice of a split of items: the binned surface-area heuristic [Wald 2007], counted in blocks of triangles.

use super::item::{Bounds, Item};
use crate::bvh8::layout::LANES;
use bilux_math::glam::Vec4;
use bilux_math::parallel::map;

/// Bins per axis, for many items.
pub(super) const BINS: usize = 16;
/// And for few.
const FEW: usize = 8;
/// From this many items on, threads share a pass over them.
const PARALLEL_PASS: usize = 1 << 16;
/// Number of items that a thread takes in such a pass.
const CHUNK: usize = 1 << 14;

/// A split between two bins.
pub(super) struct Split {
    grid: Grid,
    axis: usize,
    /// The first bin that goes to the right.
    bin: u32,
    pub(super) cost: f32,
    pub(super) counts: [usize; 2],
    pub(super) bounds: [Bounds; 2],
}

/// Maps centres to bins along each axis.
#[derive(Clone, Copy)]
struct Grid {
    least: Vec4,
    scale: Vec4,
    bins: usize,
}

/// 1.5 · 2²³: floats around this value have no fraction, and their low bits are an integer.
const WHOLE: f32 = 12_582_912.0;

impl Grid {
    fn new(centres: &Bounds, len: usize) -> Grid {
        let bins = (4 + len / 8).min(BINS);
        let extent = centres.high - centres.low;
        // Slightly less, so that the largest centre falls into the last bin.
        let scale = Vec4::splat(bins as f32 * 0.9999) / extent;
        let sound = |x: f32| if x.is_finite() { x } else { 0.0 };
        Grid {
            least: centres.low,
            scale: Vec4::new(sound(scale.x), sound(scale.y), sound(scale.z), 0.0),
            bins,
        }
    }

    /// The bin on each axis, by rounding to integers.
    #[inline(always)]
    fn bins_of(&self, item: &Item) -> [usize; 3] {
        let place = (item.centre() - self.least) * self.scale - Vec4::splat(0.5) + Vec4::splat(WHOLE);
        [self.whole(place.x), self.whole(place.y), self.whole(place.z)]
    }

    /// Bin on one axis, likewise.
    #[inline(always)]
    fn bin_of(&self, item: &Item, axis: usize) -> u32 {
        let place = (item.centre() - self.least) * self.scale - Vec4::splat(0.5) + Vec4::splat(WHOLE);
        self.whole(place[axis]) as u32
    }

    #[inline(always)]
    fn whole(&self, x: f32) -> usize {
        (x.to_bits() as usize & 0xff).min(self.bins - 1)
    }
}

type Bins<const N: usize> = [[(Bounds, u32); N]; 3];

const NO_ITEMS: (Bounds, u32) = (Bounds::EMPTY, 0);

/// The cheapest split; `None` when there is nothing to choose, as when all centres coincide.
pub(super) fn best_split(items: &[Item], centres: &Bounds) -> Option<Split> {
    let grid = Grid::new(centres, items.len());
    if grid.scale == Vec4::ZERO {
        return None;
    }
    if items.len() >= PARALLEL_PASS {
        let parts = map(items.chunks(CHUNK), |items| Box::new(fill::<BINS>(items, &grid)));
        let bins: Box<Bins<BINS>> = parts.into_iter().fold(Box::new([[NO_ITEMS; BINS]; 3]), merge);
        cheapest(&bins, grid)
    } else if grid.bins <= FEW {
        // Most nodes are small, and initialising many bins would take more time than filling them.
        cheapest(&fill::<FEW>(items, &grid), grid)
    } else {
        cheapest(&fill::<BINS>(items, &grid), grid)
    }
}

#[inline]
fn fill<const N: usize>(items: &[Item], grid: &Grid) -> Bins<N> {
    let mut bins = [[NO_ITEMS; N]; 3];
    for item in items {
        let places = grid.bins_of(item);
        for (axis, bins) in bins.iter_mut().enumerate() {
            let (bounds, count) = &mut bins[places[axis]];
            *bounds = bounds.with(item);
            *count += 1;
        }
    }
    bins
}

fn merge(mut a: Box<Bins<BINS>>, b: Box<Bins<BINS>>) -> Box<Bins<BINS>> {
    for (a, b) in a.iter_mut().flatten().zip(b.iter().flatten()) {
        *a = (a.0.union(b.0), a.1 + b.1);
    }
    a
}

/// The number of blocks that this many triangles fill.
#[inline(always)]
pub(super) fn blocks(count: u32) -> f32 {
    count.div_ceil(LANES as u32) as f32
}

fn cheapest<const N: usize>(bins: &Bins<N>, grid: Grid) -> Option<Split> {
    let mut best = None;
    for axis in (0..3).filter(|&axis| grid.scale[axis] > 0.0) {
        sweep(&bins[axis], grid, axis, &mut best);
    }
    best
}

fn sweep<const N: usize>(bins: &[(Bounds, u32); N], grid: Grid, axis: usize, best: &mut Option<Split>) {
    let mut right = [(Bounds::EMPTY, 0, 0.0f32); N];
    let (mut bounds, mut count) = NO_ITEMS;
    for bin in (1..grid.bins).rev() {
        (bounds, count) = (bounds.union(bins[bin].0), count + bins[bin].1);
        right[bin] = (bounds, count, bounds.half_area() * blocks(count));
    }
    let (mut bounds, mut count) = NO_ITEMS;
    for bin in 1..grid.bins {
        (bounds, count) = (bounds.union(bins[bin - 1].0), count + bins[bin - 1].1);
        let (right_bounds, right_count, right_cost) = right[bin];
        let cost = bounds.half_area() * blocks(count) + right_cost;
        // Infinite costs carry no information; empty sides produce them too.
        let usable = count > 0 && right_count > 0 && cost < f32::INFINITY;
        if usable && best.as_ref().is_none_or(|best| cost < best.cost) {
            let counts = [count as usize, right_count as usize];
            *best = Some(Split { grid, axis, bin: bin as u32, cost, counts, bounds: [bounds, right_bounds] });
        }
    }
}

/// The two sides of a split.
pub(super) struct Halves {
    /// Number of items on the left side.
    pub(super) middle: usize,
    pub(super) bounds: [Bounds; 2],
    /// Bounds of the centres.
    pub(super) centres: [Bounds; 2],
}

/// Moves the items of the left side to the front. It does not branch on the side, which no predictor can guess.
pub(super) fn partition(items: &mut [Item], split: &Split) -> Halves {
    let mut middle = 0;
    for i in 0..items.len() {
        let is_left = split.grid.bin_of(&items[i], split.axis) < split.bin;
        items.swap(i, middle);
        middle += usize::from(is_left);
    }
    let (left, right) = items.split_at(middle);
    Halves { middle, bounds: split.bounds, centres: [around(left), around(right)] }
}

/// Splits into halves by count, along the axis on which the centres spread furthest.
pub(super) fn halve(items: &mut [Item], centres: &Bounds) -> Halves {
    let middle = items.len() / 2;
    let spread = centres.high * 0.5 - centres.low * 0.5;
    let axis = (1..3).fold(0, |best, axis| if spread[axis] > spread[best] { axis } else { best });
    if spread[axis] > 0.0 {
        items.select_nth_unstable_by(middle, |a, b| {
            a.centre()[axis].total_cmp(&b.centre()[axis]).then(a.index().cmp(&b.index()))
        });
    }
    let (left, right) = items.split_at(middle);
    Halves { middle, bounds: [Bounds::of(left), Bounds::of(right)], centres: [around(left), around(right)] }
}

/// The bounds of the centres of items.
pub(super) fn around(items: &[Item]) -> Bounds {
    if items.len() >= PARALLEL_PASS {
        return map(items.chunks(CHUNK), around).into_iter().fold(Bounds::EMPTY, Bounds::union);
    }
    let mut some = [Bounds::EMPTY; 4];
    let mut fours = items.chunks_exact(4);
    for four in &mut fours {
        for (some, item) in some.iter_mut().zip(four) {
            *some = some.with_point(item.centre());
        }
    }
    let rest = fours.remainder().iter().fold(some[0], |all, item| all.with_point(item.centre()));
    rest.union(some[1]).union(some[2].union(some[3]))
}
