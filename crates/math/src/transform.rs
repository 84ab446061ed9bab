//! Affine transforms with their inverses, made in f64 and used in f32.

use crate::Aabb;
use glam::{DMat4, Mat4, Vec3};

/// An invertible affine map of space, kept with its inverse.
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
    /// The map that moves nothing.
    pub const IDENTITY: Transform = Transform { forward: Mat4::IDENTITY, inverse: Mat4::IDENTITY };

    /// From a matrix of column vectors; `None` when it is not affine, not finite or not invertible.
    pub fn from_matrix(matrix: DMat4) -> Option<Transform> {
        let inverse = matrix.inverse();
        let affine = matrix.row(3) == glam::DVec4::W;
        let sound = affine && matrix.is_finite() && inverse.is_finite() && matrix.determinant() != 0.0;
        let (forward, inverse) = (matrix.as_mat4(), inverse.as_mat4());
        (sound && forward.is_finite() && inverse.is_finite()).then_some(Transform { forward, inverse })
    }

    /// First `self`, then `next`.
    pub fn then(&self, next: &Transform) -> Transform {
        Transform { forward: next.forward * self.forward, inverse: self.inverse * next.inverse }
    }

    /// True when this moves nothing, to the bit.
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

    /// The opposite map.
    pub fn inverted(&self) -> Transform {
        Transform { forward: self.inverse, inverse: self.forward }
    }

    /// Moves a point.
    #[inline]
    pub fn point(&self, p: Vec3) -> Vec3 {
        self.forward.transform_point3(p)
    }

    /// Moves a vector.
    #[inline]
    pub fn vector(&self, v: Vec3) -> Vec3 {
        self.forward.transform_vector3(v)
    }

    /// Moves a normal (by the inverse transpose); not normalised.
    #[inline]
    pub fn normal(&self, n: Vec3) -> Vec3 {
        self.inverse.transpose().transform_vector3(n)
    }

    /// The box around a moved box.
    pub fn bounds(&self, bounds: &Aabb) -> Aabb {
        if bounds.is_empty() { Aabb::EMPTY } else { Aabb::of_points(bounds.corners().map(|c| self.point(c))) }
    }

    /// True when it turns right-handed into left-handed.
    pub fn mirrors(&self) -> bool {
        self.forward.determinant() < 0.0
    }
}
