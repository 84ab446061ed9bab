//! Points and lines of a mesh as they are rendered: spheres, and tubes with round ends, each intersected analytically,
//! so that none of them costs a triangle.

use crate::geometry::corners::transform_with_error;
use crate::mesh::Mesh;
use crate::surface::{Surface, gamma, unit_or};
use bilux_accel::primitives::{Capsule, Crossing, PrimitiveTree, Primitives, Shape, Sphere};
use bilux_accel::{Hit, Primitive, Ray};
use bilux_math::glam::DVec3;
use bilux_math::{Rgb, Transform, Vec2, Vec3};
use std::sync::Arc;

/// The widths of points and lines, in metres in world space. A width of 0 becomes a small fraction of the scene's size.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StrokeWidths {
    /// The diameter of points.
    pub points: f32,
    /// The diameter of lines.
    pub lines: f32,
}

impl StrokeWidths {
    /// Replaces widths of 0 by fractions of the scene's size (the diagonal of its bounding box).
    pub fn for_size(self, size: f32) -> StrokeWidths {
        let size = if size > 0.0 && size.is_finite() { size } else { 1.0 };
        let or = |width: f32, part: f32| if width > 0.0 && width.is_finite() { width } else { size * part };
        StrokeWidths { points: or(self.points, 1.0 / 200.0), lines: or(self.lines, 1.0 / 400.0) }
    }
}

/// The points of a mesh, then its lines, with their shapes.
pub(crate) struct Strokes {
    mesh: Arc<Mesh>,
    /// The mesh's positions in world space, if the tree is not in object space.
    moved: Option<Vec<Vec3>>,
    radii: StrokeWidths,
    /// The factor from widths in the mesh to radii in the space of the tree.
    radius_of_width: f32,
}

impl Strokes {
    /// The radii of points and lines in a space whose lengths are `scale` times as long in the world.
    pub(crate) fn radii(widths: StrokeWidths, scale: f32) -> StrokeWidths {
        let radius = |width: f32| width * 0.5 / scale;
        StrokeWidths { points: radius(widths.points), lines: radius(widths.lines) }
    }

    /// The tree over the points and lines of a mesh: in world space if `to_world` is given, otherwise in object space.
    pub(crate) fn tree(
        mesh: &Arc<Mesh>,
        to_world: Option<&Transform>,
        radii: StrokeWidths,
    ) -> PrimitiveTree<Strokes> {
        let moved = to_world
            .filter(|to_world| !to_world.is_identity())
            .map(|to_world| mesh.positions.iter().map(|p| to_world.point(*p)).collect());
        let radius_of_width = 0.5 * moved.as_ref().and(to_world).map_or(1.0, mean_scale);
        PrimitiveTree::new(Strokes { mesh: mesh.clone(), moved, radii, radius_of_width })
    }

    fn position(&self, vertex: u32) -> [f32; 3] {
        self.moved.as_ref().unwrap_or(&self.mesh.positions)[vertex as usize].to_array()
    }

    /// The vertices at the two ends; the same vertex twice for a point.
    fn ends(&self, index: u32) -> [u32; 2] {
        let index = index as usize;
        match self.mesh.points.get(index) {
            Some(&point) => [point; 2],
            None => self.mesh.lines[index - self.mesh.points.len()],
        }
    }

    fn shape(&self, index: u32) -> Shape {
        let [a, b] = self.ends(index);
        if (index as usize) < self.mesh.points.len() {
            let own = self.mesh.point_widths.get(a as usize).map(|width| width * self.radius_of_width);
            Shape::Sphere(Sphere { centre: self.position(a), radius: own.unwrap_or(self.radii.points) })
        } else {
            Shape::Capsule(Capsule { ends: [a, b].map(|i| self.position(i)), radius: self.radii.lines })
        }
    }

    /// Interpolates between the two ends.
    fn between<T: Copy>(&self, index: u32, u: f32, of: &[T], mix: impl Fn(T, T, f32) -> T) -> Option<T> {
        let [a, b] = self.ends(index).map(|i| of.get(i as usize).copied());
        Some(mix(a?, b?, u))
    }

    /// The opacity of a place, where that of the material is `own`.
    pub(crate) fn opacity(&self, index: u32, u: f32, own: f32) -> f32 {
        self.mesh.opacity(own, self.ends(index), [1.0 - u, u])
    }

