//! A point on a triangle, and its normals.

use crate::mesh::Mesh;
use crate::surface::{gamma, unit_or};
use bilux_math::{Transform, Vec3};

/// A point of a surface in world space, with its normals; see [`crate::Surface`] for the fields.
pub(crate) struct SurfacePoint {
    pub(crate) p: Vec3,
    pub(crate) p_error: Vec3,
    pub(crate) n_geom: Vec3,
    pub(crate) n_shade: Vec3,
}

impl SurfacePoint {
    /// The point `p` of a triangle with these corners, whose interpolated normal is given if the mesh has normals.
    #[inline]
    pub(super) fn new(
        p: Vec3,
        p_error: Vec3,
        [a, b, c]: [Vec3; 3],
        mirrors: bool,
        normal: Option<Vec3>,
    ) -> SurfacePoint {
        let winding = unit_or((b - a).cross(c - a), Vec3::Y) * if mirrors { -1.0 } else { 1.0 };
        let n_shade = normal.map_or(winding, |n| unit_or(n, winding));
        let n_geom = if n_shade.dot(winding) < 0.0 { -winding } else { winding };
        SurfacePoint { p, p_error, n_geom, n_shade }
    }
}

/// The point with these barycentric weights, and the bound on its error.
#[inline]
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

#[inline]
fn blend(v: [Vec3; 3], weights: [f32; 3]) -> Vec3 {
    v[0] * weights[0] + v[1] * weights[1] + v[2] * weights[2]
}
