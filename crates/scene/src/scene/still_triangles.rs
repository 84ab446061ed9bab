//! Triangles of surfaces that integrators shade many at a time.

use super::Scene;
use crate::bsdf::SmoothLobe;
use bilux_accel::Hit;
use bilux_math::Rgb;

impl Scene {
    /// The reflectance of an object where it was hit, if that is a triangle of the common tree, and a Lambertian surface
    /// that is the same everywhere. The point is that of a [`StillTriangle`](crate::geometry::StillTriangle), in less
    /// time than it takes to find the whole surface.
    #[inline]
    pub fn lambertian_triangle(&self, object: u32, hit: &Hit) -> Option<Rgb> {
        let reflectance = self.parts.shading.get(object as usize)?.constant?;
        self.parts.geometry.is_still_triangle(hit).then_some(reflectance)
    }

    /// [`Scene::lambertian_triangle`] for the lobe of a mirror or of smooth glass.
    #[inline]
    pub fn smooth_triangle(&self, object: u32, hit: &Hit) -> Option<SmoothLobe> {
        let lobe = self.parts.shading.get(object as usize)?.smooth?;
        self.parts.geometry.is_still_triangle(hit).then_some(lobe)
    }
}
