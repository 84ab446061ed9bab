//! Objects that may let rays pass.

use crate::geometry::Geometry;
use crate::geometry::placed::{Placed, Visibility};
use crate::materials::Material;
use crate::mesh::Mesh;
use crate::mesh::sides::Sides;
use std::sync::Arc;

/// Which rays an object may let pass.
#[derive(Clone, Copy)]
pub(super) struct MayPass {
    /// Whether the object has an opacity mask, or vertices with an opacity.
    pub(super) has_holes: bool,
    /// The camera sees through its back.
    pub(super) is_one_sided: bool,
    /// The camera sees through all of it.
    pub(super) hides_from_camera: bool,
}

impl MayPass {
    /// `MayPass` of each object, then of each sphere.
    pub(super) fn of_all(geometry: &Geometry, materials: &[Arc<dyn Material>]) -> Vec<MayPass> {
        let count = geometry.objects().len() + geometry.spheres().len();
        let material = |object: u32| &*materials[geometry.material_of(object) as usize];
        let placed = |object: u32| geometry.objects().get(object as usize);
        (0..count as u32).map(|object| MayPass::of(material(object), placed(object))).collect()
    }

    fn of(material: &dyn Material, placed: Option<&Placed>) -> MayPass {
        let has_opacities = |mesh: &Mesh| !mesh.vertex_opacity.is_empty();
        MayPass {
            has_holes: material.opacity().is_some()
                || placed.is_some_and(|placed| has_opacities(&placed.mesh)),
            is_one_sided: material.visible_sides() == Sides::Front,
            hides_from_camera: placed.is_some_and(|placed| placed.visibility == Visibility::NoCamera),
        }
    }
}
