//! Displacement maps.

use bilux_math::Vec2;
use bilux_scene::{Mesh, Span, Texture};

/// The surfaces that a map moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Moved {
    /// Surfaces with this material.
    Material(usize),
    /// One object.
    Object(usize),
}

/// Directions along which the values of a map move points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// Heights, along the normal.
    Normal,
    /// Red along the tangent, green along the normal, blue along the bitangent, as Mudbox and Blender write them.
    Tangents,
    /// Red, green and blue along the axes of the object.
    Axes,
}

/// A displacement map.
#[derive(Clone, Debug)]
pub struct Displacement {
    pub map: Texture,
    pub along: Along,
    /// Distance that a value larger by 1 moves a point further, in units of the mesh.
    pub scale: f32,
    /// The value that leaves points where they are.
    pub middle: f32,
    pub at: Span,
}

impl Displacement {
    /// The texture coordinates that place the map.
    pub fn uvs<'m>(&self, mesh: &'m Mesh) -> &'m [Vec2] {
        if self.map.second_uv && !mesh.uvs2.is_empty() { &mesh.uvs2 } else { &mesh.uvs }
    }

    /// The width of a texel on the surface, on average; 0 for a formula, which has none.
    pub fn texel(&self, mesh: &Mesh) -> f32 {
        let uvs = self.uvs(mesh);
        let unit = self.map.transform.map_or(1.0, |placing| {
            let [a, b, c, d, ..] = placing.to_array();
            (a * d - b * c).abs()
        });
        let (mut area, mut texels) = (0.0f64, 0.0f64);
        for corners in &mesh.triangles {
            let [a, b, c] = corners.map(|i| mesh.positions[i as usize]);
            let [p, q, r] = corners.map(|i| uvs[i as usize]);
            area += f64::from((b - a).cross(c - a).length());
            texels += f64::from((q - p).perp_dot(r - p).abs() * unit);
        }
        texels *= (self.map.width() * self.map.height()) as f64;
        let width = (area / texels).sqrt() as f32;
        if width.is_finite() { width } else { 0.0 }
    }
}
