//! Triangles, points and lines, with the attributes for shading.
pub(crate) mod closed;
pub mod shapes;
pub(crate) mod sides;
use bilux_math::glam::Vec4;
use bilux_math::transcendental::sin_cos;
use bilux_math::{Aabb, Rgb, Vec2, Vec3};

/// The maximum number of bands of a sphere, more than anybody can see: 67 million triangles.
const MAX_RINGS: u32 = 4096;

/// Triangles, points and lines in object space. Attributes are per vertex, and either absent (empty) or as many as
/// positions; [`crate::SceneBuilder::build`] checks that.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Name in the file; may be empty.
    pub name: String,
    /// Vertices.
    pub positions: Vec<Vec3>,
    /// Shading normals; need not be of unit length.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, v upwards.
    pub uvs: Vec<Vec2>,
    /// A second set of texture coordinates, for textures that use it.
    pub uvs2: Vec<Vec2>,
    /// Tangents in the direction of increasing u; w is 1 where v increases along normal × tangent, and -1 where it
    /// decreases. Without them, tangents follow from the texture coordinates of each triangle.
    pub tangents: Vec<Vec4>,
    /// Diffuse reflectance per vertex (the paper's Kd).
    pub vertex_kd: Vec<Rgb>,
    /// Specular reflectance per vertex (the paper's Ks).
    pub vertex_ks: Vec<Rgb>,
    /// If true, `vertex_kd` is a factor on the material's emission too.
    pub emission_by_kd: bool,
    /// Factor on the material's opacity per vertex, 0 to 1.
    pub vertex_opacity: Vec<f32>,
    /// If given, an opacity below it, after that factor, becomes 0, and any other 1. Without the factor it does nothing: the
    /// opacity is then that of the material alone.
    pub opacity_threshold: Option<f32>,
    /// Diameter of the point at each vertex, in the mesh's own space; without them, points have the scene's point width.
    pub point_widths: Vec<f32>,
    /// Triples of vertices.
    pub triangles: Vec<[u32; 3]>,
    /// Vertices that are points: spheres with the scene's point width.
    pub points: Vec<u32>,
    /// Pairs of vertices connected by lines: tubes with the scene's line width.
    pub lines: Vec<[u32; 2]>,
}

impl Mesh {
    /// A flat quadrilateral from its corner along two edges.
    ///
    /// Its front is where `edge_u × edge_v` points; texture coordinates go from 0 at the corner to 1 along each edge.
    pub fn quad(corner: Vec3, edge_u: Vec3, edge_v: Vec3) -> Mesh {
        let normal = edge_u.cross(edge_v).normalize_or_zero();
        Mesh {
            positions: vec![corner, corner + edge_u, corner + edge_u + edge_v, corner + edge_v],
            normals: vec![normal; 4],
            uvs: vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        }
    }

    /// A sphere with smooth normals, whose poles are on the y axis.
    ///
    /// It has `rings` bands from pole to pole (2..=4096) and twice as many around. u goes around, from 0 to 1, and v
    /// up.
    pub fn sphere(centre: Vec3, radius: f32, rings: u32) -> Mesh {
        let rings = rings.clamp(2, MAX_RINGS);
        let columns = 2 * rings;
        let mut mesh = Mesh::default();
        for row in 0..=rings {
            let v = row as f32 / rings as f32;
            // At the poles the sine is not exactly zero.
            let (sin_theta, cos_theta) = match row {
                0 => (0.0, 1.0),
                _ if row == rings => (0.0, -1.0),
                _ => sin_cos(std::f32::consts::PI * v),
            };
            for column in 0..=columns {
                let u = column as f32 / columns as f32;
                // The first meridian again, bit for bit, so that there is no gap.
                let (sin_phi, cos_phi) =
                    sin_cos(std::f32::consts::TAU * (column % columns) as f32 / columns as f32);
                let normal = Vec3::new(sin_theta * cos_phi, cos_theta, -sin_theta * sin_phi);
                mesh.positions.push(centre + normal * radius);
                mesh.normals.push(normal);
                mesh.uvs.push(Vec2::new(u, 1.0 - v));
            }
        }
        for row in 0..rings {
            for column in 0..columns {
                let above = row * (columns + 1) + column;
                let below = above + columns + 1;
                if row > 0 {
                    mesh.triangles.push([above, below, above + 1]);
                }
                if row + 1 < rings {
                    mesh.triangles.push([above + 1, below, below + 1]);
                }
            }
        }
        mesh
    }

