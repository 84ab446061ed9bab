//! A point on a surface, as materials, lights and integrators see it.

use crate::classic::ClassicLight;
use crate::lights::LightSample;
use crate::texture::{Patch, UvPair};
use bilux_accel::{Primitive, Ray};
use bilux_math::{Rgb, Vec2, Vec3};

/// Where a ray met a surface, in world space.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Distance along the ray, in lengths of its direction.
    pub t: f32,
    /// The point.
    pub p: Vec3,
    /// Bound on the rounding error of `p`, per axis.
    pub p_error: Vec3,
    /// Unit normal of the triangle, on the outside: where the vertex normals point if there are any, else
    /// where the vertices run counter-clockwise.
    pub n_geom: Vec3,
    /// Unit shading normal: that of the material's picture of normals where it has one, else `n_smooth`.
    pub n_shade: Vec3,
    /// Unit normal, interpolated; `n_geom` where the mesh has none.
    pub n_smooth: Vec3,
    /// Along the surface, where its material tells directions apart: as u grows, or around the object's own y axis where
    /// the mesh has no texture coordinates. Else, and where there is none, zero.
    pub tangent: Vec3,
    /// 1 where v grows along n_shade × tangent, -1 where it grows the other way.
    pub handedness: f32,
    /// Texture coordinates; the barycentric weights where the mesh has none.
    pub uv: Vec2,
    /// The second set of these; the first where the mesh has no other.
    pub uv2: Vec2,
    /// How far a pixel that sees this point straight from the camera goes in either coordinate, for each set; 0 where textures
    /// are not filtered.
    pub uv_width: [Vec2; 2],
    /// Diffuse reflectance of the vertices, if the mesh has one.
    pub vertex_kd: Option<Rgb>,
    /// Specular reflectance of the vertices, if the mesh has one.
    pub vertex_ks: Option<Rgb>,
    /// Which triangle.
    pub primitive: Primitive,
    /// Which object of the scene.
    pub object: u32,
    /// Time of the ray, in seconds.
    pub time: f32,
}

impl Surface {
    /// Where textures are looked up, as far as a pixel sees.
    #[inline]
    pub fn uvs(&self) -> Patch {
        Patch { at: self.uv_pair(), width: self.uv_width }
    }

    /// The same of a point alone.
    #[inline]
    pub fn uv_pair(&self) -> UvPair {
        UvPair([self.uv, self.uv2])
    }

    /// A ray that leaves this point and cannot meet it again through rounding: it starts beyond the error
    /// bound, on the side that it goes to, and leaves out the triangle itself.
    pub fn spawn(&self, direction: Vec3) -> Ray {
        let origin = offset_origin(self.p, self.p_error, self.n_geom, direction);
        leaving(origin, direction, self.primitive, self.time)
    }

    /// A ray from here to where a light was sampled, as far as nothing of the light itself can be in its way.
    pub fn spawn_to_light(&self, sample: &LightSample) -> Ray {
        match sample.point {
            Some(point) => Ray { t_max: 1.0 - sample.clearance, ..self.spawn_to(point) },
            None => self.spawn(sample.wi),
        }
    }

    /// The same for a light of the classic modes.
    pub fn spawn_to_classic_light(&self, light: &ClassicLight) -> Ray {
        match light.position {
            Some(position) => Ray { t_max: 1.0 - light.clearance, ..self.spawn_to(position) },
            None => self.spawn(light.wi),
        }
    }

    /// A ray from here to `target`, which it reaches at `t = 1`.
    pub fn spawn_to(&self, target: Vec3) -> Ray {
        let origin = offset_origin(self.p, self.p_error, self.n_geom, target - self.p);
        Ray { t_max: 1.0, ..leaving(origin, target - origin, self.primitive, self.time) }
    }
}

/// A ray from `origin` that leaves a triangle.
#[inline]
pub(crate) fn leaving(origin: Vec3, direction: Vec3, primitive: Primitive, time: f32) -> Ray {
    let ray = Ray::new(origin.to_array(), direction.to_array());
    Ray { time, exclude: primitive, t_min: AWAY, ..ray }
}

/// Where a point has no error at all, as on a floor at height 0, its neighbours in the same plane are met at
/// exactly 0, which therefore does not count. 2⁻⁸⁰: nothing beside any length, and yet so large that its products with
/// the slack of boxes are normal numbers. Others take machines a hundred times as long, once or more for every ray.
const AWAY: f32 = 1.0 / (1u128 << 80) as f32;

/// `p` moved out of its error bounds along the normal, to the side that `direction` goes to. [pbrt 2023, 6.8.6]
pub fn offset_origin(p: Vec3, p_error: Vec3, n: Vec3, direction: Vec3) -> Vec3 {
    let distance = n.abs().dot(p_error);
    let offset = if direction.dot(n) < 0.0 { -n * distance } else { n * distance };
    let away = |c: f32, o: f32| match o {
        o if o > 0.0 => (c + o).next_up(),
        o if o < 0.0 => (c + o).next_down(),
        _ => c,
    };
    Vec3::new(away(p.x, offset.x), away(p.y, offset.y), away(p.z, offset.z))
}

/// Bound on the relative error of `n` roundings. [Higham 2002, 3.1]
pub const fn gamma(n: i32) -> f32 {
    let ne = n as f32 * (f32::EPSILON * 0.5);
    ne / (1.0 - ne)
}
