//! B-spline curves, rational or not, and polylines.

use super::curve::{Curve, least};
use bilux_import::geometry::b_spline::{Basis, projected};
use bilux_math::DVec3;
use bilux_math::glam::DVec4;

pub(super) struct Spline {
    pub(super) basis: Basis,
    /// Weighted control points.
    pub(super) points: Vec<DVec4>,
    pub(super) is_closed: bool,
}

impl Spline {
    pub(super) fn new(basis: Basis, points: Vec<DVec4>) -> Spline {
        let mut spline = Spline { basis, points, is_closed: false };
        let [from, to] = spline.range();
        let size = spline.points.iter().map(|p| (p.truncate() / p.w - spline.point(from)).length());
        let size = size.fold(0.0, f64::max);
        spline.is_closed = spline.point(from).distance(spline.point(to)) <= 1e-6 * size;
        spline
    }

    fn with_slope(&self, t: f64) -> (DVec3, DVec3) {
        let weights = self.basis.at(t);
        let (mut point, mut slope) = (DVec4::ZERO, DVec4::ZERO);
        let influential = &self.points[weights.first..=weights.first + self.basis.degree];
        for (i, &p) in influential.iter().enumerate() {
            point += p * weights.values[i];
            slope += p * weights.slopes[i];
        }
        projected(point, slope)
    }
}

impl Curve for Spline {
    fn point(&self, t: f64) -> DVec3 {
        self.with_slope(t).0
    }

    fn range(&self) -> [f64; 2] {
        self.basis.range()
    }

    fn period(&self) -> Option<f64> {
        let [from, to] = self.range();
        self.is_closed.then_some(to - from)
    }

    fn size(&self) -> usize {
        256 + 48 * self.points.len()
    }

    fn breaks(&self, from: f64, to: f64) -> Vec<f64> {
        self.basis.inner().filter(|&knot| knot > from && knot < to).collect()
    }

    fn parameter(&self, p: DVec3) -> f64 {
        let [from, to] = self.range();
        let mut t = least([from, to], self.basis.pieces(), |t| self.point(t).distance_squared(p));
        // A few steps of Gauss and Newton for the rest of the digits.
        for _ in 0..4 {
            let (point, slope) = self.with_slope(t);
            let step = (p - point).dot(slope) / slope.length_squared();
            if !step.is_finite() || self.point((t + step).clamp(from, to)).distance(p) > point.distance(p) {
                break;
            }
            t = (t + step).clamp(from, to);
        }
        t
    }
}

/// Points connected by lines; the parameter counts them.
pub(super) struct Polyline(pub(super) Vec<DVec3>);

impl Curve for Polyline {
    fn point(&self, t: f64) -> DVec3 {
        let last = self.0.len() - 1;
        let t = t.clamp(0.0, last as f64);
        let i = (t as usize).min(last.saturating_sub(1));
        self.0[i].lerp(self.0[(i + 1).min(last)], t - i as f64)
    }

    fn range(&self) -> [f64; 2] {
        [0.0, (self.0.len() - 1) as f64]
    }

    fn period(&self) -> Option<f64> {
        let last = self.0.len() - 1;
        (last > 1 && self.0[0].distance(self.0[last]) <= 1e-9 * self.0[0].distance(self.0[1]))
            .then_some(last as f64)
    }

    fn size(&self) -> usize {
        256 + 24 * self.0.len()
    }

    fn breaks(&self, from: f64, to: f64) -> Vec<f64> {
        let first = from.max(0.0).floor() as usize + 1;
        (first..self.0.len()).map(|i| i as f64).take_while(|&t| t < to).filter(|&t| t > from).collect()
    }

    fn parameter(&self, p: DVec3) -> f64 {
        let mut best = (0.0, f64::INFINITY);
        for (i, pair) in self.0.windows(2).enumerate() {
            let along = pair[1] - pair[0];
            let t = ((p - pair[0]).dot(along) / along.length_squared()).clamp(0.0, 1.0);
            let t = if t.is_finite() { t } else { 0.0 };
            let d = pair[0].lerp(pair[1], t).distance_squared(p);
            if d < best.1 {
                best = (i as f64 + t, d);
            }
        }
        best.0
    }
}
