//! Round bodies as fields that are negative inside, blended into each other, and their meshes.
//!
//! A field is about the distance to the surface, in metres: what is built of them may be a little further away, but not nearer
//! than half of what they say.

use super::isosurface::Samples;
use bilux_math::glam::UVec3;
use bilux_math::{Aabb, Vec3};
use bilux_scene::Mesh;

/// A round cone: two balls and the hull between them.
#[derive(Clone, Copy)]
pub(crate) struct Cone {
    pub(crate) from: Vec3,
    pub(crate) to: Vec3,
    pub(crate) radius: [f32; 2],
}

impl Cone {
    /// Distance to the surface, accurate enough where the thickness changes slowly.
    pub(crate) fn distance(&self, p: Vec3) -> f32 {
        let along = self.to - self.from;
        let t = ((p - self.from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        (p - self.from - along * t).length() - (self.radius[0] + (self.radius[1] - self.radius[0]) * t)
    }
}

/// The distance to an ellipsoid around the origin, to first order.
pub(crate) fn ellipsoid(p: Vec3, radii: Vec3) -> f32 {
    let size = (p / radii).length();
    let slope = (p / (radii * radii)).length() / size.max(1e-6);
    if size < 1e-6 { -radii.min_element() } else { (size - 1.0) / slope }
}

/// A smooth minimum of two numbers: bodies of which both are part, joined by a fillet of about this width.
pub(crate) fn soft_min(a: f32, b: f32, width: f32) -> f32 {
    let overlap = (width - (a - b).abs()).max(0.0);
    a.min(b) - overlap * overlap / (4.0 * width)
}

/// A smooth maximum: what both bodies have in common.
pub(crate) fn soft_max(a: f32, b: f32, width: f32) -> f32 {
    -soft_min(-a, -b, width)
}

/// Box and samples by which a mesh is cut from a field.
pub(crate) struct Cut {
    pub(crate) bounds: Aabb,
    /// The number of boxes along each axis.
    pub(crate) cells: UVec3,
    /// Fraction by which samples at the upper end of each axis are closer than the mean, 0 to below 1; negative for the lower end.
    pub(crate) finer: Vec3,
}

/// Samples in a block, along each axis.
const BLOCK: u32 = 4;

impl Cut {
    /// The closed surface where a field is 0, with normals along its gradient.
    pub(crate) fn mesh(&self, name: &str, field: impl Fn(Vec3) -> f32) -> Mesh {
        let place = |corner: UVec3| self.place(corner);
        let samples = Samples { cells: self.cells, values: self.sampled(&field) };
        let mut mesh = Mesh { name: name.to_owned(), ..samples.surface(place) };
        let step = 0.25 * (self.bounds.extent() / self.cells.as_vec3()).min_element();
        let slope = |p: Vec3| {
            let along = |axis: Vec3| field(p + axis * step) - field(p - axis * step);
            Vec3::new(along(Vec3::X), along(Vec3::Y), along(Vec3::Z)).normalize_or(Vec3::Y)
        };
        mesh.normals = mesh.positions.iter().map(|&p| slope(p)).collect();
        mesh
    }

    fn place(&self, corner: UVec3) -> Vec3 {
        let s = corner.as_vec3() / self.cells.as_vec3();
        self.bounds.min + (s + self.finer * s * (1.0 - s)) * self.bounds.extent()
    }

    /// The field at every corner; in blocks far from the surface, only its value in their middle.
    fn sampled(&self, field: impl Fn(Vec3) -> f32) -> Vec<f32> {
        let corners = self.cells + 1;
        let mut values = vec![0.0; corners.element_product() as usize];
        let blocks = corners.map(|n| n.div_ceil(BLOCK));
        let all = |size: UVec3| {
            (0..size.element_product())
                .map(move |i| UVec3::new(i % size.x, i / size.x % size.y, i / (size.x * size.y)))
        };
        for block in all(blocks) {
            let (first, end) = (block * BLOCK, ((block + 1) * BLOCK).min(corners));
            let (low, high) = (self.place(first), self.place(end - 1));
            let middle = field((low + high) * 0.5);
            // Twice the radius of the block, and the gap to the next one.
            let reach = 1.5 * (high - low).length();
            for corner in all(end - first).map(|inside| first + inside) {
                let index = (corner.z * corners.y + corner.y) * corners.x + corner.x;
                values[index as usize] =
                    if middle.abs() > reach { middle } else { field(self.place(corner)) };
            }
        }
        values
    }
}
