//! The statue: a coiled dragon as a field, about a metre high, negative inside.

use super::noise::{pebbles, rough};
use crate::modelling::implicit::{Cone, soft_min};
use bilux_math::transcendental::sin_cos;
use bilux_math::{Aabb, Vec3};

/// The statue.
pub(super) struct Dragon {
    cones: Vec<Cone>,
}

/// The width over which parts blend into each other, metres.
const SOFTNESS: f32 = 0.02;
/// The maximum distance of the skin from the smooth figure, metres.
const SKIN: f32 = 0.016;

impl Dragon {
    pub(super) fn new() -> Dragon {
        let spine = spine();
        let mut cones: Vec<Cone> =
            spine.windows(2).map(|w| Cone { from: w[0].0, to: w[1].0, radius: [w[0].1, w[1].1] }).collect();
        cones.extend(crest(&spine));
        cones.extend(HEAD.iter().flat_map(|&[from, to, [r0, r1, _]]| {
            let cone = Cone { from: Vec3::from(from), to: Vec3::from(to), radius: [r0, r1] };
            let mirror = |p: Vec3| Vec3::new(p.x, p.y, -p.z);
            [cone, Cone { from: mirror(cone.from), to: mirror(cone.to), ..cone }]
        }));
        Dragon { cones }
    }

    /// A bounding box with some margin.
    pub(super) fn bounds(&self) -> Aabb {
        let ends = self.cones.iter().flat_map(|c| [(c.from, c.radius[0]), (c.to, c.radius[1])]);
        let boxes = ends.map(|(p, r)| Aabb::of_points([p]).expanded(r));
        boxes.fold(Aabb::EMPTY, Aabb::union).expanded(2.0 * (SKIN + SOFTNESS))
    }

    /// The parts that matter within `radius` of a point, or none where the surface is further away.
    ///
    /// The sign of the second result is the sign of the field there.
    pub(super) fn near(&self, p: Vec3, radius: f32) -> (Dragon, f32) {
        let distance = |c: &Cone| c.distance(p);
        let least = self.cones.iter().map(distance).fold(f32::INFINITY, f32::min);
        let reach = 1.2 * radius + SKIN + SOFTNESS;
        let chosen = self.cones.iter().filter(|c| distance(c) < least + 2.0 * reach && least.abs() < reach);
        (Dragon { cones: chosen.copied().collect() }, least)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.cones.is_empty()
    }

    /// The field: smooth parts, then scales, wear and noise.
    pub(super) fn field(&self, p: Vec3) -> f32 {
        let smooth = self.cones.iter().fold(f32::INFINITY, |d, cone| soft_min(d, cone.distance(p), SOFTNESS));
        if smooth.abs() > SKIN {
            return smooth;
        }
        let scales = 0.010 * (pebbles(p * 42.0) - 0.5);
        let wear = 0.004 * rough(p * 9.0, 6);
        smooth + (scales + wear).clamp(-SKIN, SKIN)
    }
}

/// From the tip of the tail, around the coil, and up the neck: degrees around, distance from the axis, height,
/// thickness.
const COIL: [[f32; 4]; 17] = [
    [-30.0, 0.66, 0.05, 0.008],
    [20.0, 0.62, 0.05, 0.030],
    [65.0, 0.58, 0.07, 0.050],
    [110.0, 0.53, 0.09, 0.070],
    [155.0, 0.49, 0.11, 0.090],
    [200.0, 0.45, 0.12, 0.105],
    [245.0, 0.42, 0.13, 0.118],
    [290.0, 0.40, 0.15, 0.126],
    [335.0, 0.37, 0.21, 0.130],
    [380.0, 0.33, 0.29, 0.130],
    [425.0, 0.28, 0.37, 0.125],
    [470.0, 0.22, 0.46, 0.118],
    [515.0, 0.18, 0.57, 0.108],
    [540.0, 0.15, 0.70, 0.096],
    [540.0, 0.14, 0.84, 0.086],
    [540.0, 0.07, 0.95, 0.078],
    [360.0, 0.04, 1.00, 0.074],
];

/// Head: brow, snout, nostril, lower jaw, cheek, eye, horn in three, whisker, ear; from, to, radii. Each appears on
/// both sides.
const HEAD: [[[f32; 3]; 3]; 11] = [
    [[0.04, 1.0, 0.0], [0.17, 0.99, 0.022], [0.074, 0.062, 0.0]],
    [[0.17, 0.99, 0.022], [0.34, 0.945, 0.012], [0.060, 0.038, 0.0]],
    [[0.33, 0.968, 0.022], [0.345, 0.962, 0.026], [0.020, 0.018, 0.0]],
    [[0.10, 0.925, 0.020], [0.30, 0.865, 0.008], [0.042, 0.022, 0.0]],
    [[0.08, 0.955, 0.045], [0.14, 0.935, 0.040], [0.040, 0.030, 0.0]],
    [[0.20, 1.022, 0.052], [0.21, 1.020, 0.053], [0.022, 0.022, 0.0]],
    [[0.08, 1.04, 0.040], [-0.02, 1.13, 0.075], [0.026, 0.020, 0.0]],
    [[-0.02, 1.13, 0.075], [-0.11, 1.17, 0.100], [0.020, 0.013, 0.0]],
    [[-0.11, 1.17, 0.100], [-0.20, 1.16, 0.110], [0.013, 0.004, 0.0]],
    [[0.31, 0.935, 0.035], [0.36, 0.900, 0.110], [0.010, 0.004, 0.0]],
    [[0.03, 1.01, 0.065], [-0.05, 1.01, 0.140], [0.024, 0.005, 0.0]],
];

/// Closely spaced positions and thicknesses along the back.
fn spine() -> Vec<(Vec3, f32)> {
    let knots = COIL.map(|[degrees, radius, y, thickness]| {
        let (sin, cos) = sin_cos(degrees.to_radians());
        (Vec3::new(radius * cos, y, -radius * sin), thickness)
    });
    let at = |i: usize| knots[i.min(knots.len() - 1)];
    const STEPS: usize = 8;
    let points = (0..(knots.len() - 1) * STEPS).map(|k| {
        let (i, t) = (k / STEPS, (k % STEPS) as f32 / STEPS as f32);
        let ((p0, _), (p1, r1), (p2, r2), (p3, _)) = (at(i.saturating_sub(1)), at(i), at(i + 1), at(i + 2));
        let (m1, m2) = ((p2 - p0) * 0.5, (p3 - p1) * 0.5);
        let (t2, t3) = (t * t, t * t * t);
        let p = p1 * (2.0 * t3 - 3.0 * t2 + 1.0)
            + m1 * (t3 - 2.0 * t2 + t)
            + p2 * (3.0 * t2 - 2.0 * t3)
            + m2 * (t3 - t2);
        (p, r1 + (r2 - r1) * t)
    });
    points.chain([at(knots.len() - 1)]).collect()
}

/// Thorns along the back, pointing away from the axis and upwards.
fn crest(spine: &[(Vec3, f32)]) -> impl Iterator<Item = Cone> {
    spine.iter().skip(4).step_by(2).map(|&(p, r)| {
        let away = Vec3::new(p.x, 0.0, p.z).normalize_or(Vec3::NEG_X);
        let out = (away * (0.35 + 0.6 * p.y) + Vec3::Y * (1.0 - 0.6 * p.y)).normalize();
        let foot = p + out * (0.8 * r);
        Cone { from: foot, to: foot + out * (0.45 * r + 0.012), radius: [0.26 * r, 0.003] }
    })
}