    /// The size in bytes.
    pub fn size(&self) -> u64 {
        let triples = self.positions.len() + self.normals.len() + self.triangles.len();
        let colours = self.vertex_kd.len() + self.vertex_ks.len();
        let uvs = self.uvs.len() + self.uvs2.len();
        let strokes = self.points.len() + 2 * self.lines.len();
        let numbers = self.vertex_opacity.len() + self.point_widths.len();
        4 * (3 * (triples + colours) + 2 * uvs + 4 * self.tangents.len() + strokes + numbers) as u64
    }

    /// The factor on the emission of its material at a point between vertices.
    #[inline]
    pub(crate) fn emission_factor<const N: usize>(&self, vertices: [u32; N], weights: [f32; N]) -> Rgb {
        if !self.emission_by_kd || self.vertex_kd.is_empty() {
            return Rgb::WHITE;
        }
        let of = |i: u32| self.vertex_kd.get(i as usize).copied().unwrap_or(Rgb::WHITE);
        vertices.into_iter().zip(weights).map(|(i, weight)| of(i) * weight).sum()
    }

    /// The opacity at a point between vertices, where that of its material is `own`.
    #[inline]
    pub(crate) fn opacity<const N: usize>(&self, own: f32, vertices: [u32; N], weights: [f32; N]) -> f32 {
        if self.vertex_opacity.is_empty() {
            return own;
        }
        let of = |i: u32| self.vertex_opacity.get(i as usize).copied().unwrap_or(1.0);
        let opacity = own * vertices.into_iter().zip(weights).map(|(i, weight)| of(i) * weight).sum::<f32>();
        self.opacity_threshold.map_or(opacity, |threshold| if opacity < threshold { 0.0 } else { 1.0 })
    }

    /// The number of points and lines.
    pub fn stroke_count(&self) -> usize {
        self.points.len() + self.lines.len()
    }

    /// True when there is nothing to render.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty() && self.stroke_count() == 0
    }

    /// The vertices referenced by triangles, points and lines, with repetitions.
    pub fn named_vertices(&self) -> impl Iterator<Item = u32> {
        let strokes = self.points.iter().chain(self.lines.iter().flatten());
        self.triangles.iter().flatten().chain(strokes).copied()
    }

    /// The bounding box of all vertices that triangles, points and lines reference, without the width of the latter
    /// two.
    pub fn bounds(&self) -> Aabb {
        let named = self.named_vertices().filter_map(|i| self.positions.get(i as usize));
        Aabb::of_points(named.copied().filter(|p| p.is_finite()))
    }

    /// Area-weighted vertex normals from the triangles, for meshes without normals.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Six times the volume that the triangles enclose.
    fn volume6(mesh: &Mesh) -> f32 {
        let of = |&[a, b, c]: &[u32; 3]| {
            let [a, b, c] = [a, b, c].map(|i| mesh.positions[i as usize]);
            a.cross(b).dot(c)
        };
        mesh.triangles.iter().map(of).sum()
    }

    #[test]
    fn a_sphere_is_closed_and_faces_outwards() {
        let mesh = Mesh::sphere(Vec3::ZERO, 2.0, 64);
        let wanted = 6.0 * 4.0 / 3.0 * std::f32::consts::PI * 8.0;
        assert!((volume6(&mesh) / wanted - 1.0).abs() < 0.005, "{}", volume6(&mesh) / wanted);
        assert_eq!(mesh.triangles.len(), 2 * 128 * 63);
        let is_on_it =
            |(p, n): (&Vec3, &Vec3)| p.abs_diff_eq(*n * 2.0, 1e-6) && (n.length() - 1.0).abs() < 1e-6;
        assert!(mesh.positions.iter().zip(&mesh.normals).all(is_on_it));
        assert_eq!(Mesh::sphere(Vec3::ZERO, 1.0, 0), Mesh::sphere(Vec3::ZERO, 1.0, 2));
    }

    #[test]
    fn a_quad_faces_where_its_edges_turn_to() {
        let mesh = Mesh::quad(Vec3::ZERO, Vec3::Z * 2.0, Vec3::X);
        assert_eq!(mesh.normals, [Vec3::Y; 4]);
        assert_eq!(mesh.smooth_normals(), mesh.normals);
        assert_eq!((mesh.positions[2], mesh.uvs[2]), (Vec3::new(1.0, 0.0, 2.0), Vec2::ONE));
    }
}
