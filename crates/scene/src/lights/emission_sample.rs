//! Light that leaves a light source.

use crate::surface::light_sample::cos_at;
use crate::surface::{leaving, offset_origin};
use bilux_accel::{Primitive, Ray};
use bilux_math::{Rgb, Vec3};

/// A sample of emitted light, as a ray into the scene. [Georgiev 2012]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmissionSample {
    /// Origin of the ray: on the light, or, for an infinite light, on a disc perpendicular to `direction`, just outside
    /// of the scene's bounding sphere.
    pub p: Vec3,
    /// Bound on the rounding error of `p`, per axis.
    pub p_error: Vec3,
    /// Unit normal of the light there, on the side of the ray; zero if it has none.
    pub n_light: Vec3,
    /// Unit direction of the ray.
    pub direction: Vec3,
    /// Radiance along the ray; for a point light the intensity in that direction, in W/sr; for a directional light the
    /// irradiance perpendicular to it, in W/m².
    pub le: Rgb,
    /// The emission density: that of the origin over area times that of the direction over solid angle, 1/(m² sr). A
    /// fixed origin or direction counts as 1.
    pub pdf_emission: f32,
    /// The direct density, with which [`super::Light::sample_li`] samples this origin, over area; for an infinite light, this
    /// direction, over solid angle. 1 for delta lights. If it depends on the receiver, this is the density with
    /// which light subpaths begin here, and [`super::LightTracing::direct_pdf`] is exact.
    pub pdf_direct: f32,
    /// The triangle or sphere that it leaves; [`Primitive::NONE`] if there is none.
    pub primitive: Primitive,
}

impl EmissionSample {
    /// Cosine between the ray and the light's normal; 1 if there is no normal.
    pub fn cos(&self) -> f32 {
        cos_at(self.n_light, self.direction)
    }

    /// The ray, at a time in seconds. It cannot hit the triangle, or the point of a sphere, that it leaves.
    pub fn spawn(&self, time: f32) -> Ray {
        let origin = offset_origin(self.p, self.p_error, self.n_light, self.direction);
        leaving(origin, self.direction, self.primitive, time)
    }
}
