//! Cameras, which look along their -z axis.

use crate::geometry::meshes::name_of;
use crate::stage::Stage;
use crate::stage::context::Context;
use bilux_import::FormatError;
use bilux_math::transcendental::atan2_f64;
use bilux_math::{DMat4, DVec3};
use bilux_scene::Spec;
use bilux_scene::cameras::CameraSpec;

/// Lengths of the film and of the lens are in tenths of the scene's unit.
const TENTH: f64 = 0.1;

/// Adds the camera of a prim.
pub(crate) fn add(stage: &Stage, prim: u32, world: &DMat4, context: &mut Context) -> Result<(), FormatError> {
    let budget = &mut context.reading.budget;
    let axis = |v: DVec3| world.transform_vector3(v).try_normalize();
    let (Some(forward), Some(up)) = (axis(DVec3::NEG_Z), axis(DVec3::Y)) else {
        context.sink.diagnostics.note("a camera has a scale of zero: left out", || stage.at(prim));
        return Ok(());
    };
    let mut number = |name: &str, default: f64| -> Result<f64, FormatError> {
        Ok(stage.number(prim, name, budget)?.unwrap_or(default))
    };
    let (width, height) = (number("horizontalAperture", 20.955)?, number("verticalAperture", 15.2908)?);
    let (x, y) = (number("horizontalApertureOffset", 0.0)?, number("verticalApertureOffset", 0.0)?);
    let (length, stop) = (number("focalLength", 50.0)?, number("fStop", 0.0)?);
    let focus = number("focusDistance", 0.0)?;
    let is_parallel = stage.text(prim, "projection", budget)?.as_deref() == Some("orthographic");
    let kind = if is_parallel { "orthographic" } else { "perspective" };
    let position = world.w_axis.truncate();
    let ahead = position + forward * (1.0 + 1e-4 * position.abs().max_element());
    let mut spec = Spec::new(name_of(stage, prim), kind)
        .with("position", position.as_vec3())
        .with("look_at", ahead.as_vec3())
        .with("up", up.as_vec3());
    spec.span = stage.at(prim);
    if !(width > 0.0 && height > 0.0 && length > 0.0) {
        context
            .sink
            .diagnostics
            .note("a camera has no aperture or no focal length: left out", || stage.at(prim));
        return Ok(());
    }
    if is_parallel {
        spec.parameters.set("height", (height * TENTH).clamp(1e-9, 1e9) as f32);
    } else {
        let fov: f64 = 2.0 * atan2_f64(0.5 * height, length).to_degrees();
        spec.parameters.set("fov", fov.clamp(0.01, 179.0) as f32);
        spec.parameters.set("frame", (width / height).clamp(0.0, 1000.0) as f32);
        if x != 0.0 || y != 0.0 {
            spec.parameters.set("principal_x", (0.5 - x / width).clamp(-100.0, 100.0) as f32);
            spec.parameters.set("principal_y", (0.5 + y / height).clamp(-100.0, 100.0) as f32);
        }
        if stop > 0.0 && focus > 0.0 {
            spec.parameters.set("aperture", (0.5 * length * TENTH / stop).clamp(0.0, 1e6) as f32);
            spec.parameters.set("focus", focus.clamp(0.0, 1e9) as f32);
        }
    }
    context.sink.scene.cameras.push(CameraSpec { spec, keyframes: Vec::new() });
    Ok(())
}
