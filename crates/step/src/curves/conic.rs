//! Lines and conic sections. [ISO 10303-42, 4.4.26 to 4.4.31]

use super::curve::Curve;
use crate::structure::axes::Axes;
use bilux_math::DVec3;
use bilux_math::transcendental::{atan2_f64, exp_f64, ln_f64, sin_cos_f64};
use std::f64::consts::TAU;

pub(super) struct Line {
    pub(super) origin: DVec3,
    pub(super) along: DVec3,
}

impl Curve for Line {
    fn point(&self, t: f64) -> DVec3 {
        self.origin + self.along * t
    }

    fn range(&self) -> [f64; 2] {
        [f64::NEG_INFINITY, f64::INFINITY]
    }

    fn parameter(&self, p: DVec3) -> f64 {
        (p - self.origin).dot(self.along) / self.along.length_squared()
    }
}

/// A circle is an ellipse with equal radii.
pub(super) struct Ellipse {
    pub(super) axes: Axes,
    pub(super) radii: [f64; 2],
    /// The unit of the parameter in radians, which matters where a parameter trims.
    pub(super) unit: f64,
}

impl Curve for Ellipse {
    fn point(&self, t: f64) -> DVec3 {
        let (sin, cos) = sin_cos_f64(t * self.unit);
        self.axes.point(self.radii[0] * cos, self.radii[1] * sin, 0.0)
    }

    fn range(&self) -> [f64; 2] {
        [0.0, TAU / self.unit]
    }

    fn period(&self) -> Option<f64> {
        Some(TAU / self.unit)
    }

    fn circle(&self) -> Option<(DVec3, DVec3, f64)> {
        (self.radii[0] == self.radii[1]).then_some((self.axes.origin, self.axes.z, self.radii[0]))
    }

    fn parameter(&self, p: DVec3) -> f64 {
        let local = self.axes.local(p);
        atan2_f64(local.y / self.radii[1], local.x / self.radii[0]) / self.unit
    }
}

pub(super) struct Parabola {
    pub(super) axes: Axes,
    pub(super) focal: f64,
}

impl Curve for Parabola {
    fn point(&self, t: f64) -> DVec3 {
        self.axes.point(self.focal * t * t, 2.0 * self.focal * t, 0.0)
    }

    fn range(&self) -> [f64; 2] {
        [f64::NEG_INFINITY, f64::INFINITY]
    }

    fn parameter(&self, p: DVec3) -> f64 {
        self.axes.local(p).y / (2.0 * self.focal)
    }
}

pub(super) struct Hyperbola {
    pub(super) axes: Axes,
    pub(super) radii: [f64; 2],
}

impl Curve for Hyperbola {
    fn point(&self, t: f64) -> DVec3 {
        let (up, down) = (exp_f64(t), exp_f64(-t));
        self.axes.point(self.radii[0] * 0.5 * (up + down), self.radii[1] * 0.5 * (up - down), 0.0)
    }

    fn range(&self) -> [f64; 2] {
        [f64::NEG_INFINITY, f64::INFINITY]
    }

    fn parameter(&self, p: DVec3) -> f64 {
        let s = self.axes.local(p).y / self.radii[1];
        // The inverse of the hyperbolic sine, without the loss of digits below zero.
        let root = ln_f64(s.abs() + (s * s + 1.0).sqrt());
        if s < 0.0 { -root } else { root }
    }
}
