//! The zero isosurface of a field, closed by construction: marching tetrahedra. [Doi 1991]

use bilux_math::Vec3;
use bilux_math::glam::UVec3;
use bilux_scene::Mesh;
use std::collections::HashMap;

/// A field sampled at the corners of `cells.x · cells.y · cells.z` boxes, negative inside.
pub(crate) struct Samples {
    /// The number of boxes along each axis; there is one more corner than boxes.
    pub(crate) cells: UVec3,
    /// The field at every corner, x fastest, then y.
    pub(crate) values: Vec<f32>,
}

/// The six tetrahedra around a box's long diagonal, by corners: bit 0 is x, bit 1 y, bit 2 z.
///
/// The faces of neighbouring boxes are cut along the same diagonal, so that the surface has no gaps.
const TETRAHEDRA: [[u32; 4]; 6] =
    [[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]];

impl Samples {
    fn corner(&self, cell: UVec3, corner: u32) -> u32 {
        let at = cell + UVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
        let row = self.cells + 1;
        (at.z * row.y + at.y) * row.x + at.x
    }

    /// The grid coordinates of a corner.
    pub(crate) fn place(cells: UVec3, corner: u32) -> UVec3 {
        let row = cells + 1;
        UVec3::new(corner % row.x, corner / row.x % row.y, corner / (row.x * row.y))
    }

    /// The surface, counter-clockwise from outside; `position(corner)` is where the field was sampled.
    ///
    /// A vertex belongs to one edge between two samples and is created once, whichever tetrahedra share it.
    pub(crate) fn surface(&self, position: impl Fn(UVec3) -> Vec3) -> Mesh {
        let mut maker = Maker { samples: self, position, made: HashMap::new(), mesh: Mesh::default() };
        let UVec3 { x, y, z } = self.cells;
        for cell in (0..z).flat_map(|k| (0..y).flat_map(move |j| (0..x).map(move |i| UVec3::new(i, j, k)))) {
            let corners: [u32; 8] = std::array::from_fn(|c| self.corner(cell, c as u32));
            let inside = corners.iter().filter(|&&c| self.values[c as usize] < 0.0).count();
            if inside != 0 && inside != 8 {
                for tetrahedron in TETRAHEDRA {
                    maker.cut(tetrahedron.map(|c| corners[c as usize]));
                }
            }
        }
        maker.mesh
    }
}

struct Maker<'a, P> {
    samples: &'a Samples,
    position: P,
    made: HashMap<(u32, u32), u32>,
    mesh: Mesh,
}

impl<P: Fn(UVec3) -> Vec3> Maker<'_, P> {
    /// The triangles of one tetrahedron; the corners are in an order of positive volume.
    fn cut(&mut self, corners: [u32; 4]) {
        let is_inside = |c: u32| self.samples.values[c as usize] < 0.0;
        // Even permutations move the odd corner, or the inside pair, to the front and keep the orientation.
        let [a, b, c, d] = corners;
        let inside = corners.map(is_inside);
        match inside {
            [true, false, false, false] => self.tip([a, b, c, d], false),
            [false, true, false, false] => self.tip([b, a, d, c], false),
            [false, false, true, false] => self.tip([c, d, a, b], false),
            [false, false, false, true] => self.tip([d, c, b, a], false),
            [false, true, true, true] => self.tip([a, b, c, d], true),
            [true, false, true, true] => self.tip([b, a, d, c], true),
            [true, true, false, true] => self.tip([c, d, a, b], true),
            [true, true, true, false] => self.tip([d, c, b, a], true),
            [true, true, false, false] => self.wedge([a, b, c, d]),
            [true, false, true, false] => self.wedge([a, c, d, b]),
            [true, false, false, true] => self.wedge([a, d, b, c]),
            [false, true, true, false] => self.wedge([b, c, a, d]),
            [false, true, false, true] => self.wedge([b, d, c, a]),
            [false, false, true, true] => self.wedge([c, d, a, b]),
            _ => {}
        }
    }

    /// One corner on one side, three on the other.
    fn tip(&mut self, [a, b, c, d]: [u32; 4], outside: bool) {
        let [p, q, r] = [b, c, d].map(|other| self.vertex(a, other));
        self.mesh.triangles.push(if outside { [p, r, q] } else { [p, q, r] });
    }

    /// The first two corners inside, the other two outside.
    fn wedge(&mut self, [a, b, c, d]: [u32; 4]) {
        let [p, q, r, s] = [(a, c), (a, d), (b, d), (b, c)].map(|(i, o)| self.vertex(i, o));
        self.mesh.triangles.extend([[p, q, r], [p, r, s]]);
    }

    fn vertex(&mut self, a: u32, b: u32) -> u32 {
        let (a, b) = (a.min(b), a.max(b));
        let (samples, position, mesh) = (self.samples, &self.position, &mut self.mesh);
        *self.made.entry((a, b)).or_insert_with(|| {
            let [fa, fb] = [a, b].map(|c| samples.values[c as usize]);
            // Keep away from the ends, where the vertices of several edges would coincide.
            let t = (fa / (fa - fb)).clamp(0.02, 0.98);
            let [pa, pb] = [a, b].map(|c| position(Samples::place(samples.cells, c)));
            mesh.positions.push(pa + (pb - pa) * t);
            mesh.positions.len() as u32 - 1
        })
    }
}
