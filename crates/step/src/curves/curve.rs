//! Interface of all curves.

use bilux_math::DVec3;

/// A curve in space with a parameter.
pub(crate) trait Curve: Send + Sync {
    fn point(&self, t: f64) -> DVec3;

    /// The first and the last parameter; those of lines are infinite.
    fn range(&self) -> [f64; 2];

    /// The period of the parameter of a closed curve.
    fn period(&self) -> Option<f64> {
        None
    }

    /// Parameters between two others at which the curve may bend sharply.
    fn breaks(&self, _from: f64, _to: f64) -> Vec<f64> {
        Vec::new()
    }

    /// The centre, the axis and the radius of a circle, or of a part of one.
    fn circle(&self) -> Option<(DVec3, DVec3, f64)> {
        None
    }

    /// The bytes that it takes.
    fn size(&self) -> usize {
        256
    }

    /// The parameter of the curve's point that is nearest to a point.
    fn parameter(&self, p: DVec3) -> f64;
}

/// The number of points that a search begins with, for each piece between breaks.
const FIRST: usize = 16;
const MOST: usize = 4096;

/// The golden section.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// The parameter in a range for which a function of it is least, from many on, then by sections. [Kiefer 1953]
pub(crate) fn least(range: [f64; 2], pieces: usize, distance: impl Fn(f64) -> f64) -> f64 {
    let [from, to] = range;
    let count = (FIRST * pieces.max(1)).min(MOST);
    let at = |i: usize| from + (to - from) * i as f64 / count as f64;
    let mut best = (0, f64::INFINITY);
    for i in 0..=count {
        let d = distance(at(i));
        if d < best.1 {
            best = (i, d);
        }
    }
    let (mut low, mut high) = (at(best.0.saturating_sub(1)), at((best.0 + 1).min(count)));
    let (mut a, mut b) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
    let (mut of_a, mut of_b) = (distance(a), distance(b));
    for _ in 0..SECTIONS {
        if of_a < of_b {
            (high, b, of_b) = (b, a, of_a);
            a = high - GOLDEN * (high - low);
            of_a = distance(a);
        } else {
            (low, a, of_a) = (a, b, of_b);
            b = low + GOLDEN * (high - low);
            of_b = distance(b);
        }
    }
    let middle = 0.5 * (low + high);
    // Ends are exact.
    [from, to, middle].into_iter().min_by(|x, y| distance(*x).total_cmp(&distance(*y))).unwrap_or(middle)
}

/// Enough for half of the digits of a parameter, all that the least distance tells.
const SECTIONS: usize = 40;
