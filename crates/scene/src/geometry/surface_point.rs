//! A point on a triangle, and its normals: one at a time, or in loops over many.

use crate::mesh::Mesh;
use crate::surface::{gamma, unit_or};
use bilux_math::{Transform, Vec3};

/// The geometric and the shading normal of a triangle in world space, whose interpolated normal is given if the mesh has
/// normals.
#[inline]
pub(super) fn normals_of([a, b, c]: [Vec3; 3], mirrors: bool, normal: Option<Vec3>) -> [Vec3; 2] {
    let winding = unit_or((b - a).cross(c - a), Vec3::Y) * if mirrors { -1.0 } else { 1.0 };
    let n_shade = normal.map_or(winding, |n| unit_or(n, winding));
    [if n_shade.dot(winding) < 0.0 { -winding } else { winding }, n_shade]
}

/// A triangle that does not move, with all that a point on it needs.
#[derive(Clone, Copy, Debug)]
pub struct StillTriangle {
    /// Corners in world space.
    pub corners: [Vec3; 3],
    /// The normals of its corners in object space; zero where the mesh has none, so that the triangle's own counts.
    pub normals: [Vec3; 3],
    /// The axes of the inverse of its object's transform.
    pub inverse: [Vec3; 3],
    /// The orientation of its front: -1 if mirrored, otherwise 1.
    pub turn: f32,
}

/// A point of a triangle in world space: `p`, the bound on its rounding error, and the geometric and shading normals.
pub type PointAndNormals = [Vec3; 4];

impl StillTriangle {
    /// The point at a hit with these barycentric coordinates, as [`super::Geometry::surface`] computes it, bit for bit.
    /// Compiles to vector instructions in a loop.
    #[inline(always)]
    pub fn point(&self, u: f32, v: f32) -> PointAndNormals {
        let StillTriangle { corners: [a, b, c], normals, inverse, turn } = *self;
        let weights = [1.0 - u - v, u, v];
        let (p, p_error) = point_with_error([a, b, c], weights);
        let winding = unit_or_lane((b - a).cross(c - a), Vec3::Y) * turn;
        let n = blend(normals, weights);
        let n = Vec3::new(inverse[0].dot(n), inverse[1].dot(n), inverse[2].dot(n));
        let n_shade = unit_or_lane(n, winding);
        [p, p_error, pick(n_shade.dot(winding) < 0.0, -winding, winding), n_shade]
    }
}

/// [`unit_or`] without branches.
#[inline(always)]
fn unit_or_lane(n: Vec3, fallback: Vec3) -> Vec3 {
    let inverse = 1.0 / n.length_squared().sqrt();
    pick(inverse.is_finite() & (inverse > 0.0), n * inverse, fallback)
}

#[inline(always)]
fn pick(first: bool, a: Vec3, b: Vec3) -> Vec3 {
    let of = |a: f32, b: f32| if first { a } else { b };
    Vec3::new(of(a.x, b.x), of(a.y, b.y), of(a.z, b.z))
}

/// The point with these barycentric weights, and the bound on its error.
#[inline(always)]
pub(super) fn point_with_error(corners: [Vec3; 3], weights: [f32; 3]) -> (Vec3, Vec3) {
    (blend(corners, weights), blend(corners.map(Vec3::abs), weights) * gamma(7))
}

/// The interpolated normal in world space, if the mesh has normals.
#[inline]
pub(super) fn normal_at(
    mesh: &Mesh,
    triangle: [u32; 3],
    weights: [f32; 3],
    to_world: &Transform,
) -> Option<Vec3> {
    let normals = || triangle.map(|i| mesh.normals[i as usize]);
    (!mesh.normals.is_empty()).then(|| to_world.normal(blend(normals(), weights)))
}

#[inline(always)]
fn blend(v: [Vec3; 3], weights: [f32; 3]) -> Vec3 {
    v[0] * weights[0] + v[1] * weights[1] + v[2] * weights[2]
}
