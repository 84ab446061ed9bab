//! Spatial splits: a triangle that reaches far beyond its neighbours is put on both sides of a plane, each time with
//! the box of its part on that side [Stich 2009].
//!
//! The boxes of all pieces of a triangle together contain every point of it: the intersection of an edge with a plane
//! is computed in f64 and widened, so that no rounding leaves a gap. The hits are therefore those of the tree without
//! cuts.

use super::item::{Bounds, Item};
use super::split::{Halves, around, blocks};
use bilux_math::glam::Vec4;
use bilux_math::parallel::map;

/// Bins per axis.
const BINS: usize = 16;
/// From this many items on, threads share a pass over them.
const PARALLEL_PASS: usize = 1 << 15;
/// Number of items that a thread takes in such a pass.
const CHUNK: usize = 1 << 13;
/// The builder looks for cuts where the halves overlap by more than this fraction of the whole tree's area: with a
/// smaller threshold, builds take twice as long and rays gain a twentieth.
const MIN_OVERLAP: f32 = 1e-3;
/// Maximum cost of a cut, relative to that of the halves: each cut adds triangles.
const MAX_COST: f32 = 0.95;

/// The triangles to cut.
pub(super) struct Cutter<'a> {
    triangles: &'a [[[f32; 3]; 3]],
    least_overlap: f32,
}

/// A plane, and what lies on both sides of it.
pub(super) struct Cut {
    grid: Grid,
    axis: usize,
    /// The first bin on the right.
    bin: usize,
    pub(super) cost: f32,
    pub(super) counts: [usize; 2],
    bounds: [Bounds; 2],
}

/// Bins of equal width along each axis of a box.
#[derive(Clone, Copy)]
struct Grid {
    low: Vec4,
    width: Vec4,
    inverse: Vec4,
    bins: usize,
}

impl Grid {
    fn new(bounds: &Bounds, len: usize) -> Grid {
        let bins = (4 + len / 8).min(BINS);
        let extent = bounds.high - bounds.low;
        let sound = |x: f32| if x.is_finite() { x } else { 0.0 };
        let inverse = Vec4::splat(bins as f32) / extent;
        Grid {
            low: bounds.low,
            width: extent / bins as f32,
            inverse: Vec4::new(sound(inverse.x), sound(inverse.y), sound(inverse.z), 0.0),
            bins,
        }
    }

    /// The bins in which an item begins and ends, on each axis.
    #[inline(always)]
    fn bins_of(&self, item: &Item) -> [[usize; 2]; 3] {
        let [first, last] = [item.low, item.high].map(|p| (p - self.low) * self.inverse);
        std::array::from_fn(|axis| [self.whole(first[axis]), self.whole(last[axis])])
    }

    #[inline(always)]
    fn whole(&self, x: f32) -> usize {
        (x.max(0.0) as i32 as usize).min(self.bins - 1)
    }

    /// The bin that a number falls in.
    #[inline(always)]
    fn bin_of(&self, axis: usize, x: f32) -> usize {
        self.whole((x - self.low[axis]) * self.inverse[axis])
    }

    /// The plane in front of a bin.
    fn plane(&self, axis: usize, bin: usize) -> f32 {
        self.low[axis] + self.width[axis] * bin as f32
    }
}

/// The contents of a bin, and how many items begin and end there.
type Bin = (Bounds, [u32; 2]);
const NO_ITEMS: Bin = (Bounds::EMPTY, [0; 2]);
type Bins = [[Bin; BINS]; 3];

