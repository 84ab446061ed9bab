//! Meshes as 3D printing needs them: neighbours share their vertices.

use bilux_math::Vec3;
use bilux_scene::Mesh;
use std::collections::HashMap;

/// A mesh whose vertices differ in place.
pub(super) struct Welded {
    pub(super) positions: Vec<Vec3>,
    /// Triples of these, and of the vertices of the mesh.
    pub(super) triangles: Vec<([u32; 3], [u32; 3])>,
    /// Triangles that cannot be stored.
    pub(super) dropped: usize,
}

impl Welded {
    pub(super) fn of(mesh: &Mesh) -> Welded {
        let mut welded = Welded { positions: Vec::new(), triangles: Vec::new(), dropped: 0 };
        let mut known: HashMap<[u32; 3], u32> = HashMap::new();
        for triangle in &mesh.triangles {
            let corners = triangle.map(|i| mesh.positions[i as usize]);
            if !corners.iter().all(|p| p.is_finite())
                || corners[0] == corners[1]
                || corners[1] == corners[2]
                || corners[2] == corners[0]
            {
                welded.dropped += 1;
                continue;
            }
            let places = corners.map(|p| {
                // Zero has two signs.
                let bits = (p + Vec3::ZERO).to_array().map(f32::to_bits);
                *known.entry(bits).or_insert_with(|| {
                    welded.positions.push(p);
                    (welded.positions.len() - 1) as u32
                })
            });
            welded.triangles.push((places, *triangle));
        }
        welded
    }

    /// True if each edge belongs to one triangle in each direction. [3MF Core 1.3, 4.1]
    pub(super) fn is_closed(&self) -> bool {
        let mut edges: HashMap<[u32; 2], u32> = HashMap::new();
        for ([a, b, c], _) in &self.triangles {
            for edge in [[*a, *b], [*b, *c], [*c, *a]] {
                *edges.entry(edge).or_default() += 1;
            }
        }
        edges.iter().all(|([a, b], count)| *count == 1 && edges.get(&[*b, *a]) == Some(&1))
    }
}
