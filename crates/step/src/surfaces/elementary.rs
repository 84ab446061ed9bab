//! Planes, cylinders, cones, spheres and tori. [ISO 10303-42, 4.4.49 to 4.4.54]

use super::surface::{Pole, Surface};
use crate::structure::axes::Axes;
use bilux_math::transcendental::{acos_f64, asin_f64, atan2_f64, sin_cos_f64, sin_f64, tan_f64};
use bilux_math::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const LINE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
const TURN: [f64; 2] = [0.0, TAU];

pub(super) struct Plane(pub(super) Axes);

impl Surface for Plane {
    fn point(&self, uv: DVec2) -> DVec3 {
        self.0.point(uv.x, uv.y, 0.0)
    }

    fn derivatives(&self, _: DVec2) -> [DVec3; 2] {
        [self.0.x, self.0.y]
    }

    fn parameters(&self, p: DVec3, _: Option<DVec2>) -> DVec2 {
        self.0.local(p).truncate()
    }

    fn domain(&self) -> [[f64; 2]; 2] {
        [LINE; 2]
    }

    fn is_plane(&self) -> bool {
        true
    }
}

/// A cone with a half-angle, or with an angle of 0 a cylinder.
pub(super) struct Cone {
    pub(super) axes: Axes,
    /// The radius at v = 0.
    pub(super) radius: f64,
    /// The tangent of the half-angle.
    tangent: f64,
}

impl Cone {
    pub(super) fn new(axes: Axes, radius: f64, half_angle: f64) -> Option<Cone> {
        let tangent = if half_angle == 0.0 { 0.0 } else { tan_f64(half_angle) };
        let is_sound = half_angle.abs() < FRAC_PI_2 && radius >= 0.0 && (radius > 0.0 || tangent != 0.0);
        is_sound.then_some(Cone { axes, radius, tangent })
    }
}

impl Surface for Cone {
    fn point(&self, uv: DVec2) -> DVec3 {
        let (sin, cos) = sin_cos_f64(uv.x);
        let r = self.radius + uv.y * self.tangent;
        self.axes.point(r * cos, r * sin, uv.y)
    }

    fn derivatives(&self, uv: DVec2) -> [DVec3; 2] {
        let (sin, cos) = sin_cos_f64(uv.x);
        let around = self.axes.y * cos - self.axes.x * sin;
        let out = self.axes.x * cos + self.axes.y * sin;
        let r = self.radius + uv.y * self.tangent;
        // At the tip, the direction around is that of points next to it.
        let r = if r == 0.0 { f64::MIN_POSITIVE.sqrt() } else { r };
        [around * r, out * self.tangent + self.axes.z]
    }

    fn parameters(&self, p: DVec3, _: Option<DVec2>) -> DVec2 {
        let local = self.axes.local(p);
        let r = self.radius + local.z * self.tangent;
        let sign = if r < 0.0 { -1.0 } else { 1.0 };
        DVec2::new(atan2_f64(local.y * sign, local.x * sign), local.z)
    }

    fn periods(&self) -> [Option<f64>; 2] {
        [Some(TAU), None]
    }

    fn domain(&self) -> [[f64; 2]; 2] {
        [TURN, LINE]
    }

    fn poles(&self) -> Vec<Pole> {
        if self.tangent == 0.0 {
            return Vec::new();
        }
        let at = -self.radius / self.tangent;
        vec![Pole { along: 0, at, point: self.axes.point(0.0, 0.0, at) }]
    }
}

pub(super) struct Sphere {
    pub(super) axes: Axes,
    pub(super) radius: f64,
}

impl Surface for Sphere {
    fn point(&self, uv: DVec2) -> DVec3 {
        let ((sin_u, cos_u), (sin_v, cos_v)) = (sin_cos_f64(uv.x), sin_cos_f64(uv.y));
        let r = self.radius;
        self.axes.point(r * cos_v * cos_u, r * cos_v * sin_u, r * sin_v)
    }

    fn derivatives(&self, uv: DVec2) -> [DVec3; 2] {
        let ((sin_u, cos_u), (sin_v, cos_v)) = (sin_cos_f64(uv.x), sin_cos_f64(uv.y));
        let Axes { x, y, z, .. } = self.axes;
        let around = (y * cos_u - x * sin_u) * cos_v.max(1e-150);
        let up = z * cos_v - (x * cos_u + y * sin_u) * sin_v;
        [around * self.radius, up * self.radius]
    }

