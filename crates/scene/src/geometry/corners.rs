//! Corners of triangles: positions, texture coordinates, and the tangents derived from them.

use crate::mesh::Mesh;
use crate::surface::gamma;
use crate::texture::UvPair;
use bilux_math::{Transform, Vec2, Vec3};

/// The texture coordinates of a triangle's corners; without any in the mesh, barycentric coordinates.
pub(crate) fn triangle_uvs(mesh: &Mesh, triangle: [u32; 3]) -> [Vec2; 3] {
    if mesh.uvs.is_empty() { [Vec2::ZERO, Vec2::X, Vec2::Y] } else { triangle.map(|i| mesh.uvs[i as usize]) }
}

/// The texture coordinate pairs of every triangle's corners.
pub(crate) fn corner_uvs(mesh: &Mesh) -> Vec<[UvPair; 3]> {
    mesh.triangles.iter().map(|t| uv_pairs(mesh, *t)).collect()
}

/// The texture coordinate pairs of one triangle's corners.
#[inline]
pub(crate) fn uv_pairs(mesh: &Mesh, triangle: [u32; 3]) -> [UvPair; 3] {
    let first = triangle_uvs(mesh, triangle);
    let second = if mesh.uvs2.is_empty() { first } else { triangle.map(|i| mesh.uvs2[i as usize]) };
    std::array::from_fn(|i| UvPair([first[i], second[i]]))
}

/// The unit tangent along the first texture coordinate, and the tangent along the second; `None` where the coordinates
/// do not define them. [pbrt 2023, 6.5.2]
pub(crate) fn tangents([a, b, c]: [Vec3; 3], uvs: [Option<Vec2>; 3]) -> Option<(Vec3, Vec3)> {
    let [uv_a, uv_b, uv_c] = [uvs[0]?, uvs[1]?, uvs[2]?];
    let (b_side, c_side) = (uv_b - uv_a, uv_c - uv_a);
    let determinant = b_side.perp_dot(c_side);
    let sign = 1f32.copysign(determinant);
    let along_u = ((b - a) * c_side.y - (c - a) * b_side.y) * sign;
    let along_v = ((c - a) * b_side.x - (b - a) * c_side.x) * sign;
    along_u.try_normalize().filter(|_| determinant != 0.0).map(|u| (u, along_v))
}

/// The corners of all triangles, transformed to world space.
pub(crate) fn world_corners(mesh: &Mesh, to_world: &Transform) -> impl Iterator<Item = [[f32; 3]; 3]> {
    let still = to_world.is_identity();
    mesh.triangles.iter().map(move |t| {
        t.map(|i| {
            let p = mesh.positions[i as usize];
            if still { p.to_array() } else { to_world.point(p).to_array() }
        })
    })
}

/// A transformed point, with the bound on its error. [pbrt 2023, 6.8.5]
pub(crate) fn transform_with_error(to_world: &Transform, p: Vec3, error: Vec3) -> (Vec3, Vec3) {
    let m = to_world.matrix();
    let abs = |v: Vec3| {
        m.x_axis.truncate().abs() * v.x + m.y_axis.truncate().abs() * v.y + m.z_axis.truncate().abs() * v.z
    };
    let rounding = (abs(p.abs()) + m.w_axis.truncate().abs()) * gamma(4);
    (to_world.point(p), abs(error) * (1.0 + gamma(4)) + rounding)
}
