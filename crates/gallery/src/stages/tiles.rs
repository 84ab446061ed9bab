//! Tiled surfaces: square tiles of a few shades, with joints between them.

use crate::modelling::parts::chance;
use bilux_math::Vec3;
use bilux_scene::Mesh;

/// A tiled rectangle.
pub(super) struct Tiles {
    /// One corner.
    pub(super) corner: [f32; 3],
    /// Along the rows, and across; visible from the side that `u × v` points to.
    pub(super) edges: [[f32; 3]; 2],
    /// The number of tiles along each edge.
    pub(super) counts: [u32; 2],
    /// The fraction of a tile's side that is joint.
    pub(super) joint: f32,
    /// The seed of the pattern.
    pub(super) pattern: u64,
}

impl Tiles {
    /// The tiles of each shade, and the ground below them that shows in the joints.
    pub(super) fn meshes<const SHADES: usize>(&self) -> ([Mesh; SHADES], Mesh) {
        let [u, v] = self.edges.map(Vec3::from);
        let [columns, rows] = self.counts;
        let (du, dv) = (u / columns as f32, v / rows as f32);
        let corner = Vec3::from(self.corner);
        let mut shades = std::array::from_fn(|_| Mesh { name: "tiles".to_owned(), ..Mesh::default() });
        for (j, i) in (0..rows).flat_map(|j| (0..columns).map(move |i| (j, i))) {
            let shade = (chance(self.pattern, j * columns + i) * SHADES as f32) as usize;
            let inset = 0.5 * self.joint;
            let at = corner + du * (i as f32 + inset) + dv * (j as f32 + inset);
            push(&mut shades[shade.min(SHADES - 1)], at, du * (1.0 - self.joint), dv * (1.0 - self.joint));
        }
        let below = u.cross(v).normalize() * (-0.02 * du.length());
        let mut ground = Mesh { name: "joints".to_owned(), ..Mesh::default() };
        push(&mut ground, corner + below, u, v);
        (shades, ground)
    }
}

fn push(mesh: &mut Mesh, corner: Vec3, u: Vec3, v: Vec3) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend([corner, corner + u, corner + u + v, corner + v]);
    mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
}
