//! Every plane perpendicular to an axis that touches a piece, evaluated in one sweep per axis [Wald 2006].

use super::choice::{AXIS_STEP, Choice};
use super::pieces::Pieces;
use super::plane::Plane;
use bilux_math::DVec3;
use bilux_math::parallel::join;

/// The cheapest axis-aligned plane of a box that leaves at most `most` references; among equally cheap ones, the
/// first.
pub(super) fn cheapest(
    pieces: &Pieces,
    low: DVec3,
    high: DVec3,
    tolerance: f64,
    most: usize,
) -> Option<Choice> {
    let sweep = |axis| Sweep::new(pieces, axis, low, high, tolerance).cheapest(most);
    let axes = if pieces.len() > PARALLEL {
        let (x, (y, z)) = join(|| sweep(0), || join(|| sweep(1), || sweep(2)));
        [x, y, z]
    } else {
        [sweep(0), sweep(1), sweep(2)]
    };
    axes.into_iter().flatten().min_by(|a, b| a.cost.total_cmp(&b.cost))
}

const PARALLEL: usize = 16_384;

struct Sweep {
    axis: usize,
    low: DVec3,
    high: DVec3,
    tolerance: f64,
    /// Positions where pieces begin and end, and of pieces that fit within a plane; each in ascending order.
    begins: Vec<f64>,
    ends: Vec<f64>,
    flats: Vec<f64>,
}

impl Sweep {
    fn new(pieces: &Pieces, axis: usize, low: DVec3, high: DVec3, tolerance: f64) -> Sweep {
        let (mut begins, mut ends, mut flats) = (Vec::new(), Vec::new(), Vec::new());
        for points in pieces.iter() {
            let begin = points.iter().fold(f64::INFINITY, |least, p| least.min(p[axis]));
            let end = points.iter().fold(f64::NEG_INFINITY, |greatest, p| greatest.max(p[axis]));
            if end - begin > 2.0 * tolerance {
                begins.push(begin);
                ends.push(end);
            } else {
                flats.push(begin);
            }
        }
        for places in [&mut begins, &mut ends, &mut flats] {
            places.sort_unstable_by(f64::total_cmp);
        }
        Sweep { axis, low, high, tolerance, begins, ends, flats }
    }

    fn cheapest(&self, most: usize) -> Option<Choice> {
        let planes = [&self.begins, &self.ends, &self.flats];
        planes
            .into_iter()
            .filter_map(|places| self.cheapest_of(places, most))
            .min_by(|a, b| a.cost.total_cmp(&b.cost))
    }

    /// The cheapest of the planes at these positions, which are in ascending order.
    fn cheapest_of(&self, places: &[f64], most: usize) -> Option<Choice> {
        let extent = self.high - self.low;
        let across = extent[(self.axis + 1) % 3] * extent[(self.axis + 2) % 3];
        let around = extent[(self.axis + 1) % 3] + extent[(self.axis + 2) % 3];
        let area = |length: f64| across + around * length;
        let whole = area(extent[self.axis]);
        let mut begins = Pointer::new(&self.begins);
        let mut ends = Pointer::new(&self.ends);
        let mut flats_left = Pointer::new(&self.flats);
        let mut flats_until = Pointer::new(&self.flats);
        let mut best: Option<Choice> = None;
        for &place in places {
            if !(place > self.low[self.axis] && place < self.high[self.axis]) {
                continue;
            }
            let (before, behind) = (place - self.tolerance, place + self.tolerance);
            let flat_left = flats_left.count(|flat| flat < before);
            let flat_until = flats_until.count(|flat| flat <= behind);
            let left = begins.count(|begin| begin < before) + flat_left;
            let right = self.ends.len() - ends.count(|end| end <= behind) + self.flats.len() - flat_until;
            let counts = [left, right, flat_until - flat_left];
            let areas = [place - self.low[self.axis], self.high[self.axis] - place];
            let areas = areas.map(|length| area(length) / whole);
            let plane = Plane::perpendicular(self.axis, place);
            if counts.iter().sum::<usize>() > most {
                continue;
            }
            if let Some(choice) = Choice::new(plane, AXIS_STEP, areas, counts)
                && best.is_none_or(|best| choice.cost < best.cost)
            {
                best = Some(choice);
            }
        }
        best
    }
}

/// Counts how many of a sorted list of positions lie before a position that only ever increases.
struct Pointer<'a> {
    places: &'a [f64],
    passed: usize,
}

impl<'a> Pointer<'a> {
    fn new(places: &'a [f64]) -> Pointer<'a> {
        Pointer { places, passed: 0 }
    }

    fn count(&mut self, is_before: impl Fn(f64) -> bool) -> usize {
        while self.places.get(self.passed).is_some_and(|&place| is_before(place)) {
            self.passed += 1;
        }
        self.passed
    }
}
