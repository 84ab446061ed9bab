//! Positions of points of surfaces at another time.

use super::Geometry;
use bilux_accel::Hit;
use bilux_math::{DMat4, DVec3, Vec3};

impl Geometry {
    /// The object of a hit and the triangle of its mesh; `None` for points, lines and spheres.
    pub fn triangle_of(&self, hit: &Hit) -> Option<[u32; 2]> {
        let (object, triangle) = self.locate(hit.primitive());
        self.is_triangle(hit.primitive()).then_some([object, triangle])
    }

    /// Positions of the point `p` of a surface that was hit, at two times in seconds: here, and in `next`, which has the same
    /// objects with meshes that may be in another pose. In double precision, for those who measure how far it moves.
    pub fn moved(&self, hit: &Hit, p: Vec3, next: &Geometry, [from, to]: [f32; 2]) -> [DVec3; 2] {
        let still = [p.as_dvec3(); 2];
        let Some([object, triangle]) = self.triangle_of(hit) else {
            // Points and lines move with their object; spheres are lights, which do not.
            let (object, _) = self.locate(hit.primitive());
            let places = self.matrix_of(object, from).zip(next.matrix_of(object, to));
            return match places {
                Some((from, to)) if from != to => {
                    [still[0], to.transform_point3(from.inverse().transform_point3(still[0]))]
                }
                _ => still,
            };
        };
        let (u, v) = (f64::from(hit.u), f64::from(hit.v));
        let at = |geometry: &Geometry, time| geometry.point_of([object, triangle], [1.0 - u - v, u, v], time);
        match (at(self, from), at(next, to)) {
            // Both are computed alike, so that what does not move gives the same point to the bit.
            (Some(from), Some(to)) => [from, to],
            _ => still,
        }
    }

    /// The point of a triangle of a mesh with these barycentric weights.
    fn point_of(&self, [object, triangle]: [u32; 2], weights: [f64; 3], time: f32) -> Option<DVec3> {
        let placed = self.objects.get(object as usize)?;
        let corners = placed.mesh.triangles.get(triangle as usize)?;
        let [a, b, c] = corners.map(|i| placed.mesh.positions.get(i as usize).map(|p| p.as_dvec3()));
        let point = a? * weights[0] + b? * weights[1] + c? * weights[2];
        Some(self.matrix_of(object, time)?.transform_point3(point))
    }

    /// The transform of an object to the world.
    fn matrix_of(&self, object: u32, time: f32) -> Option<DMat4> {
        self.objects.get(object as usize)?;
        Some(self.place(object, time).0.matrix().as_dmat4())
    }
}
