//! Whether a mesh has an inside.

use crate::mesh::Mesh;
use bilux_math::Vec3;
use bilux_math::hash::mix64;
use rayon::prelude::*;

impl Mesh {
    /// True if a mesh is closed and has an inside: along each edge, counting vertices at the same position as one, it has as many triangles
    /// in one direction as in the other. Edges are told from each other by hashes alone.
    pub fn is_closed(&self) -> bool {
        // -0 equals 0.
        let place =
            |p: &Vec3| p.to_array().iter().fold(0, |hash, c| mix64(hash ^ u64::from((c + 0.0).to_bits())));
        let places: Vec<u64> = self.positions.par_iter().map(place).collect();
        let edge = |[from, to]: [u64; 2]| match from.cmp(&to) {
            std::cmp::Ordering::Less => mix64(from ^ to.rotate_left(32)),
            std::cmp::Ordering::Equal => 0,
            std::cmp::Ordering::Greater => mix64(to ^ from.rotate_left(32)).wrapping_neg(),
        };
        let around = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|i| places[i as usize]);
            edge([a, b]).wrapping_add(edge([b, c])).wrapping_add(edge([c, a]))
        };
        !self.triangles.is_empty()
            && self.triangles.par_iter().map(around).reduce(|| 0, u64::wrapping_add) == 0
    }

    /// The volume inside a closed mesh, in units of its space cubed: negative where its faces look inwards.
    pub fn signed_volume(&self) -> f64 {
        let Some(first) = self.positions.first() else { return 0.0 };
        let beyond = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|i| (self.positions[i as usize] - *first).as_dvec3());
            a.dot(b.cross(c)) / 6.0
        };
        self.triangles.iter().map(beyond).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generators::shapes;
    use bilux_math::Aabb;

    #[test]
    fn boxes_and_spheres_are_closed_and_sheets_are_not() {
        let mut cuboid = shapes::cuboid(Aabb { min: Vec3::ZERO, max: Vec3::ONE });
        assert!(cuboid.is_closed() && (cuboid.signed_volume() - 1.0).abs() < 1e-6);
        cuboid.triangles[3].reverse();
        assert!(!cuboid.is_closed(), "a triangle faces inwards");
        cuboid.triangles.remove(3);
        assert!(!cuboid.is_closed());
        assert!(!shapes::quad(Vec3::ZERO, Vec3::X, Vec3::Y).is_closed() && !Mesh::default().is_closed());
    }
}
