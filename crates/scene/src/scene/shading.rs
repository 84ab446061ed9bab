//! Which surfaces integrators shade many at a time.

use crate::bsdf::SmoothLobe;
use crate::geometry::placed::Placed;
use crate::materials::Material;
use bilux_math::Rgb;
use std::sync::Arc;

/// Scattering of the surfaces of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shading {
    /// By one Lambertian lobe; they emit nothing.
    Lambertian,
    /// By one [`OpaqueBase`](crate::bsdf::OpaqueBase) where [`Material::opaque_base`] gives its inputs.
    OpaqueBase,
    /// By one [`SmoothLobe`], the same everywhere; they emit nothing.
    Smooth,
    /// In any way.
    General,
}

/// [`Shading`] with what it needs.
#[derive(Clone, Copy)]
pub(super) struct ObjectShading {
    pub(super) kind: Shading,
    /// Nothing there emits light.
    pub(super) is_dark: bool,
    /// The reflectance, where it is Lambertian and the same everywhere; the triangles, if there are any, are in the
    /// common tree, and do not move.
    pub(super) constant: Option<Rgb>,
    /// The lobe, where that is smooth.
    pub(super) smooth: Option<SmoothLobe>,
}

impl ObjectShading {
    pub(super) fn of(object: &Placed, materials: &[Arc<dyn Material>]) -> ObjectShading {
        let material = &materials[object.material as usize];
        let is_dark = !object.gives_light && material.emission().is_black();
        let of_kind = |kind| ObjectShading { kind, is_dark, constant: None, smooth: None };
        if let Some(lobe) = material.smooth_lobe().filter(|_| is_dark) {
            return ObjectShading { smooth: Some(lobe), ..of_kind(Shading::Smooth) };
        }
        if !is_dark || !material.is_lambertian() {
            return of_kind(if material.is_opaque_base() { Shading::OpaqueBase } else { Shading::General });
        }
        let is_plain = !object.in_own_tree() && object.mesh.vertex_kd.is_empty();
        let constant = material.constant_lambertian_reflectance().filter(|_| is_plain);
        ObjectShading { constant, ..of_kind(Shading::Lambertian) }
    }
}
