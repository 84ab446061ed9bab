//! B-spline surfaces, rational or not.

use super::surface::{Pole, Surface};
use bilux_import::geometry::b_spline::{Basis, projected};
use bilux_math::glam::DVec4;
use bilux_math::{DVec2, DVec3};

pub(super) struct SplineSurface {
    bases: [Basis; 2],
    /// Weighted control points, those of one u after each other.
    points: Vec<DVec4>,
    periods: [Option<f64>; 2],
    poles: Vec<Pole>,
    /// Points to begin a search with, and their parameters.
    grid: Vec<(DVec3, DVec2)>,
    size: f64,
}

/// The most points that a search begins with, along each parameter.
const GRID: usize = 40;

/// Steps of a search.
const STEPS: usize = 24;

impl SplineSurface {
    /// From as many control points as both bases have together.
    pub(super) fn new(bases: [Basis; 2], points: Vec<DVec4>) -> SplineSurface {
        let places = points.iter().map(|p| p.truncate() / p.w);
        let (low, high) =
            places.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        let size = (high - low).length();
        let mut surface =
            SplineSurface { bases, points, periods: [None; 2], poles: Vec::new(), grid: Vec::new(), size };
        let counts = [0, 1].map(|axis| (surface.bases[axis].pieces() * 3).clamp(6, GRID));
        for i in 0..=counts[0] {
            for j in 0..=counts[1] {
                let uv = surface.at_share(i as f64 / counts[0] as f64, j as f64 / counts[1] as f64);
                surface.grid.push((surface.point(uv), uv));
            }
        }
        for axis in 0..2 {
            surface.close(axis);
        }
        surface
    }

    fn at_share(&self, u: f64, v: f64) -> DVec2 {
        let along = |axis: usize, share: f64| {
            let [from, to] = self.bases[axis].range();
            from + (to - from) * share
        };
        DVec2::new(along(0, u), along(1, v))
    }

    /// Finds out whether the surface is closed along a parameter, and whether its ends there are points.
    fn close(&mut self, axis: usize) {
        const SAMPLES: usize = 8;
        let [from, to] = self.bases[axis].range();
        let side = |end: f64| -> Vec<DVec3> {
            let at = |i: usize| {
                let mut uv = self.at_share(i as f64 / SAMPLES as f64, i as f64 / SAMPLES as f64);
                uv[axis] = end;
                self.point(uv)
            };
            (0..=SAMPLES).map(at).collect()
        };
        let (first, last) = (side(from), side(to));
        let near = 1e-6 * self.size;
        let poles = [(from, &first), (to, &last)].map(|(at, points)| {
            let is_point = points.iter().all(|p| p.distance(points[0]) <= near);
            is_point.then_some(Pole { along: 1 - axis, at, point: points[0] })
        });
        let is_closed = first.iter().zip(&last).all(|(a, b)| a.distance(*b) <= near);
        if is_closed && poles.iter().all(Option::is_none) {
            self.periods[axis] = Some(to - from);
        }
        self.poles.extend(poles.into_iter().flatten());
    }

    fn with_derivatives(&self, uv: DVec2) -> (DVec3, [DVec3; 2]) {
        let (of_u, of_v) = (self.bases[0].at(uv.x), self.bases[1].at(uv.y));
        let row = self.points.len() / self.count();
        let (mut point, mut by_u, mut by_v) = (DVec4::ZERO, DVec4::ZERO, DVec4::ZERO);
        for i in 0..=self.bases[0].degree {
            let start = (of_u.first + i) * row + of_v.first;
            let (mut here, mut slope) = (DVec4::ZERO, DVec4::ZERO);
            for (j, &p) in self.points[start..=start + self.bases[1].degree].iter().enumerate() {
                here += p * of_v.values[j];
                slope += p * of_v.slopes[j];
            }
            point += here * of_u.values[i];
            by_u += here * of_u.slopes[i];
            by_v += slope * of_u.values[i];
        }
        let (p, along_u) = projected(point, by_u);
        (p, [along_u, projected(point, by_v).1])
    }

    /// The number of control points along u.
    fn count(&self) -> usize {
        self.bases[0].count()
    }

