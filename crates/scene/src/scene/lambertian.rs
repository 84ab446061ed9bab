//! Surfaces that integrators shade many at a time: those that emit nothing, and whose BSDF is one Lambertian lobe.

use super::Tracer;
use crate::geometry::{Placed, SurfacePoint};
use crate::materials::Material;
use bilux_accel::Hit;
use bilux_math::{Rgb, Vec3};
use std::sync::Arc;

/// Whether an object is such a surface.
#[derive(Clone, Copy)]
pub(super) enum Lambertian {
    No,
    /// With any reflectance.
    Varying,
    /// With this reflectance everywhere; its triangles, if it has any, are in the common tree, and do not move.
    Constant(Rgb),
}

impl Lambertian {
    pub(super) fn of(object: &Placed, materials: &[Arc<dyn Material>]) -> Lambertian {
        let material = &materials[object.material as usize];
        if object.gives_light || !material.is_lambertian() || !material.emission().is_black() {
            return Lambertian::No;
        }
        let is_plain = !object.in_own_tree() && object.mesh.vertex_kd.is_empty();
        match material.constant_lambertian_reflectance() {
            Some(reflectance) if is_plain => Lambertian::Constant(reflectance),
            _ => Lambertian::Varying,
        }
    }
}

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
