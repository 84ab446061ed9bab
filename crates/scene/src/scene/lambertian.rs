//! Surfaces that integrators shade many at a time: those that emit nothing, and whose BSDF is one Lambertian lobe.

use crate::materials::Material;
use crate::placed::Placed;
use bilux_math::Rgb;
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
