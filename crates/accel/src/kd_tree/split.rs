//! Chooses the next plane.

use super::clip::{Planes, Reference};

/// Cost of visiting a node, in triangle tests.
const NODE_COST: f64 = 0.75;
/// Factor on the cost of a plane that cuts off empty space.
const EMPTY_BONUS: f64 = 0.8;
/// From this many references on, planes are tried between bins instead of at every face of a box.
const SWEEP: usize = 48;
/// Bins per axis.
const BINS: usize = 48;

/// A plane and its expected cost.
#[derive(Clone, Copy, Debug)]
pub(super) struct Split {
    pub(super) axis: usize,
    pub(super) plane: f32,
    /// Which side triangles in the plane itself go to.
    pub(super) planar_below: bool,
    cost: f64,
}

/// The best plane by the surface-area heuristic, if any is better than a leaf and creates at most `spare` more
/// references.
pub(super) fn best_split(references: &[Reference], cell: &Planes, spare: usize) -> Option<Split> {
    let mut search = Search { cell, area: half_area(cell), total: references.len(), spare, best: None };
    for axis in 0..3 {
        if references.len() <= SWEEP { search.sweep(references, axis) } else { search.bins(references, axis) }
    }
    search.best.filter(|best| best.cost < references.len() as f64)
}

struct Search<'a> {
    cell: &'a Planes,
    area: f64,
    total: usize,
    spare: usize,
    best: Option<Split>,
}

impl Search<'_> {
    /// Evaluates a plane with the given numbers of references below, in, and above it.
    fn consider(&mut self, axis: usize, plane: f32, [below, within, above]: [usize; 3]) {
        let inside = self.cell[0][axis] < plane && plane < self.cell[1][axis];
        if !inside || below + within + above > self.total + self.spare {
            return;
        }
        let (mut low, mut high) = (*self.cell, *self.cell);
        (low[1][axis], high[0][axis]) = (plane, plane);
        let (low, high) = (half_area(&low) / self.area, half_area(&high) / self.area);
        for (planar_below, below, above) in [(true, below + within, above), (false, below, above + within)] {
            let bonus = if below == 0 || above == 0 { EMPTY_BONUS } else { 1.0 };
            let cost = bonus * (NODE_COST + low * below as f64 + high * above as f64);
            // Areas that overflow or are zero give costs that are not finite.
            if cost.is_finite() && self.best.is_none_or(|best| cost < best.cost) {
                self.best = Some(Split { axis, plane, planar_below, cost });
            }
        }
    }

    /// Every face of every box, in order [Wald 2006].
    fn sweep(&mut self, references: &[Reference], axis: usize) {
        let mut events = [0u64; 2 * SWEEP];
        let mut len = 0;
        for reference in references {
            let (low, high) = (reference.planes[0][axis], reference.planes[1][axis]);
            let all = if low == high {
                [Some((low, Event::Within)), None]
            } else {
                [Some((low, Event::Start)), Some((high, Event::End))]
            };
            for (at, event) in all.into_iter().flatten() {
                events[len] = key(at) << 2 | event as u64;
                len += 1;
            }
        }
        let events = &mut events[..len];
        events.sort_unstable();
        let (mut below, mut above, mut i) = (0, references.len(), 0);
        while i < events.len() {
            let at = events[i] >> 2;
            let mut seen = [0; 3];
            while i < events.len() && events[i] >> 2 == at {
                seen[(events[i] & 3) as usize] += 1;
                i += 1;
            }
            let [ends, within, starts] = seen;
            above -= ends + within;
            self.consider(axis, place(at), [below, within, above]);
            below += starts + within;
        }
    }

    /// Equally spaced planes over the extent of the boxes, both ends included.
    fn bins(&mut self, references: &[Reference], axis: usize) {
        let low = references.iter().fold(f32::INFINITY, |low, r| low.min(r.planes[0][axis]));
        let high = references.iter().fold(f32::NEG_INFINITY, |high, r| high.max(r.planes[1][axis]));
        let scale = BINS as f32 / (high - low);
        if !(scale.is_finite() && scale > 0.0) {
            return;
        }
        let bin = |at: f32| (((at - low) * scale) as usize).min(BINS - 1);
        let (mut starts, mut ends) = ([0; BINS], [0; BINS]);
        for reference in references {
            starts[bin(reference.planes[0][axis])] += 1;
            ends[bin(reference.planes[1][axis])] += 1;
        }
        let (mut below, mut above) = (0, references.len());
        for step in 0..=BINS {
            let plane = if step == BINS { high } else { low + (high - low) * (step as f32 / BINS as f32) };
            self.consider(axis, plane, [below, 0, above]);
            if step < BINS {
                below += starts[step];
                above -= ends[step];
            }
        }
    }
}

/// The events of boxes at a position, in the order in which they must be processed.
#[derive(Clone, Copy)]
enum Event {
    End,
    Within,
    Start,
}

/// Bits that sort like the numbers; both zeros have the same key.
fn key(x: f32) -> u64 {
    let bits = (x + 0.0).to_bits();
    u64::from(if bits >> 31 == 1 { !bits } else { bits | 1 << 31 })
}

fn place(key: u64) -> f32 {
    let bits = key as u32;
    f32::from_bits(if bits >> 31 == 1 { bits & !(1 << 31) } else { !bits })
}

fn half_area(planes: &Planes) -> f64 {
    let [x, y, z] = std::array::from_fn(|k| f64::from(planes[1][k]) - f64::from(planes[0][k]));
    x * y + y * z + z * x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_keep_order_and_round_trip() {
        let numbers = [f32::MIN, -1.5, -1e-45, 0.0, 1e-45, 2.0, f32::MAX];
        assert!(numbers.windows(2).all(|pair| key(pair[0]) < key(pair[1])));
        assert!(numbers.iter().all(|&x| place(key(x)) == x));
        assert_eq!(key(-0.0), key(0.0));
    }

    fn reference(low: f32, high: f32) -> Reference {
        Reference { planes: [[low, 0.0, 0.0], [high, 1.0, 1.0]], index: 0 }
    }

    #[test]
    fn empty_space_is_cut_off_at_the_bounds_of_the_triangles() {
        let cell = [[0.0; 3], [10.0, 1.0, 1.0]];
        for count in [10, 1000] {
            let references: Vec<_> = (0..count).map(|_| reference(9.0, 9.5)).collect();
            let split = best_split(&references, &cell, 0).unwrap();
            assert_eq!((split.axis, split.plane), (0, 9.0));
        }
    }

    #[test]
    fn inseparable_triangles_stay_a_leaf() {
        let cell = [[0.0; 3], [1.0; 3]];
        for count in [10, 1000] {
            let references: Vec<_> = (0..count).map(|_| reference(0.0, 1.0)).collect();
            assert!(best_split(&references, &cell, 1_000_000).is_none());
        }
    }
}
