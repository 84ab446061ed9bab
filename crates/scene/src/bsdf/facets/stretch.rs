//! Roughness in two perpendicular directions: how a distribution of microfacets of alpha 1 is stretched.

use bilux_math::transcendental::sin_cos;
use bilux_math::{Vec2, Vec3};

/// A factor on the slopes of microfacets in each direction; the factors along two perpendicular directions are the alphas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::bsdf) struct Stretch {
    /// A symmetric matrix: xx, xy, yy.
    matrix: [f32; 3],
    /// The smaller alpha; 0 for a smooth surface.
    pub(in crate::bsdf) least: f32,
}

/// A surface with a smaller alpha is smooth, and no direction's alpha is smaller: f32 cannot hold sharper peaks.
pub(in crate::bsdf) const MIN_ALPHA: f32 = 1e-3;

impl Stretch {
    /// A smooth surface.
    pub(in crate::bsdf) const SMOOTH: Stretch = Stretch { matrix: [0.0; 3], least: 0.0 };

    /// One alpha along a direction, which is the local x axis turned by `rotation` in radians, and another across it.
    pub(in crate::bsdf) fn new(alpha_along: f32, alpha_across: f32, rotation: f32) -> Stretch {
        // `max` returns the operand that is not NaN, if there is one.
        if !matches!(alpha_along.max(alpha_across), MIN_ALPHA..) {
            return Stretch::SMOOTH;
        }
        let (along, across) = (alpha_along.max(MIN_ALPHA), alpha_across.max(MIN_ALPHA));
        let (sin, cos) = if along == across { (0.0, 1.0) } else { sin_cos(rotation) };
        let xx = along * cos * cos + across * sin * sin;
        let yy = along * sin * sin + across * cos * cos;
        Stretch { matrix: [xx, (along - across) * sin * cos, yy], least: along.min(across) }
    }

    /// From the parameters of the materials: roughness 0..=1, the square root of alpha; anisotropy 0..=1, how much
    /// smoother the surface is along its brushing than across; and the angle of the brushing from the local x axis, in
    /// radians. [OpenPBR 1.1]
    pub(in crate::bsdf) fn from_roughness(roughness: f32, anisotropy: f32, rotation: f32) -> Stretch {
        let narrowed = 1.0 - anisotropy;
        let across = roughness * roughness * (2.0 / (1.0 + narrowed * narrowed)).sqrt();
        Stretch::new(narrowed * across, across, rotation)
    }

    /// The matrix times a vector.
    #[inline]
    pub(in crate::bsdf) fn of(&self, x: f32, y: f32) -> Vec2 {
        let [xx, xy, yy] = self.matrix;
        Vec2::new(xx * x + xy * y, xy * x + yy * y)
    }

    /// The determinant of the matrix, and its inverse times the horizontal part of a vector.
    #[inline]
    pub(in crate::bsdf) fn back(&self, m: Vec3) -> (f32, Vec2) {
        let [xx, xy, yy] = self.matrix;
        let determinant = xx * yy - xy * xy;
        (determinant, Vec2::new(yy * m.x - xy * m.y, xx * m.y - xy * m.x) / determinant)
    }
}
