//! Cameras, lights and settings for scenes without them. Each preset has its own file; the table is [`PRESETS`].
//!
//! [`apply`] replaces a scene's own camera, lights and settings with those of a preset; [`complete`] only adds what a
//! scene lacks to be visible at all.

mod course;
mod fog;
mod paper;
mod stroke_widths;
mod studio;

pub use fog::add_fog;
pub use stroke_widths::set_stroke_widths;
pub use studio::{
    Ground, Studio, add_missing, added_lights, complete, frame, has_own_light, is_unlit, may_be_lit,
    mentions_light, seems_lit, set_upright, shadow_catcher,
};

use crate::builder::SceneBuilder;
use crate::messages::error::SceneError;
use crate::parameters::{Span, Value};
use bilux_math::registry::Entry;
use bilux_math::{DMat3, DMat4, DVec3, Motion, Transform};

/// A row of [`PRESETS`].
#[derive(Clone, Copy, Debug)]
pub struct PresetEntry {
    /// Name, summary, source; presets have no parameters.
    pub entry: Entry,
    /// Changes a scene.
    pub apply: fn(&mut SceneBuilder) -> Result<(), SceneError>,
}

/// All presets.
pub static PRESETS: &[PresetEntry] = &[studio::ENTRY, course::ENTRY, course::SECOND, paper::ENTRY];

/// Applies the preset of this name.
///
/// # Errors
/// When there is no such preset, or it cannot be applied to the scene.
pub fn apply(name: &str, scene: &mut SceneBuilder) -> Result<(), SceneError> {
    let names = PRESETS.iter().map(|row| row.entry.name);
    let row = PRESETS
        .iter()
        .find(|row| row.entry.name == name)
        .ok_or_else(|| SceneError::unknown("preset", name, names, &Span::default()))?;
    (row.apply)(scene)
}

/// Moves all objects.
fn move_all(scene: &mut SceneBuilder, by: &Transform) {
    let by = Motion::still(*by);
    for object in &mut scene.objects {
        object.motion = object.motion.then(&by);
    }
}

/// The affine map `p ↦ linear · p + translation`.
fn affine(linear: DMat3, translation: DVec3) -> Transform {
    let mut matrix = DMat4::from_mat3(linear);
    matrix.w_axis = translation.extend(1.0);
    Transform::from_matrix(matrix).unwrap_or_default()
}

fn set_all(scene: &mut SceneBuilder, settings: &[(&str, Value)]) {
    for (key, value) in settings {
        scene.settings.set(key, value.clone());
    }
}
