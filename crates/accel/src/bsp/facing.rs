//! Which way the triangles of a partition face, so that back faces can be left out together.

use crate::mesh::TriangleMesh;
use crate::triangle::PreparedRay;
use bilux_math::{Aabb, DVec3, Vec3};

/// The common orientation of a few triangles, and how far each may be from it.
///
/// The triangle test calls a triangle a back face by the sign of its sheared area, which is exact for the
/// sheared vertices; those are off by at most 6 units of rounding of `far`. With edges no longer than `L`
/// and twice the area `2A`, that sign is beyond doubt where the unit normal and the ray's direction
/// have a cosine above `24 · 6 · 2⁻²⁴ · far · L / 2A`, which is nine times [`PreparedRay::pad`] times the
/// `roughness` L / 2A. Sixteen are granted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facing {
    normal: Vec3,
    /// Longest difference between `normal` and the unit normal of a triangle.
    spread: f32,
    /// Greatest longest edge over twice the area.
    roughness: f32,
}

impl Facing {
    /// The mean orientation of some triangles; `None` when they have none, or rays of no direction could
    /// be known to see nothing but backs.
    pub(super) fn of(mesh: &TriangleMesh, triangles: &[u32]) -> Option<Facing> {
        let corners = || triangles.iter().map(|&index| mesh.triangles()[index as usize]);
        let mut sum = DVec3::ZERO;
        for triangle in corners() {
            sum += orientation(&triangle)?;
        }
        let normal = sum.try_normalize()?.as_vec3();
        let (mut spread, mut roughness) = (0f64, 0f64);
        for triangle in corners() {
            spread = spread.max((orientation(&triangle)? - normal.as_dvec3()).length());
            roughness = roughness.max(edge_over_area(&triangle));
        }
        let (spread, roughness) = (spread as f32 * ROUND_UP + EVALUATION, roughness as f32 * ROUND_UP);
        (spread < 1.0 && roughness.is_finite()).then_some(Facing { normal, spread, roughness })
    }
}

/// Unit normal towards the side from which the vertices run counter-clockwise; `None` without area.
pub(super) fn orientation(triangle: &[[f32; 3]; 3]) -> Option<DVec3> {
    let [a, b, c] = triangle.map(|vertex| Vec3::from(vertex).as_dvec3());
    (b - a).cross(c - a).try_normalize()
}

fn edge_over_area(triangle: &[[f32; 3]; 3]) -> f64 {
    let [a, b, c] = triangle.map(|vertex| Vec3::from(vertex).as_dvec3());
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    longest / (b - a).cross(c - a).length()
}

/// Makes up for the rounding to f32.
const ROUND_UP: f32 = 1.000_001;

/// Makes up for the rounding of a dot product of three, and of the normal.
const EVALUATION: f32 = 16.0 / 16_777_216.0;

/// What a ray needs to be asked whether it sees backs only.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    direction: Vec3,
    length: f32,
    margin: f32,
}

impl View {
    /// For a ray through a mesh of these bounds.
    pub(super) fn new(ray: &PreparedRay, bounds: &Aabb) -> View {
        let direction = Vec3::from(ray.ray.direction);
        let length = direction.as_dvec3().length() as f32;
        View { direction, length: length * ROUND_UP, margin: 16.0 * ray.pad(bounds) }
    }

    /// True when the triangle test, with back faces culled, is sure to reject every one of these triangles.
    #[inline]
    pub(super) fn sees_backs_only(&self, facing: &Facing) -> bool {
        let least = facing.spread + self.margin * facing.roughness;
        facing.normal.dot(self.direction) > least * self.length
    }
}
