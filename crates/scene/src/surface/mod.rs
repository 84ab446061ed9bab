//! A point on a surface, for materials, lights and integrators.
pub(crate) mod light_sample;
use crate::classic::ClassicLight;
use crate::surface::light_sample::LightSample;
use crate::texture::{Patch, UvPair};
use bilux_accel::{Primitive, Ray};
use bilux_math::{Rgb, Vec2, Vec3};

/// The point where a ray hit a surface, in world space.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Distance along the ray, in units of the length of its direction.
    pub t: f32,
    /// The point.
    pub p: Vec3,
    /// Bound on the rounding error of `p`, per axis.
    pub p_error: Vec3,
    /// Unit normal of the triangle, on the outside: the side of the vertex normals if there are any, otherwise the side
    /// from which the vertices are counter-clockwise.
    pub n_geom: Vec3,
    /// Unit shading normal: from the material's normal map if it has one, otherwise `n_smooth`.
    pub n_shade: Vec3,
    /// Interpolated unit normal; `n_geom` if the mesh has no normals.
    pub n_smooth: Vec3,
    /// Tangent for anisotropic materials: along increasing u, or around the object's own y axis if the mesh has no
    /// texture coordinates. Zero for other materials, and where there is none.
    pub tangent: Vec3,
    /// 1 where v increases along n_shade × tangent, -1 where it decreases.
    pub handedness: f32,
    /// Texture coordinates; barycentric coordinates if the mesh has none.
    pub uv: Vec2,
    /// The second set of texture coordinates; the first if the mesh has no other.
    pub uv2: Vec2,
    /// The footprint, along each coordinate of each set, of a pixel that sees this point directly from the camera; 0 if
    /// textures are not filtered.
    pub uv_width: [Vec2; 2],
    /// Diffuse reflectance of the vertices, if the mesh has it.
    pub vertex_kd: Option<Rgb>,
    /// Specular reflectance of the vertices, if the mesh has it.
    pub vertex_ks: Option<Rgb>,
    /// The primitive that was hit.
    pub primitive: Primitive,
    /// The object of the scene.
    pub object: u32,
    /// Time of the ray, in seconds.
    pub time: f32,
}

impl Surface {
    /// The texture coordinates, with the pixel's footprint.
    #[inline]
    pub fn uvs(&self) -> Patch {
        Patch { at: self.uv_pair(), width: self.uv_width }
    }

    /// The texture coordinates alone.
    #[inline]
    pub fn uv_pair(&self) -> UvPair {
        UvPair([self.uv, self.uv2])
    }

    /// A ray that leaves this point and cannot hit it again through rounding.
    ///
    /// It starts beyond the error bound, on the side of its direction, and excludes the triangle itself.
    pub fn spawn(&self, direction: Vec3) -> Ray {
        let origin = offset_origin(self.p, self.p_error, self.n_geom, direction);
        leaving(origin, direction, self.primitive, self.time)
    }

    /// A ray from here to a light sample, up to where the light itself cannot block it.
    pub fn spawn_to_light(&self, sample: &LightSample) -> Ray {
        match sample.point {
            Some(point) => Ray { t_max: 1.0 - sample.clearance, ..self.spawn_to(point) },
            None => self.spawn(sample.wi),
        }
    }

    /// [`Surface::spawn_to_light`] for a classic light.
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
pub fn leaving(origin: Vec3, direction: Vec3, primitive: Primitive, time: f32) -> Ray {
    let ray = Ray::new(origin.to_array(), direction.to_array());
    Ray { time, exclude: primitive, t_min: AWAY, ..ray }
}

/// The minimum distance of a hit. From a point without any error, as on a floor at height 0, neighbours in the same
/// plane are hit at exactly 0, which therefore must not count. 2⁻⁸⁰ is negligible next to any length, yet large enough
/// that its products with the slack of bounding boxes are normal numbers. Subnormal numbers take machines a hundred
/// times as long, once or more for every ray.
const AWAY: f32 = 1.0 / (1u128 << 80) as f32;

/// `p` offset beyond its error bounds along the normal, to the side that `direction` points to. [pbrt 2023, 6.8.6]
#[inline(always)]
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

/// Bound on the relative error of `n` rounding operations. [Higham 2002, 3.1]
pub const fn gamma(n: i32) -> f32 {
    let ne = n as f32 * (f32::EPSILON * 0.5);
    ne / (1.0 - ne)
}

/// A usable shading normal: unit length, never zero.
pub(crate) fn unit_or(n: Vec3, fallback: Vec3) -> Vec3 {
    n.try_normalize().unwrap_or(fallback)
}
