//! Triangles with what shading needs of them.

use bilux_math::glam::Vec4;
use bilux_math::{Aabb, Rgb, Vec2, Vec3};

/// A triangle mesh in its own space. Attributes are per vertex and either absent (empty) or as many as
/// positions; [`crate::SceneBuilder::build`] checks that.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// What the file calls it; may be empty.
    pub name: String,
    /// Vertices.
    pub positions: Vec<Vec3>,
    /// Shading normals; need not be of unit length.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, v upwards.
    pub uvs: Vec<Vec2>,
    /// A second set of these, for textures that ask for it.
    pub uvs2: Vec<Vec2>,
    /// Along the surface as u grows, with 1 where v grows along normal × tangent and -1 where it grows the other way;
    /// where there are none, they follow from the texture coordinates of each triangle.
    pub tangents: Vec<Vec4>,
    /// Diffuse reflectance per vertex (the paper's Kd).
    pub vertex_kd: Vec<Rgb>,
    /// Specular reflectance per vertex (the paper's Ks).
    pub vertex_ks: Vec<Rgb>,
    /// Triples of vertices.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Bytes that it holds.
    pub fn size(&self) -> u64 {
        let triples = self.positions.len() + self.normals.len() + self.triangles.len();
        let colours = self.vertex_kd.len() + self.vertex_ks.len();
        let uvs = self.uvs.len() + self.uvs2.len();
        4 * (3 * (triples + colours) + 2 * uvs + 4 * self.tangents.len()) as u64
    }

    /// The box around all vertices that triangles name.
    pub fn bounds(&self) -> Aabb {
        let named = self.triangles.iter().flatten().filter_map(|&i| self.positions.get(i as usize));
        Aabb::of_points(named.copied().filter(|p| p.is_finite()))
    }

    /// Area-weighted vertex normals from the triangles, for meshes that bring none.
    pub fn smooth_normals(&self) -> Vec<Vec3> {
        let mut normals = vec![Vec3::ZERO; self.positions.len()];
        for &[a, b, c] in &self.triangles {
            let [pa, pb, pc] = [a, b, c].map(|i| self.positions[i as usize]);
            let n = (pb - pa).cross(pc - pa);
            for i in [a, b, c] {
                normals[i as usize] += n;
            }
        }
        normals.iter().map(|n| n.normalize_or_zero()).collect()
    }
}
