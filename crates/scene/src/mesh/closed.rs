//! Whether a mesh has an inside.

use crate::mesh::Mesh;
use bilux_math::Vec3;
use bilux_math::hash::mix64;
use bilux_math::parallel::{fill, map};
use std::cmp::Ordering;

/// The width of a crack, over the longest side of the mesh.
const CRACK: f32 = 1.0 / 2048.0;
/// Shifts of lattices, in cells: they keep round numbers off the borders between two.
const LATTICES: [f32; 4] = [0.37, 0.83, 0.11, 0.61];

/// Vertices or triangles that one thread takes at a time.
const CHUNK: usize = 1 << 14;

impl Mesh {
    /// True if a mesh is closed, but for cracks that nobody sees: along each edge it has as many triangles in one direction
    /// as in the other, where vertices that are closer than [`CRACK`] count as one.
    pub fn is_closed(&self) -> bool {
        let bounds = self.bounds();
        let cell = bounds.extent().max_element() * CRACK;
        // Close vertices are in the same cell of most lattices.
        !self.triangles.is_empty()
            && cell.is_finite()
            && LATTICES.iter().any(|shift| self.is_closed_by(bounds.min, cell, *shift))
    }

    /// [`Mesh::is_closed`] where vertices in the same cell of a lattice count as one. Edges are told from each other by hashes alone: the
    /// sum over all is 0 where each is cancelled by one that runs the other way. Merging vertices never opens what is closed.
    fn is_closed_by(&self, min: Vec3, cell: f32, shift: f32) -> bool {
        let place = |p: Vec3| {
            let at = if cell > 0.0 { ((p - min) / cell + shift).to_array() } else { [0.0; 3] };
            at.iter().fold(0, |hash, c| mix64(hash ^ *c as u64))
        };
        let mut places = vec![0; self.positions.len()];
        fill(&mut places, CHUNK, |i| place(self.positions[i]));
        let edge = |[from, to]: [u64; 2]| match from.cmp(&to) {
            Ordering::Less => mix64(from ^ to.rotate_left(32)),
            Ordering::Equal => 0,
            Ordering::Greater => mix64(to ^ from.rotate_left(32)).wrapping_neg(),
        };
        let around = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|i| places[i as usize]);
            edge([a, b]).wrapping_add(edge([b, c])).wrapping_add(edge([c, a]))
        };
        let sum = |some: &[[u32; 3]]| some.iter().map(around).fold(0, u64::wrapping_add);
        map(self.triangles.chunks(CHUNK), sum).into_iter().fold(0, u64::wrapping_add) == 0
    }

    /// True if a mesh is closed and its faces look outwards.
    pub fn has_inside(&self) -> bool {
        self.is_closed() && self.signed_volume() > 0.0
    }

    /// The volume inside a closed mesh, in units of its space cubed: negative where its faces look inwards.
    pub(crate) fn signed_volume(&self) -> f64 {
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
    use crate::mesh::shapes;
    use bilux_math::Aabb;

    #[test]
    fn boxes_and_spheres_are_closed_and_sheets_are_not() {
        let mut cuboid = shapes::cuboid(Aabb { min: Vec3::ZERO, max: Vec3::ONE });
        assert!(cuboid.has_inside() && (cuboid.signed_volume() - 1.0).abs() < 1e-6);
        let mut inwards = cuboid.clone();
        inwards.triangles.iter_mut().for_each(|triangle| triangle.reverse());
        assert!(inwards.is_closed() && !inwards.has_inside());
        // The seam of a sphere whose sines and cosines are not quite those of a full turn.
        let mut seam = cuboid.clone();
        let copies: Vec<Vec3> = seam.positions.iter().map(|p| *p + Vec3::splat(1e-7)).collect();
        let count = copies.len() as u32;
        seam.positions.extend(copies);
        seam.triangles.iter_mut().step_by(2).flatten().for_each(|corner| *corner += count);
        assert!(seam.is_closed());
        cuboid.triangles[3].reverse();
        assert!(!cuboid.is_closed(), "a triangle faces inwards");
        cuboid.triangles.remove(3);
        assert!(!cuboid.is_closed());
        assert!(!shapes::quad(Vec3::ZERO, Vec3::X, Vec3::Y).is_closed() && !Mesh::default().is_closed());
    }
}