    fn parameters(&self, p: DVec3, _: Option<DVec2>) -> DVec2 {
        let d = self.axes.local(p).normalize_or_zero();
        DVec2::new(atan2_f64(d.y, d.x), asin_f64(d.z.clamp(-1.0, 1.0)))
    }

    fn periods(&self) -> [Option<f64>; 2] {
        [Some(TAU), None]
    }

    fn domain(&self) -> [[f64; 2]; 2] {
        [TURN, [-FRAC_PI_2, FRAC_PI_2]]
    }

    fn poles(&self) -> Vec<Pole> {
        let pole = |sign: f64| Pole {
            along: 0,
            at: sign * FRAC_PI_2,
            point: self.axes.point(0.0, 0.0, sign * self.radius),
        };
        vec![pole(-1.0), pole(1.0)]
    }

    fn sphere(&self) -> Option<(DVec3, f64)> {
        Some((self.axes.origin, self.radius))
    }
}

/// A torus; if its tube is thicker than the ring, either its outer or its inner part.
pub(super) struct Torus {
    pub(super) axes: Axes,
    pub(super) major: f64,
    pub(super) minor: f64,
    pub(super) is_outer: bool,
}

impl Torus {
    /// The v at which the tube meets the axis, if it does.
    fn tip(&self) -> Option<f64> {
        (self.minor >= self.major).then(|| acos_f64((-self.major / self.minor).clamp(-1.0, 1.0)))
    }
}

impl Surface for Torus {
    fn point(&self, uv: DVec2) -> DVec3 {
        let ((sin_u, cos_u), (sin_v, cos_v)) = (sin_cos_f64(uv.x), sin_cos_f64(uv.y));
        let r = self.major + self.minor * cos_v;
        self.axes.point(r * cos_u, r * sin_u, self.minor * sin_v)
    }

    fn derivatives(&self, uv: DVec2) -> [DVec3; 2] {
        let ((sin_u, cos_u), (sin_v, cos_v)) = (sin_cos_f64(uv.x), sin_cos_f64(uv.y));
        let Axes { x, y, z, .. } = self.axes;
        let r = self.major + self.minor * cos_v;
        let out = x * cos_u + y * sin_u;
        [(y * cos_u - x * sin_u) * r, (z * cos_v - out * sin_v) * self.minor]
    }

    fn parameters(&self, p: DVec3, _: Option<DVec2>) -> DVec2 {
        let local = self.axes.local(p);
        let around = local.truncate().length();
        let u = atan2_f64(local.y, local.x);
        match self.tip() {
            Some(_) if !self.is_outer => DVec2::new(u + PI, turned(atan2_f64(local.z, -around - self.major))),
            _ => DVec2::new(u, atan2_f64(local.z, around - self.major)),
        }
    }

    fn periods(&self) -> [Option<f64>; 2] {
        [Some(TAU), self.tip().is_none().then_some(TAU)]
    }

    fn domain(&self) -> [[f64; 2]; 2] {
        match self.tip() {
            Some(tip) if self.is_outer => [TURN, [-tip, tip]],
            Some(tip) => [TURN, [tip, TAU - tip]],
            None => [TURN; 2],
        }
    }

    fn poles(&self) -> Vec<Pole> {
        let [_, ends] = self.domain();
        if self.tip().is_none() {
            return Vec::new();
        }
        ends.iter()
            .map(|&at| Pole { along: 0, at, point: self.axes.point(0.0, 0.0, self.minor * sin_f64(at)) })
            .collect()
    }

    fn normal(&self, uv: DVec2) -> DVec3 {
        let ((sin_u, cos_u), (sin_v, cos_v)) = (sin_cos_f64(uv.x), sin_cos_f64(uv.y));
        let Axes { x, y, z, .. } = self.axes;
        let outward = (x * cos_u + y * sin_u) * cos_v + z * sin_v;
        // Within the axis, the direction around turns back.
        let middle = if self.tip().is_some() && !self.is_outer { -1.0 } else { 1.0 };
        outward * middle
    }
}

/// An angle from 0 to a whole turn.
fn turned(angle: f64) -> f64 {
    if angle < 0.0 { angle + TAU } else { angle }
}
