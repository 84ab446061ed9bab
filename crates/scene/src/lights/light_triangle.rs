//! Points on the triangles of lights. The functions have no branches, so that loops over many samples become vector
//! instructions.

use super::Sides;
use bilux_math::{Vec2, Vec3, warp};

/// A triangle in world space at a time.
#[derive(Clone, Copy, Debug)]
pub struct LightTriangle {
    /// Corners, in metres.
    pub corners: [Vec3; 3],
    /// Unit, towards the front; zero for a triangle without area.
    pub normal: Vec3,
    /// Density of its points over area.
    pub pdf_area: f32,
}

/// A point of a light's triangle, as another point receives its light.
#[derive(Clone, Copy, Debug)]
pub struct TriangleSample {
    /// The point.
    pub point: Vec3,
    /// Unit direction towards it.
    pub wi: Vec3,
    /// Unit normal of the light there, on the side of the receiver.
    pub n_light: Vec3,
    /// Density over solid angle; 0 where no light arrives.
    pub pdf_solid_angle: f32,
    /// See [`super::LightSample::clearance`].
    pub clearance: f32,
}

impl TriangleSample {
    /// The point with these barycentric weights, as `from` receives its light.
    #[inline(always)]
    pub fn new(from: Vec3, triangle: &LightTriangle, weights: [f32; 3], sides: Sides) -> TriangleSample {
        let LightTriangle { corners, normal, pdf_area } = triangle;
        let point = blend(corners, weights);
        let to_light = point - from;
        let distance2 = to_light.length_squared();
        let scale = to_light.length_recip();
        let wi = to_light * scale;
        let cos = normal.dot(wi);
        let pdf = pdf_area * distance2 / cos.abs();
        let emits = (sides == Sides::Both) | (cos < 0.0);
        // `is_finite` together with a sign becomes a test of floating-point classes, which is not vectorised.
        let is_positive = |x: f32| (x > 0.0) & (x <= f32::MAX);
        let exists = is_positive(scale) & emits & is_positive(pdf);
        let turn = if cos < 0.0 { 1.0 } else { -1.0 };
        TriangleSample {
            point,
            wi,
            n_light: *normal * turn,
            pdf_solid_angle: if exists { pdf } else { 0.0 },
            clearance: clearance(from, point, corners, cos.abs()),
        }
    }
}

/// Barycentric weights, uniform over a triangle's area.
#[inline(always)]
pub fn barycentric(u: Vec2) -> [f32; 3] {
    let weights = warp::sample_triangle(u);
    [1.0 - weights.x - weights.y, weights.x, weights.y]
}

#[inline(always)]
pub(super) fn blend(corners: &[Vec3; 3], weights: [f32; 3]) -> Vec3 {
    corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2]
}

/// See [`super::LightSample::clearance`]: a hit lies within a few rounding errors of its triangle's plane.
///
/// They are relative to the distances of its corners and of the ray's origin from each other and from the world's origin
/// (see the lemma of [`bilux_accel::triangle`], and [`bilux_accel::instancing`]), and grow by `1 / cos` along the ray.
#[inline(always)]
pub(super) fn clearance(from: Vec3, point: Vec3, corners: &[Vec3; 3], cos: f32) -> f32 {
    // Unlike `f32::max`, this is a single vector instruction.
    let max = |a: f32, b: f32| if a > b { a } else { b };
    let largest = |v: Vec3| max(max(v.x.abs(), v.y.abs()), v.z.abs());
    let [a, b, c] = corners.map(|corner| corner.distance_squared(from));
    let size = max(max(a, b), c).sqrt() + max(largest(from), largest(point));
    (64.0 * f32::EPSILON * size / (cos * point.distance(from))).min(0.5)
}
