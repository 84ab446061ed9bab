//! Prepares a model for the camera: rotated upright, its front to +z, in metres, and near the origin.

use super::super::{affine, move_all};
use super::Studio;
use crate::builder::SceneBuilder;
use crate::lights::surrounds;
use crate::materials::scale_lengths;
use crate::orientation::{Orientation, UpHint};
use crate::parameters::Spec;
use bilux_math::{DMat3, DVec3};
use std::sync::Arc;

/// Models farther from the origin than this many times their own size are moved there.
const FAR: f64 = 32.0;

/// Rotates a scene as the user asks, or otherwise by its format or its shape; `None` if it stays as it is.
///
/// A scene with its own camera, or with a light that has a place in it, is only rotated if the user asks, and is not
/// translated.
pub fn set_upright(scene: &mut SceneBuilder, studio: &Studio) -> Option<Orientation> {
    let is_asked = studio.up.is_some() || studio.front.is_some();
    let is_bare = scene.cameras.is_empty() && scene.lights.iter().all(is_around);
    if scene.objects.is_empty() || !(is_asked || is_bare) {
        return None;
    }
    let orientation = Orientation::of(scene, studio.up, studio.front)?;
    let (mut linear, mut shift) = (orientation.upright(), DVec3::ZERO);
    if is_bare {
        let seen = scene.movement.as_deref().unwrap_or(scene);
        let bounds = seen.bounds(0.0);
        let middle = (bounds.min.as_dvec3() + bounds.max.as_dvec3()) * 0.5;
        let size = (bounds.max.as_dvec3() - bounds.min.as_dvec3()).length();
        if !bounds.is_empty() && middle.is_finite() && middle.length() > FAR * size {
            // Rounded to f32, so that subtracting it from coordinates is exact.
            shift = linear * -middle.as_vec3().as_dvec3();
        } else if scene.unit > 0.0 && scene.unit.is_finite() {
            linear *= scene.unit;
            // What is inside, too: as deep a colour, as dense a smoke.
            for material in &mut scene.materials {
                scale_lengths(material, scene.unit);
            }
        }
    }
    let is_open = scene.up != UpHint::default();
    if (linear, shift) == (DMat3::IDENTITY, DVec3::ZERO) {
        return (is_asked || is_open).then_some(orientation);
    }
    let by = affine(linear, shift);
    move_all(scene, &by);
    if let Some(movement) = &mut scene.movement {
        move_all(Arc::make_mut(movement), &by);
    }
    // Nothing may rotate it a second time.
    (scene.up, scene.unit) = (UpHint::default(), 0.0);
    Some(orientation)
}

/// True for a light that comes from all around, and for a backdrop.
pub(super) fn is_around(light: &Spec) -> bool {
    surrounds(&light.kind) || light.kind == "ambient"
}