impl<'a> Cutter<'a> {
    pub(super) fn new(triangles: &'a [[[f32; 3]; 3]], bounds: &Bounds) -> Cutter<'a> {
        Cutter { triangles, least_overlap: MIN_OVERLAP * bounds.half_area() }
    }

    /// The cheapest cut, if it beats halves of a given cost and adds no more than `spare` items.
    pub(super) fn best(
        &self,
        items: &[Item],
        bounds: &Bounds,
        halves: &[Bounds; 2],
        cost: f32,
        spare: usize,
    ) -> Option<Cut> {
        if halves[0].shared_half_area(&halves[1]) <= self.least_overlap {
            return None;
        }
        let least = cost * MAX_COST;
        let grid = Grid::new(bounds, items.len());
        let bins = if items.len() >= PARALLEL_PASS {
            let parts = map(items.chunks(CHUNK), |items| Box::new(self.fill(items, &grid)));
            *parts.into_iter().fold(Box::new([[NO_ITEMS; BINS]; 3]), merge)
        } else {
            self.fill(items, &grid)
        };
        let mut best: Option<Cut> = None;
        for axis in (0..3).filter(|&axis| grid.inverse[axis] > 0.0) {
            let least = best.as_ref().map_or(least, |cut| cut.cost);
            best = sweep(&bins[axis], grid, axis, items.len() + spare, least).or(best);
        }
        best
    }

    fn fill(&self, items: &[Item], grid: &Grid) -> Bins {
        let mut bins = [[NO_ITEMS; BINS]; 3];
        for item in items {
            let places = grid.bins_of(item);
            for (axis, [first, last]) in places.into_iter().enumerate() {
                let bins = &mut bins[axis];
                bins[first].1[0] += 1;
                bins[last].1[1] += 1;
                if first == last {
                    bins[first].0 = bins[first].0.with(item);
                } else {
                    self.slice(item, grid, axis, bins);
                }
            }
        }
        bins
    }

    /// Adds the part of an item in each of its bins along an axis; approximately, since this only guides the choice.
    fn slice(&self, item: &Item, grid: &Grid, axis: usize, bins: &mut [Bin; BINS]) {
        let [first, last] = grid.bins_of(item)[axis];
        let mut slices = [Bounds::EMPTY; BINS];
        let corners = self.triangles[item.index() as usize].map(|[x, y, z]| Vec4::new(x, y, z, 0.0));
        for k in 0..3 {
            let (mut a, mut b) = (corners[k], corners[(k + 1) % 3]);
            if a[axis] > b[axis] {
                (a, b) = (b, a);
            }
            let (begin, end) = (grid.bin_of(axis, a[axis]), grid.bin_of(axis, b[axis]));
            if end < first || begin > last {
                continue;
            }
            let step = (b - a) / (b[axis] - a[axis]);
            let at = |bin: usize| a + step * (grid.plane(axis, bin) - a[axis]);
            let from = begin.max(first);
            slices[from] = slices[from].with_point(if begin < first { at(first) } else { a });
            for bin in from..end.min(last) {
                let point = at(bin + 1);
                slices[bin] = slices[bin].with_point(point);
                slices[bin + 1] = slices[bin + 1].with_point(point);
            }
            let to = end.min(last);
            slices[to] = slices[to].with_point(if end > last { at(last + 1) } else { b });
        }
        for bin in first..=last {
            let piece = item.within(&slices[bin]);
            if !piece.is_nothing() {
                bins[bin].0 = bins[bin].0.with(&piece);
            }
        }
    }

    /// The parts of an item on both sides of a plane; an empty part is a box whose corners have swapped.
    fn pieces(&self, item: &Item, axis: usize, plane: f32) -> [Item; 2] {
        let corners = &self.triangles[item.index() as usize];
        let mut sides = [Bounds::EMPTY; 2];
        for (k, a) in corners.iter().enumerate() {
            let b = &corners[(k + 1) % 3];
            let point = Vec4::new(a[0], a[1], a[2], 0.0);
            if a[axis] <= plane {
                sides[0] = sides[0].with_point(point);
            }
            if a[axis] >= plane {
                sides[1] = sides[1].with_point(point);
            }
            if (a[axis] < plane && b[axis] > plane) || (a[axis] > plane && b[axis] < plane) {
                let crossing = crossing(a, b, axis, plane);
                sides = sides.map(|side| side.union(crossing));
            }
        }
        sides[0].high[axis] = sides[0].high[axis].min(plane);
        sides[1].low[axis] = sides[1].low[axis].max(plane);
        sides.map(|side| item.within(&side))
    }

    /// Moves the left side to the front and the new pieces behind the `count` existing items. A triangle is left
    /// whole where that costs less. Returns `None`, and loses nothing, if all items go to one side.
    pub(super) fn apply(&self, items: &mut [Item], count: usize, cut: &Cut) -> Option<(Halves, usize)> {
        let plane = cut.grid.plane(cut.axis, cut.bin);
        let (mut bounds, mut counts) = (cut.bounds, cut.counts.map(|n| n as f32));
        let (mut middle, mut end) = (0, count);
        for i in 0..count {
            let item = items[i];
            let [first, last] = cut.grid.bins_of(&item)[cut.axis];
            let is_left = if last < cut.bin {
                true
            } else if first >= cut.bin {
                false
            } else {
                let [left, right] = self.pieces(&item, cut.axis, plane);
                let side = side_of(&item, &left, &right, &bounds, &counts);
                match side {
                    Some(side) => {
                        bounds[side] = bounds[side].with(&item);
                        counts[1 - side] -= 1.0;
                    }
                    None => {
                        (items[i], items[end]) = (left, right);
                        end += 1;
                    }
                }
                side != Some(1)
            };
            if is_left {
                items.swap(i, middle);
                middle += 1;
            }
        }
        if middle == 0 || middle == end {
            return None;
        }
        let (left, right) = items[..end].split_at(middle);
        let halves = Halves {
            middle,
            bounds: [Bounds::of(left), Bounds::of(right)],
            centres: [around(left), around(right)],
        };
        Some((halves, end))
    }
}

/// The side that takes a whole triangle, if that is cheaper than cutting it or the other side has no part of it.
fn side_of(item: &Item, left: &Item, right: &Item, bounds: &[Bounds; 2], counts: &[f32; 2]) -> Option<usize> {
    match (left.is_nothing(), right.is_nothing()) {
        (false, true) => return Some(0),
        (true, false) => return Some(1),
        (true, true) => return Some(0),
        (false, false) => {}
    }
    let [a, b] = bounds.map(|side| side.half_area());
    let [with_a, with_b] = bounds.map(|side| side.with(item).half_area());
    let cut = a * counts[0] + b * counts[1];
    let only_left = with_a * counts[0] + b * (counts[1] - 1.0);
    let only_right = a * (counts[0] - 1.0) + with_b * counts[1];
    if only_left.min(only_right) >= cut { None } else { Some(usize::from(only_right < only_left)) }
}

/// The bounding box of the point where an edge crosses a plane between its ends.
fn crossing(a: &[f32; 3], b: &[f32; 3], axis: usize, plane: f32) -> Bounds {
    let [x, y, s] = [a[axis], b[axis], plane].map(f64::from);
    let part = (s - x) / (y - x);
    let mut found = Bounds { low: Vec4::ZERO, high: Vec4::ZERO };
    for k in 0..3 {
        let (p, q) = (f64::from(a[k]), f64::from(b[k]));
        let at = p + (q - p) * part;
        // A few hundred times the error of the four roundings.
        let slack = (p.abs() + q.abs()) * (256.0 * f64::EPSILON);
        found.low[k] = ((at - slack) as f32).next_down();
        found.high[k] = ((at + slack) as f32).next_up();
    }
    (found.low[axis], found.high[axis]) = (plane, plane);
    found
}

fn merge(mut a: Box<Bins>, b: Box<Bins>) -> Box<Bins> {
    for (a, b) in a.iter_mut().flatten().zip(b.iter().flatten()) {
        *a = (a.0.union(b.0), [a.1[0] + b.1[0], a.1[1] + b.1[1]]);
    }
    a
}

/// The cheapest cut along an axis that costs less than `least`, with at most so many items on both sides together.
fn sweep(bins: &[Bin; BINS], grid: Grid, axis: usize, most: usize, least: f32) -> Option<Cut> {
    let mut right = [(Bounds::EMPTY, 0); BINS];
    let (mut bounds, mut count) = (Bounds::EMPTY, 0);
    for bin in (1..grid.bins).rev() {
        (bounds, count) = (bounds.union(bins[bin].0), count + bins[bin].1[1]);
        right[bin] = (bounds, count);
    }
    let mut best: Option<Cut> = None;
    let (mut bounds, mut count) = (Bounds::EMPTY, 0);
    for bin in 1..grid.bins {
        (bounds, count) = (bounds.union(bins[bin - 1].0), count + bins[bin - 1].1[0]);
        let (right_bounds, right_count) = right[bin];
        let cost = bounds.half_area() * blocks(count) + right_bounds.half_area() * blocks(right_count);
        let fits = count > 0 && right_count > 0 && (count + right_count) as usize <= most;
        if fits && cost < best.as_ref().map_or(least, |cut| cut.cost) {
            let counts = [count as usize, right_count as usize];
            best = Some(Cut { grid, axis, bin, cost, counts, bounds: [bounds, right_bounds] });
        }
    }
    best
}
