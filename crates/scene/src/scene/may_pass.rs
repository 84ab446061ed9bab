//! What may let rays pass.

use crate::lights::Sides;
use crate::materials::Material;

/// Which rays an object may let pass.
#[derive(Clone, Copy)]
pub(super) struct MayPass {
    /// It has an opacity mask.
    pub(super) has_holes: bool,
    /// The camera sees through its back.
    pub(super) is_one_sided: bool,
}

impl MayPass {
    pub(super) fn of(material: &dyn Material) -> MayPass {
        MayPass {
            has_holes: material.opacity().is_some(),
            is_one_sided: material.visible_sides() == Sides::Front,
        }
    }
}
