//! Triangles, points and lines with what shading needs of them.

use bilux_math::glam::Vec4;
use bilux_math::{Aabb, Rgb, Vec2, Vec3};

/// Triangles, points and lines in their own space. Attributes are per vertex and either absent (empty) or as many as
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
    /// Vertices that are points: balls of the scene's width of points.
    pub points: Vec<u32>,
    /// Pairs of vertices that lines join: tubes of the scene's width of lines.
    pub lines: Vec<[u32; 2]>,
}

impl Mesh {
    /// Bytes that it holds.
    pub fn size(&self) -> u64 {
        let triples = self.positions.len() + self.normals.len() + self.triangles.len();
        let colours = self.vertex_kd.len() + self.vertex_ks.len();
        let uvs = self.uvs.len() + self.uvs2.len();
        let strokes = self.points.len() + 2 * self.lines.len();
        4 * (3 * (triples + colours) + 2 * uvs + 4 * self.tangents.len() + strokes) as u64
    }

    /// How many points and lines there are.
    pub fn stroke_count(&self) -> usize {
        self.points.len() + self.lines.len()
    }

    /// True when there is nothing to draw.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty() && self.stroke_count() == 0
    }

    /// The vertices that triangles, points and lines name, as often as they do.
    pub fn named_vertices(&self) -> impl Iterator<Item = u32> {
        let strokes = self.points.iter().chain(self.lines.iter().flatten());
        self.triangles.iter().flatten().chain(strokes).copied()
    }

    /// The box around all vertices that are named by a triangle, a point or a line, without the width of these.
    pub fn bounds(&self) -> Aabb {
        let named = self.named_vertices().filter_map(|i| self.positions.get(i as usize));
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