    /// Texture coordinates; 0 if the mesh has none.
    pub(crate) fn uv(&self, index: u32, u: f32) -> Vec2 {
        self.between(index, u, &self.mesh.uvs, Vec2::lerp).unwrap_or(Vec2::ZERO)
    }

    /// All that shading needs about a hit, which is at a distance along a ray in the tree's space.
    ///
    /// `to_world` is the transform from there to world space. The point is recomputed in f64, so that it lies on the
    /// surface to the last bits of an f32.
    pub(crate) fn surface(&self, ray: &Ray, hit: &Hit, to_world: &Transform, object: u32) -> Surface {
        let wide = |v: [f32; 3]| DVec3::from(v.map(f64::from));
        let is_still = to_world.is_identity();
        let own = || {
            // Transform the ray as for instances.
            let inverse = to_world.inverse_matrix().as_dmat4();
            let origin = inverse.transform_point3(wide(ray.origin)).as_vec3().to_array();
            let direction = inverse.transform_vector3(wide(ray.direction)).as_vec3().to_array();
            Ray { origin, direction, ..*ray }
        };
        let ray = &if is_still { *ray } else { own() };
        let shape = self.shape(hit.primitive);
        let chord = match shape {
            Shape::Sphere(sphere) => sphere.chord(ray),
            Shape::Capsule(capsule) => capsule.chord(ray),
            _ => None,
        };
        let [enter, leave] = chord.unwrap_or([f64::from(hit.t); 2]);
        let off = |t: f64| (t - f64::from(hit.t)).abs();
        let enters = off(enter) <= off(leave);
        let at = wide(ray.origin) + wide(ray.direction) * if enters { enter } else { leave };
        let (centre, radius) = match shape {
            Shape::Capsule(capsule) => {
                let [a, b] = capsule.ends.map(wide);
                (a.lerp(b, capsule.nearest(at.to_array())), capsule.radius)
            }
            Shape::Sphere(Sphere { centre, radius }) => (wide(centre), radius),
            _ => (at, 0.0),
        };
        let n = (at - centre).try_normalize().unwrap_or(DVec3::Y);
        let p = (centre + n * f64::from(radius)).as_vec3();
        // Rounded once; the error of f64 is far smaller.
        let error = (p.abs() + (centre.as_vec3().abs() + radius) * WIDE) * gamma(1);
        let (p, p_error) = if is_still { (p, error) } else { transform_with_error(to_world, p, error) };
        let n = unit_or(to_world.normal(n.as_vec3()), Vec3::Y);
        let (index, mix) = (hit.primitive, |a: Rgb, b: Rgb, u: f32| a * (1.0 - u) + b * u);
        let uv = self.uv(index, hit.u);
        Surface {
            t: hit.t,
            p,
            p_error,
            n_geom: n,
            n_shade: n,
            n_smooth: n,
            tangent: Vec3::ZERO,
            handedness: 1.0,
            uv,
            uv2: self.between(index, hit.u, &self.mesh.uvs2, Vec2::lerp).unwrap_or(uv),
            uv_width: [Vec2::ZERO; 2],
            vertex_kd: self.between(index, hit.u, &self.mesh.vertex_kd, mix),
            vertex_ks: self.between(index, hit.u, &self.mesh.vertex_ks, mix),
            primitive: Primitive { instance: hit.instance, index },
            object,
            time: ray.time,
        }
    }
}

/// The mean factor on lengths.
pub(crate) fn mean_scale(to_world: &Transform) -> f32 {
    let volume = f64::from(to_world.matrix().determinant()).abs();
    let scale = bilux_math::transcendental::powf_f64(volume, 1.0 / 3.0) as f32;
    if scale > 0.0 && scale.is_finite() { scale } else { 1.0 }
}

/// A bound on the error of f64 relative to that of f32.
const WIDE: f32 = 1.0 / (1u32 << 26) as f32;

impl Primitives for Strokes {
    fn len(&self) -> usize {
        self.mesh.points.len() + self.mesh.lines.len()
    }

    fn bounds(&self, index: u32) -> [[f32; 3]; 2] {
        self.shape(index).bounds()
    }

    fn crossings(&self, index: u32, ray: &Ray, visit: &mut dyn FnMut(Crossing)) {
        self.shape(index).crossings(ray, ray.exclude.index == index, visit);
    }
}
