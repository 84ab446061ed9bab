//! Affine transforms with their inverses, computed in f64 and used in f32.

use crate::Aabb;
use glam::{DMat4, Mat4, Vec3};

/// An invertible affine map, stored with its inverse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    forward: Mat4,
    inverse: Mat4,
}

impl Default for Transform {
    fn default() -> Transform {
        Transform::IDENTITY
    }
}

impl Transform {
    /// The identity.
    pub const IDENTITY: Transform = Transform { forward: Mat4::IDENTITY, inverse: Mat4::IDENTITY };

    /// Creates a transform from a matrix of column vectors; `None` when it is not affine, not finite or not
    /// invertible.
    pub fn from_matrix(matrix: DMat4) -> Option<Transform> {
        let affine = matrix.row(3) == glam::DVec4::W && matrix.is_finite();
        // The inverse is that of the rounded matrix, so that a matrix written to a file and read again is the same
        // map.
        let forward = matrix.as_mat4();
        let rounded = forward.as_dmat4();
        let inverse = rounded.inverse().as_mat4();
        let sound = forward.is_finite() && inverse.is_finite() && rounded.determinant() != 0.0;
        (affine && sound).then_some(Transform { forward, inverse })
    }

    /// The transform of a matrix of column vectors and its inverse, as they came from one; `None` when one of them is not
    /// affine or not finite.
    pub fn from_inverses(forward: Mat4, inverse: Mat4) -> Option<Transform> {
        let is_sound = |m: &Mat4| m.row(3) == glam::Vec4::W && m.is_finite();
        (is_sound(&forward) && is_sound(&inverse)).then_some(Transform { forward, inverse })
    }

    /// Translates by `offset`; `None` when that is not finite.
    pub fn translate(offset: Vec3) -> Option<Transform> {
        Transform::from_matrix(DMat4::from_translation(offset.as_dvec3()))
    }

    /// Rotates by `radians` about an axis through the origin, counter-clockwise seen from where the axis points;
    /// `None` when the axis has no length, or something is not finite.
    pub fn rotate(axis: Vec3, radians: f32) -> Option<Transform> {
        let axis = axis.as_dvec3().try_normalize()?;
        Transform::from_matrix(DMat4::from_axis_angle(axis, f64::from(radians)))
    }

    /// Scales along the axes; `None` when a factor is 0 or not finite.
    pub fn scale(factors: Vec3) -> Option<Transform> {
        Transform::from_matrix(DMat4::from_scale(factors.as_dvec3()))
    }

    /// First `self`, then `next`.
    pub fn then(&self, next: &Transform) -> Transform {
        Transform { forward: next.forward * self.forward, inverse: self.inverse * next.inverse }
    }

    /// True when this is the identity, to the bit.
    pub fn is_identity(&self) -> bool {
        *self == Transform::IDENTITY
    }

    /// The matrix from local to world.
    pub fn matrix(&self) -> &Mat4 {
        &self.forward
    }

    /// The matrix from world to local.
    pub fn inverse_matrix(&self) -> &Mat4 {
        &self.inverse
    }

    /// The inverse map.
    pub fn inverted(&self) -> Transform {
        Transform { forward: self.inverse, inverse: self.forward }
    }

    /// Transforms a point.
    #[inline]
    pub fn point(&self, p: Vec3) -> Vec3 {
        self.forward.transform_point3(p)
    }

    /// Transforms a vector.
    #[inline]
    pub fn vector(&self, v: Vec3) -> Vec3 {
        self.forward.transform_vector3(v)
    }

    /// Transforms a normal (by the inverse transpose); not normalised.
    #[inline]
    pub fn normal(&self, n: Vec3) -> Vec3 {
        let along = |axis: glam::Vec4| axis.truncate().dot(n);
        Vec3::new(along(self.inverse.x_axis), along(self.inverse.y_axis), along(self.inverse.z_axis))
    }

    /// The bounding box of a transformed box.
    pub fn bounds(&self, bounds: &Aabb) -> Aabb {
        if bounds.is_empty() { Aabb::EMPTY } else { Aabb::of_points(bounds.corners().map(|c| self.point(c))) }
    }

    /// True when it swaps handedness.
    pub fn mirrors(&self) -> bool {
        self.forward.determinant() < 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn a_matrix_round_trips_to_the_same_map() {
        let matrix = DMat4::from_translation(DVec3::new(-1.2, 0.0, -0.42))
            * DMat4::from_rotation_y(204f64.to_radians());
        let made = Transform::from_matrix(matrix).unwrap();
        assert_eq!(made, Transform::from_matrix(made.matrix().as_dmat4()).unwrap());
    }

    #[test]
    fn named_constructors_compose_in_order() {
        let moved = Transform::translate(Vec3::X).unwrap();
        let turned = Transform::rotate(Vec3::Z * 3.0, std::f32::consts::FRAC_PI_2).unwrap();
        let grown = Transform::scale(Vec3::new(1.0, 2.0, -1.0)).unwrap();
        let all = moved.then(&turned).then(&grown);
        assert!(all.point(Vec3::ZERO).abs_diff_eq(Vec3::Y * 2.0, 1e-6), "{}", all.point(Vec3::ZERO));
        assert!(all.mirrors() && all.then(&all.inverted()).point(Vec3::ONE).abs_diff_eq(Vec3::ONE, 1e-6));
        assert_eq!(Transform::translate(Vec3::NAN), None);
        assert_eq!(Transform::rotate(Vec3::ZERO, 1.0), None);
        assert_eq!(Transform::scale(Vec3::X), None);
    }

    #[test]
    fn singular_matrices_are_rejected() {
        assert_eq!(Transform::from_matrix(DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0))), None);
        assert_eq!(Transform::from_matrix(DMat4::from_scale(DVec3::splat(1e300))), None);
        assert_eq!(Transform::from_matrix(DMat4::from_translation(DVec3::splat(f64::NAN))), None);
    }
}
