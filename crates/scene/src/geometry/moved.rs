//! Where a point of a surface is at another time.

use super::Geometry;
use bilux_accel::Hit;
use bilux_math::Vec3;

impl Geometry {
    /// The point of a hit at a time in seconds, and the same point of `next` at another time. `next` is this geometry, or
    /// one of the same meshes in another pose: points of triangles keep their place in the mesh; others stay at `p`.
    pub fn moved(&self, hit: &Hit, p: Vec3, next: &Geometry, [from, to]: [f32; 2]) -> [Vec3; 2] {
        if !self.is_triangle(hit.primitive()) {
            return [p; 2];
        }
        let (object, triangle) = self.locate(hit.primitive());
        let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
        let at = |geometry: &Geometry, time| geometry.point_of(object, triangle, weights, time);
        match (at(self, from), at(next, to)) {
            // Both are computed alike, so that what does not move gives the same point to the bit.
            (Some(from), Some(to)) => [from, to],
            _ => [p; 2],
        }
    }

    /// The point of a triangle of a mesh with these barycentric weights.
    fn point_of(&self, object: u32, triangle: u32, weights: [f32; 3], time: f32) -> Option<Vec3> {
        let placed = self.objects.get(object as usize)?;
        let corners = placed.mesh.triangles.get(triangle as usize)?;
        let [a, b, c] = corners.map(|i| placed.mesh.positions.get(i as usize).copied());
        let point = a? * weights[0] + b? * weights[1] + c? * weights[2];
        Some(self.place(object, time).0.point(point))
    }
}
