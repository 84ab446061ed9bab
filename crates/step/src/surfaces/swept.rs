//! Surfaces that curves sweep, and those at a distance from others. [ISO 10303-42, 4.4.57 to 4.4.62]

use super::surface::{Pole, Surface, differences};
use crate::curves::{Curve, least};
use crate::structure::axes::Axes;
use bilux_math::transcendental::{atan2_f64, sin_cos_f64};
use bilux_math::{DVec2, DVec3};
use std::f64::consts::TAU;

/// The range of a curve that a surface uses, finite: of lines the part within some distance.
fn reach(curve: &dyn Curve, size: f64) -> [f64; 2] {
    let [from, to] = curve.range();
    [if from.is_finite() { from } else { -size }, if to.is_finite() { to } else { size }]
}

/// The step of differences, as a part of the range: the cube root of the precision balances both errors.
const STEP: f64 = 1e-5;

/// A curve that moves along a vector.
pub(super) struct Extrusion {
    pub(super) curve: Box<dyn Curve>,
    pub(super) along: DVec3,
    /// A distance that no part of the model is beyond.
    pub(super) size: f64,
}

impl Surface for Extrusion {
    fn point(&self, uv: DVec2) -> DVec3 {
        self.curve.point(uv.x) + self.along * uv.y
    }

    fn derivatives(&self, uv: DVec2) -> [DVec3; 2] {
        let [from, to] = reach(&*self.curve, self.size);
        let [along, _] = differences(self, uv, DVec2::new(STEP * (to - from), 0.0));
        [along, self.along]
    }

    fn parameters(&self, p: DVec3, _: Option<DVec2>) -> DVec2 {
        let axis = self.along.normalize_or_zero();
        let flat = |q: DVec3| q - axis * q.dot(axis);
        let target = flat(p);
        let range = reach(&*self.curve, self.size);
        let pieces = self.curve.breaks(range[0], range[1]).len() + 1;
        let u = least(range, pieces, |t| flat(self.curve.point(t)).distance_squared(target));
        let v = (p - self.curve.point(u)).dot(self.along) / self.along.length_squared();
        DVec2::new(u, v)
    }

    fn size(&self) -> usize {
        self.curve.size()
    }

    fn periods(&self) -> [Option<f64>; 2] {
        [self.curve.period(), None]
    }

    fn domain(&self) -> [[f64; 2]; 2] {
        [self.curve.range(), [f64::NEG_INFINITY, f64::INFINITY]]
    }
}

/// A curve that turns about an axis.
pub(super) struct Revolution {
    pub(super) curve: Box<dyn Curve>,
    pub(super) axes: Axes,
    pub(super) size: f64,
}

impl Revolution {
    /// The distance of a point from the axis, and how far along it is.
    fn profile(&self, p: DVec3) -> DVec2 {
        let local = self.axes.local(p);
        DVec2::new(local.truncate().length(), local.z)
    }
}

impl Surface for Revolution {
    fn point(&self, uv: DVec2) -> DVec3 {
        let local = self.axes.local(self.curve.point(uv.y));
        let (sin, cos) = sin_cos_f64(uv.x);
        self.axes.point(local.x * cos - local.y * sin, local.x * sin + local.y * cos, local.z)
    }

    fn derivatives(&self, uv: DVec2) -> [DVec3; 2] {
        let [from, to] = reach(&*self.curve, self.size);
        differences(self, uv, DVec2::new(STEP, STEP * (to - from)))
    }

    fn parameters(&self, p: DVec3, _: Option<DVec2>) -> DVec2 {
        let target = self.profile(p);
        let range = reach(&*self.curve, self.size);
        let pieces = self.curve.breaks(range[0], range[1]).len() + 1;
        let v = least(range, pieces, |t| self.profile(self.curve.point(t)).distance_squared(target));
        let (local, start) = (self.axes.local(p), self.axes.local(self.curve.point(v)));
        DVec2::new(atan2_f64(local.y, local.x) - atan2_f64(start.y, start.x), v)
    }

    fn size(&self) -> usize {
        self.curve.size()
    }

    fn periods(&self) -> [Option<f64>; 2] {
        [Some(TAU), self.curve.period()]
    }

    fn domain(&self) -> [[f64; 2]; 2] {
        [[0.0, TAU], self.curve.range()]
    }

    fn poles(&self) -> Vec<Pole> {
        let [from, to] = self.curve.range();
        let off_axis = |t: f64| self.profile(self.curve.point(t)).x;
        let ends = match from.is_finite() {
            true => vec![from, to],
            // A line may meet the axis anywhere.
            false => vec![least(reach(&*self.curve, self.size), 1, |t| off_axis(t) * off_axis(t))],
        };
        let on_axis = ends.into_iter().filter(|&t| off_axis(t) <= 1e-7 * self.size);
        on_axis.map(|at| Pole { along: 0, at, point: self.curve.point(at) }).collect()
    }

    /// The sphere that a circle sweeps, if its centre is on the axis and its plane contains the axis: centre and radius.
    fn sphere(&self) -> Option<(DVec3, f64)> {
        const NEAR: f64 = 1e-7;
        let (centre, axis, radius) = self.curve.circle()?;
        let is_round = self.profile(centre).x <= NEAR * radius && axis.dot(self.axes.z).abs() <= NEAR;
        is_round.then_some((centre, radius))
    }
}

/// The points at a distance from a surface, along its normals.
pub(super) struct Offset {
    pub(super) basis: Box<dyn Surface>,
    pub(super) distance: f64,
}

impl Surface for Offset {
    fn point(&self, uv: DVec2) -> DVec3 {
        self.basis.point(uv) + self.basis.normal(uv) * self.distance
    }

    fn derivatives(&self, uv: DVec2) -> [DVec3; 2] {
        let step = self.basis.domain().map(|[from, to]| {
            let width = to - from;
            STEP * if width.is_finite() { width } else { self.distance.abs() }
        });
        differences(self, uv, DVec2::from_array(step))
    }

    fn parameters(&self, p: DVec3, near: Option<DVec2>) -> DVec2 {
        self.basis.parameters(p, near)
    }

    fn size(&self) -> usize {
        self.basis.size()
    }

    fn periods(&self) -> [Option<f64>; 2] {
        self.basis.periods()
    }

    fn domain(&self) -> [[f64; 2]; 2] {
        self.basis.domain()
    }

    fn is_plane(&self) -> bool {
        self.basis.is_plane()
    }

    fn normal(&self, uv: DVec2) -> DVec3 {
        self.basis.normal(uv)
    }
}
