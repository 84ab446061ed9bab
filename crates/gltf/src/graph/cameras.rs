//! Cameras, which look along the -z axis of their node.

use crate::document::json::JsonNode;
use bilux_import::FormatError;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_math::{DMat4, DVec3};
use bilux_scene::Spec;
use bilux_scene::cameras::CameraSpec;

/// A camera at its node; `None`, with a warning, if the node's transform leaves it no direction.
pub(crate) fn camera(
    camera: JsonNode,
    node: JsonNode,
    world: &DMat4,
    diagnostics: &mut Diagnostics,
) -> Result<Option<CameraSpec>, FormatError> {
    let kind = camera.need("type")?;
    let lens = camera.need(match kind.as_text()? {
        "perspective" => "perspective",
        "orthographic" => "orthographic",
        other => {
            return Err(
                kind.error(format!("'{other}' is not a type of camera: use perspective or orthographic"))
            );
        }
    })?;
    let name = if node.name().is_empty() { camera.name() } else { node.name() };
    let axis = |v: DVec3| world.transform_vector3(v).try_normalize();
    let (Some(forward), Some(up)) = (axis(DVec3::NEG_Z), axis(DVec3::Y)) else {
        diagnostics.note("a camera's node has a scale of zero: left out", || node.at());
        return Ok(None);
    };
    let position = world.w_axis.truncate();
    // Far from the origin, 32-bit floats may not resolve one metre.
    let ahead = position + forward * (1.0 + 1e-4 * position.abs().max_element());
    let mut spec = Spec::new(name, kind.as_text()?)
        .with("position", position.as_vec3())
        .with("look_at", ahead.as_vec3())
        .with("up", up.as_vec3());
    spec.span = camera.at();
    if kind.as_text()? == "perspective" {
        let fov = lens.need("yfov")?.as_number()?.to_degrees();
        if !(0.01..=179.0).contains(&fov) {
            diagnostics
                .note("a camera's yfov is out of range: it is limited to 0.01 to 179 degrees", || lens.at());
        }
        spec.parameters.set("fov", fov.clamp(0.01, 179.0) as f32);
        if let Some(shape) = lens.get("aspectRatio") {
            spec.parameters.set("frame", shape.as_number()?.clamp(0.0, 1000.0) as f32);
        }
        if world.determinant() < 0.0 {
            spec.parameters.set("mirrored", true);
        }
    } else {
        let half = lens.need("ymag")?.as_number()?.abs();
        if !(5e-10..=5e8).contains(&half) {
            diagnostics.note("a camera's ymag is out of range: it is limited to 5e-10 to 5e8", || lens.at());
        }
        spec.parameters.set("height", (2.0 * half).clamp(1e-9, 1e9) as f32);
    }
    Ok(Some(CameraSpec { spec, keyframes: Vec::new() }))
}
