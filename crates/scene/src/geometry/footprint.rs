//! The footprint of a pixel on a surface, by which textures are filtered.
//!
//! It is the footprint for a camera that sees the point directly, however light reaches it: a function of the point,
//! the camera and the image's size, never of a path. So a surface looks the same from both ends of any path.

use crate::cameras::Camera;
use crate::geometry::Geometry;
use crate::geometry::corners::triangle_uvs;
use crate::mesh::Mesh;
use crate::parameters::{Spec, Value};
use crate::surface::Surface;
use crate::texture::{Texture, mipmaps};
use bilux_math::{Vec2, Vec3};
use std::sync::Arc;

/// The camera, and the number of pixel rows.
#[derive(Clone)]
pub(crate) struct FootprintView {
    pub(crate) camera: Arc<dyn Camera>,
    pub(crate) rows: f32,
}

impl FootprintView {
    /// Sets the texture footprint of a pixel on a surface of the geometry.
    #[inline(never)]
    pub(crate) fn put_on(&self, surface: &mut Surface, geometry: &Geometry) {
        let object = geometry.objects().get(surface.object as usize);
        let Some(object) = object.filter(|object| object.is_filtered) else { return };
        if !geometry.is_triangle(surface.primitive) {
            return;
        }
        let (triangle, corners, _) = geometry.in_world(surface.primitive, surface.time);
        let pixel = self.pixel_at(surface.p, surface.time);
        let rates = uv_rates(&object.mesh, object.mesh.triangles[triangle as usize], corners);
        surface.uv_width = rates.map(|rate| rate * pixel);
    }

    /// The width of a pixel at a point, in metres.
    fn pixel_at(&self, p: Vec3, time: f32) -> f32 {
        self.camera.height_at(p, time) / self.rows
    }

    /// The textures of each material that some pixel sees from far enough away to use coarser levels.
    ///
    /// Returns all of them where the test would take as long as making the levels, and where anything may move.
    pub(crate) fn needed<'a>(
        &self,
        geometry: &Geometry,
        textures: &'a [Vec<Arc<Texture>>],
        [opens, closes]: [f32; 2],
    ) -> Vec<&'a Arc<Texture>> {
        const MANY: usize = 1 << 18;
        const ALL: Vec2 = Vec2::splat(1e18);
        let objects = geometry.objects().iter().filter(|object| object.is_filtered);
        let triangles: usize = objects.clone().map(|object| object.mesh.triangles.len()).sum();
        let mut widths = vec![[Vec2::ZERO; 2]; textures.len()];
        for object in objects {
            let (widest, mesh) = (&mut widths[object.material as usize], &*object.mesh);
            if triangles > MANY || opens != closes {
                *widest = [ALL; 2];
                continue;
            }
            let to_world = object.motion.at(opens);
            for triangle in &mesh.triangles {
                let corners = triangle.map(|i| to_world.point(mesh.positions[i as usize]));
                // Inside the triangle a pixel is never wider than at the widest corner.
                let pixel = corners.map(|p| self.pixel_at(p, opens)).into_iter().fold(0.0, f32::max);
                let rates = uv_rates(mesh, *triangle, corners);
                *widest = std::array::from_fn(|set| widest[set].max(rates[set] * pixel));
            }
        }
        let seen = textures.iter().zip(widths);
        seen.flat_map(|(textures, widths)| textures.iter().filter(move |t| t.has_level_for(widths))).collect()
    }
}

fn uv_rates(mesh: &Mesh, triangle: [u32; 3], corners: [Vec3; 3]) -> [Vec2; 2] {
    let first = rates(corners, triangle_uvs(mesh, triangle));
    let second = || rates(corners, triangle.map(|i| mesh.uvs2[i as usize]));
    [first, if mesh.uvs2.is_empty() { first } else { second() }]
}

/// The maximum change of each texture coordinate per metre of a triangle: the lengths of their gradients. Along these a
/// pixel is never narrower than perpendicular to the camera's axis. Zero where the corners are collinear.
fn rates([a, b, c]: [Vec3; 3], [uv_a, uv_b, uv_c]: [Vec2; 3]) -> Vec2 {
    let (b_side, c_side) = (b - a, c - a);
    let area = b_side.cross(c_side).length();
    let rate = |b: f32, c: f32| (c_side * b - b_side * c).length() / area;
    let (b, c) = (uv_b - uv_a, uv_c - uv_a);
    if area > 0.0 { Vec2::new(rate(b.x, c.x), rate(b.y, c.y)) } else { Vec2::ZERO }
}

/// Textures looked up at points: emission and opacity, for which light sampling has to find the same values as rays do,
/// and normals, whose mean would be that of a smoother surface.
const AT_POINTS: [&str; 4] = ["emission", "opacity", "normal", "coat_normal"];

/// The filtered textures of a material, which is one of the scene's `materials`.
///
/// A material with an opacity mask has none, as its colours have to match the mask texel by texel.
pub(crate) fn filtered(material: &Spec, materials: &[Spec], textures: &[Arc<Texture>]) -> Vec<Arc<Texture>> {
    if let Some((Value::Texture(_), _)) = material.parameters.find("opacity") {
        return Vec::new();
    }
    let mut found = Vec::new();
    for (key, value, _) in &material.parameters.0 {
        match value {
            Value::Texture(index) if !AT_POINTS.contains(&key.as_str()) => {
                found.extend(textures.get(*index).filter(|texture| mipmaps::has_use(texture)).cloned());
            }
            Value::Material(index) => {
                found
                    .extend(materials.get(*index).into_iter().flat_map(|m| filtered(m, materials, textures)));
            }
            _ => {}
        }
    }
    found
}
