//! `paper`: rays from (0, 0, -1) through each pixel of the screen, as in section 3 of the paper.
//!
//! For details that the paper leaves open, see `docs/adr/0007-paper-preset.md`.

use super::{PresetEntry, affine, course, move_all, set_all};
use crate::builder::SceneBuilder;
use crate::cameras::CameraSpec;
use crate::messages::error::SceneError;
use crate::parameters::{Spec, Value};
use bilux_math::registry::Entry;
use bilux_math::{DMat3, DVec3, Vec3};

pub(super) const ENTRY: PresetEntry = PresetEntry {
    entry: Entry {
        name: "paper",
        summary: "the eye at (0, 0, -1), the screen from -1 to 1 at z = 0, and the scene just behind it",
        source: "",
        parameters: &[],
    },
    apply,
};

/// Radius of the sphere that touches the screen and, as seen from one unit in front of it, all four of its edges:
/// `radius / (radius + 1) = sin 45°`.
const RADIUS: f64 = 1.0 + std::f64::consts::SQRT_2;

fn apply(scene: &mut SceneBuilder) -> Result<(), SceneError> {
    let bounds = scene.bounds(0.0);
    if !bounds.is_empty() {
        let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let radius = (high - low).length() * 0.5;
        // Rotate as the course's renderer rotates models, and then into the space of its camera.
        let turn = course::FIRST_VIEW.axes().transpose() * course::turn();
        let linear = turn * if radius > 0.0 { RADIUS / radius } else { 1.0 };
        move_all(scene, &affine(linear, DVec3::Z * RADIUS - linear * ((low + high) * 0.5)));
    }
    let eye = Spec::new("paper", "perspective")
        .with("position", Vec3::NEG_Z)
        .with("look_at", Vec3::ZERO)
        .with("fov", 90.0f32)
        .with("mirrored", true);
    scene.cameras = vec![CameraSpec { spec: eye, keyframes: Vec::new() }];
    scene.lights = course::lights(&DMat3::IDENTITY);
    set_all(scene, &[("integrator", Value::from("whitted"))]);
    Ok(())
}
