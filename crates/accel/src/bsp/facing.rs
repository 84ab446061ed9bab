//! Which way the triangles of a partition face, so that back faces can be culled together.

use crate::mesh::TriangleMesh;
use crate::triangle::PreparedRay;
use bilux_math::{Aabb, DVec3, Vec3};

/// The common orientation of a run of triangles, and how far each triangle may deviate from it.
///
/// The triangle test decides that a triangle is back-facing by the sign of its sheared area, which is exact for the
/// sheared vertices; those are off by at most 6 units of rounding of `far`. With edges no longer than `L` and twice
/// the area `2A`, that sign is certain where the unit normal and the ray's direction have a cosine above
/// `24 · 6 · 2⁻²⁴ · far · L / 2A`, which is nine times [`PreparedRay::pad`] times the `roughness` L / 2A. The code
/// allows sixteen times.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facing {
    /// The number of triangles in the run.
    pub(super) count: u32,
    normal: Vec3,
    /// Largest difference between `normal` and the unit normal of a triangle.
    spread: f32,
    /// Largest ratio of longest edge to twice the area.
    roughness: f32,
}

impl Facing {
    /// For at least one triangle, each with a non-zero area.
    fn of(mesh: &TriangleMesh, run: &[u32]) -> Facing {
        let corners = || run.iter().map(|&index| &mesh.triangles()[index as usize]);
        let sum: DVec3 = corners().filter_map(orientation).sum();
        let normal = sum.normalize_or_zero().as_vec3();
        let difference = |normal_of_one: DVec3| (normal_of_one - normal.as_dvec3()).length();
        let spread = corners().filter_map(orientation).map(difference).fold(0.0, f64::max);
        let roughness = corners().map(edge_over_area).fold(0.0, f64::max);
        Facing {
            count: run.len() as u32,
            normal,
            spread: spread as f32 * ROUND_UP + EVALUATION,
            roughness: roughness as f32 * ROUND_UP,
        }
    }

    /// For triangles without area, about which nothing is known.
    fn unknown(count: usize) -> Facing {
        Facing { count: count as u32, normal: Vec3::ZERO, spread: f32::INFINITY, roughness: f32::INFINITY }
    }
}

/// Groups the triangles of a partition into runs that face much the same way; each run follows its first triangle.
pub(super) fn in_runs(mesh: &TriangleMesh, triangles: &[u32]) -> (Vec<u32>, Vec<Facing>) {
    let facing = |&index: &u32| Some((index, orientation(&mesh.triangles()[index as usize])?));
    let mut oriented: Vec<(u32, DVec3)> = triangles.iter().filter_map(facing).collect();
    let (mut order, mut facings) = (Vec::with_capacity(triangles.len()), Vec::new());
    while let Some(&(_, first)) = oriented.first() {
        let (run, rest) = oriented.into_iter().partition(|(_, normal)| normal.dot(first) >= ALIKE);
        oriented = rest;
        let start = order.len();
        order.extend(Vec::<(u32, DVec3)>::into_iter(run).map(|(index, _)| index));
        facings.push(Facing::of(mesh, &order[start..]));
    }
    let start = order.len();
    order.extend(triangles.iter().filter(|&index| facing(index).is_none()));
    if order.len() > start {
        facings.push(Facing::unknown(order.len() - start));
    }
    (order, facings)
}

/// Minimum cosine between normals that count as facing alike.
const ALIKE: f64 = 0.9;

/// Unit normal on the side from which the vertices run counter-clockwise; `None` without area.
pub(super) fn orientation(triangle: &[[f32; 3]; 3]) -> Option<DVec3> {
    let [a, b, c] = triangle.map(|vertex| Vec3::from(vertex).as_dvec3());
    (b - a).cross(c - a).try_normalize()
}

fn edge_over_area(triangle: &[[f32; 3]; 3]) -> f64 {
    let [a, b, c] = triangle.map(|vertex| Vec3::from(vertex).as_dvec3());
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    longest / (b - a).cross(c - a).length()
}

/// Compensates for the rounding to f32.
const ROUND_UP: f32 = 1.000_001;

/// Compensates for the rounding of a three-term dot product and of the normal.
const EVALUATION: f32 = 16.0 / 16_777_216.0;

/// Values of a ray that decide whether it sees only back faces.
#[derive(Clone, Copy, Debug)]
pub(super) struct RayView {
    direction: Vec3,
    length: f32,
    margin: f32,
}

impl RayView {
    /// For a ray through a mesh of these bounds.
    pub(super) fn new(ray: &PreparedRay, bounds: &Aabb) -> RayView {
        let direction = Vec3::from(ray.ray.direction);
        let length = direction.as_dvec3().length() as f32;
        RayView { direction, length: length * ROUND_UP, margin: 16.0 * ray.pad(bounds) }
    }

    /// True when the triangle test, with back faces culled, is certain to reject every one of these triangles.
    #[inline]
    pub(super) fn sees_backs_only(&self, facing: &Facing) -> bool {
        let least = facing.spread + self.margin * facing.roughness;
        facing.normal.dot(self.direction) > least * self.length
    }
}
