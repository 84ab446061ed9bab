//! Points along a curve, close enough to each other.

use super::curve::Curve;
use bilux_math::DVec3;
use bilux_math::transcendental::cos_f64;

/// Accuracy of the triangles and lines that stand for surfaces and curves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Accuracy {
    /// The greatest distance between a chord and its arc, in the file's units.
    pub(crate) distance: f64,
    /// The greatest angle that a chord spans, in radians.
    pub(crate) angle: f64,
}

/// The most points of one curve.
const MOST: usize = 2048;

/// Halvings of one piece.
const MAX_DEPTH: usize = 10;

/// The points of a curve from one parameter to another, which may be lower, with both ends.
pub(crate) fn sampled(curve: &dyn Curve, from: f64, to: f64, accuracy: Accuracy) -> Vec<DVec3> {
    let mut breaks = curve.breaks(from.min(to), from.max(to));
    if let Some(period) = curve.period() {
        // What goes beyond the end of a closed curve goes on at its start.
        for turn in [-period, period] {
            let shifted = curve.breaks(from.min(to) - turn, from.max(to) - turn);
            breaks.extend(shifted.into_iter().map(|t| t + turn));
        }
        let [start, end] = curve.range();
        breaks.extend([start, end].into_iter().filter(|&t| t > from.min(to) && t < from.max(to)));
    }
    breaks.sort_by(f64::total_cmp);
    breaks.dedup();
    if breaks.len() > MOST {
        let step = breaks.len().div_ceil(MOST);
        breaks = breaks.into_iter().step_by(step).collect();
    }
    if from > to {
        breaks.reverse();
    }
    let ends: Vec<f64> = breaks.into_iter().chain([to]).collect();
    let mut points = vec![at(curve, from)];
    let mut start = from;
    // A piece without breaks may be a whole circle, or an S.
    let least = if ends.len() == 1 { 4 } else { 2 };
    for end in ends {
        for i in 0..least {
            let part = |i: usize| start + (end - start) * i as f64 / least as f64;
            halve(curve, part(i), part(i + 1), accuracy, 0, &mut points);
        }
        start = end;
    }
    merged(points, accuracy)
}

/// A point of a closed curve at any parameter.
fn at(curve: &dyn Curve, t: f64) -> DVec3 {
    let [from, to] = curve.range();
    match curve.period() {
        Some(period) if t < from => curve.point(t + period),
        Some(period) if t > to => curve.point(t - period),
        _ => curve.point(t),
    }
}

/// Adds the points after the first of a piece.
fn halve(curve: &dyn Curve, from: f64, to: f64, accuracy: Accuracy, depth: usize, points: &mut Vec<DVec3>) {
    let (a, b) = (points[points.len() - 1], at(curve, to));
    let middle = at(curve, 0.5 * (from + to));
    let is_close = depth >= MAX_DEPTH || points.len() >= MOST || is_straight(a, middle, b, accuracy);
    if is_close {
        points.push(b);
        return;
    }
    halve(curve, from, 0.5 * (from + to), accuracy, depth + 1, points);
    halve(curve, 0.5 * (from + to), to, accuracy, depth + 1, points);
}

/// True if a chord over three points is close enough.
fn is_straight(a: DVec3, middle: DVec3, b: DVec3, accuracy: Accuracy) -> bool {
    let chord = b - a;
    let d = middle - a;
    let along = if chord.length_squared() > 0.0 {
        chord * (d.dot(chord) / chord.length_squared())
    } else {
        DVec3::ZERO
    };
    if (d - along).length() > accuracy.distance {
        return false;
    }
    // The halves of an arc over an angle meet at half of it.
    let (first, second) = (middle - a, b - middle);
    let lengths = first.length() * second.length();
    lengths == 0.0 || first.dot(second) >= lengths * cos_f64(0.5 * accuracy.angle)
}

/// Leaves out points on straight pieces: halves and breaks have made more than are needed.
fn merged(points: Vec<DVec3>, accuracy: Accuracy) -> Vec<DVec3> {
    let mut kept: Vec<DVec3> = Vec::with_capacity(points.len());
    let tight = Accuracy { distance: 1e-4 * accuracy.distance, angle: 1e-3 * accuracy.angle };
    for (i, &p) in points.iter().enumerate() {
        let is_inner = i > 0 && i + 1 < points.len();
        if is_inner && is_straight(kept[kept.len() - 1], p, points[i + 1], tight) {
            continue;
        }
        kept.push(p);
    }
    kept
}
