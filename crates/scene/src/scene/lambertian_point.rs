//! Points of surfaces that integrators shade many at a time.

use super::Tracer;
use super::lambertian::Lambertian;
use crate::geometry::SurfacePoint;
use bilux_accel::Hit;
use bilux_math::{Rgb, Vec3};

/// A point of a Lambertian surface, with all that its shading needs; see [`crate::Surface`] for the other fields.
pub struct LambertianPoint {
    /// The point.
    pub p: Vec3,
    /// Bound on the rounding error of `p`, per axis.
    pub p_error: Vec3,
    /// Unit normal of the triangle.
    pub n_geom: Vec3,
    /// Unit shading normal.
    pub n_shade: Vec3,
    /// The reflected fraction of the light.
    pub reflectance: Rgb,
}

impl Tracer<'_> {
    /// The point at a hit of an object's triangle, if the object's reflectance is the same everywhere: the same values as
    /// those of [`Tracer::surface`], in less time. `None` for points and lines, and for all other objects.
    #[inline]
    pub fn lambertian_point(&self, object: u32, hit: &Hit) -> Option<LambertianPoint> {
        let parts = &self.scene.parts;
        let Some(Lambertian::Constant(reflectance)) = parts.lambertian.get(object as usize) else {
            return None;
        };
        let SurfacePoint { p, p_error, n_geom, n_shade } = parts.geometry.still_point(hit)?;
        Some(LambertianPoint { p, p_error, n_geom, n_shade, reflectance: *reflectance })
    }
}
