//! Triangles of surfaces that integrators shade many at a time.

use super::Tracer;
use crate::bsdf::SmoothLobe;
use crate::geometry::StillTriangle;
use bilux_accel::Hit;
use bilux_math::Rgb;

impl Tracer<'_> {
    /// The triangle of an object that was hit, and the object's reflectance if that is the same everywhere. Its
    /// [`StillTriangle::point`] is that of [`Tracer::surface`], in less time. `None` for points and lines, and for all other
    /// objects.
    #[inline]
    pub fn lambertian_triangle(&self, object: u32, hit: &Hit) -> Option<(StillTriangle, Rgb)> {
        let parts = &self.scene.parts;
        let reflectance = parts.shading.get(object as usize)?.constant?;
        Some((parts.geometry.still_triangle(hit)?, reflectance))
    }

    /// The same for an object with a smooth lobe.
    #[inline]
    pub fn smooth_triangle(&self, object: u32, hit: &Hit) -> Option<(StillTriangle, SmoothLobe)> {
        let parts = &self.scene.parts;
        let lobe = parts.shading.get(object as usize)?.smooth?;
        Some((parts.geometry.still_triangle(hit)?, lobe))
    }
}