    /// Parameters within the ranges; closed ones begin again.
    fn wrapped(&self, mut uv: DVec2) -> DVec2 {
        for axis in 0..2 {
            let [from, to] = self.bases[axis].range();
            if let Some(period) = self.periods[axis] {
                uv[axis] -= ((uv[axis] - from) / period).floor() * period;
            }
            uv[axis] = uv[axis].clamp(from, to);
        }
        uv
    }

    /// Steps of Gauss and Newton from parameters on, each at most a part of the range; with the distance reached.
    fn nearest(&self, p: DVec3, start: DVec2) -> (DVec2, f64) {
        let mut uv = self.wrapped(start);
        let (mut point, mut slopes) = self.with_derivatives(uv);
        for _ in 0..STEPS {
            let d = p - point;
            let [u, v] = slopes;
            let (a, b, c) = (u.length_squared(), u.dot(v), v.length_squared());
            let (e, f) = (d.dot(u), d.dot(v));
            let determinant = a * c - b * b;
            let mut step = match determinant > 1e-14 * a * c {
                true => DVec2::new(c * e - b * f, a * f - b * e) / determinant,
                false => DVec2::new(if a > 0.0 { e / a } else { 0.0 }, if c > 0.0 { f / c } else { 0.0 }),
            };
            // Against an end, only the other parameter moves.
            for axis in 0..2 {
                let [from, to] = self.bases[axis].range();
                let is_beyond =
                    (uv[axis] <= from && step[axis] < 0.0) || (uv[axis] >= to && step[axis] > 0.0);
                if is_beyond && self.periods[axis].is_none() {
                    let other = 1 - axis;
                    let (slope, length) = if other == 0 { (e, a) } else { (f, c) };
                    step[axis] = 0.0;
                    step[other] = if length > 0.0 { slope / length } else { 0.0 };
                }
            }
            let mut is_better = false;
            for _ in 0..6 {
                let next = self.wrapped(uv + step);
                let found = self.with_derivatives(next);
                if found.0.distance_squared(p) < point.distance_squared(p) {
                    is_better = true;
                    uv = next;
                    (point, slopes) = found;
                    break;
                }
                step *= 0.35;
            }
            if !is_better || point.distance(p) <= 1e-10 * self.size {
                break;
            }
        }
        (uv, point.distance(p))
    }
}

impl Surface for SplineSurface {
    fn point(&self, uv: DVec2) -> DVec3 {
        self.with_derivatives(self.wrapped(uv)).0
    }

    fn derivatives(&self, uv: DVec2) -> [DVec3; 2] {
        self.with_derivatives(self.wrapped(uv)).1
    }

    fn parameters(&self, p: DVec3, near: Option<DVec2>) -> DVec2 {
        let close = 1e-6 * self.size;
        let mut best = near.map(|near| self.nearest(p, near)).unwrap_or((DVec2::ZERO, f64::INFINITY));
        if best.1 <= close {
            return best.0;
        }
        let mut starts: Vec<(f64, DVec2)> =
            self.grid.iter().map(|(q, uv)| (q.distance_squared(p), *uv)).collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        for &(_, start) in starts.iter().take(4) {
            let found = self.nearest(p, start);
            if found.1 < best.1 {
                best = found;
            }
            if best.1 <= close {
                break;
            }
        }
        best.0
    }

    fn size(&self) -> usize {
        256 + 32 * self.points.len()
    }

    fn periods(&self) -> [Option<f64>; 2] {
        self.periods
    }

    fn domain(&self) -> [[f64; 2]; 2] {
        [self.bases[0].range(), self.bases[1].range()]
    }

    fn poles(&self) -> Vec<Pole> {
        self.poles.clone()
    }

    fn normal(&self, uv: DVec2) -> DVec3 {
        /// Derivatives below this part of the size are noise.
        const NOISE: f64 = 1e-9;
        let slopes = self.derivatives(uv);
        let is_sound = (0..2).all(|axis| {
            let [from, to] = self.bases[axis].range();
            slopes[axis].length() * (to - from) > NOISE * self.size
        });
        let [u, v] = slopes.map(DVec3::normalize_or_zero);
        let across = u.cross(v);
        if is_sound && across.length() > NOISE { across.normalize() } else { DVec3::ZERO }
    }
}
