//! Cameras, which look along the -z axis of their node.

use super::element::Element;
use super::graph::Placed;
use super::posed::Posed;
use bilux_import::FormatError;
use bilux_import::input::sink::Sink;
use bilux_math::DVec3;
use bilux_math::transcendental::{atan2_f64, tan_f64};
use bilux_scene::Spec;
use bilux_scene::cameras::CameraSpec;

/// The shape of a picture whose camera states one angle and no shape: that of the screens of the time.
const ASPECT: f64 = 4.0 / 3.0;

/// Adds the cameras of a node.
pub(super) fn place(placed: &Placed, posed: &Posed, sink: &mut Sink) -> Result<(), FormatError> {
    for instance in placed.node.children_named("instance_camera") {
        let found = posed.document.referred(instance, "url", &mut sink.diagnostics);
        let Some(camera) = found else { continue };
        let optics = camera.path(&["optics", "technique_common"]);
        let kinds = ["perspective", "orthographic"];
        let projection = kinds.iter().find_map(|kind| optics?.child(kind));
        let Some(projection) = projection else {
            sink.diagnostics.note("a camera has neither kind of projection: left out", || camera.at());
            continue;
        };
        let direction = |axis: DVec3| placed.world.transform_vector3(axis).try_normalize();
        let Some((forward, up)) = direction(DVec3::NEG_Z).zip(direction(DVec3::Y)) else {
            sink.diagnostics.note("a camera's node has a scale of zero: left out", || camera.at());
            continue;
        };
        let position = placed.world.w_axis.truncate();
        // Far from the origin, 32-bit floats may not resolve one metre.
        let ahead = position + forward * (1.0 + 1e-4 * position.abs().max_element());
        let mut spec = Spec::new(&placed.node.label(), projection.name())
            .with("position", position.as_vec3())
            .with("look_at", ahead.as_vec3())
            .with("up", up.as_vec3());
        spec.span = camera.at();
        view(projection, posed, &mut spec);
        sink.scene.cameras.push(CameraSpec { spec, keyframes: Vec::new() });
    }
    Ok(())
}

/// Sets what a camera sees: two of width, height and their ratio are stated, or one.
fn view(projection: Element, posed: &Posed, spec: &mut Spec) {
    let positive = |name: &str| posed.number_of(projection, name).filter(|number| *number > 0.0);
    let aspect = positive("aspect_ratio").filter(|aspect| (1e-3..1e3).contains(aspect));
    let is_perspective = projection.name() == "perspective";
    // Half of what is seen, at a distance of 1 or at any.
    let half = |name: &str| match is_perspective {
        true => positive(name).map(|degrees| tan_f64((degrees.clamp(0.01, 179.0) / 2.0).to_radians())),
        false => positive(name),
    };
    let names = if is_perspective { ["xfov", "yfov"] } else { ["xmag", "ymag"] };
    let (width, height) = (half(names[0]), half(names[1]));
    let ratio = aspect.or(width.zip(height).map(|(width, height)| width / height));
    let default = if is_perspective { tan_f64(20f64.to_radians()) } else { 1.0 };
    let height = height.or(width.map(|width| width / ratio.unwrap_or(ASPECT))).unwrap_or(default);
    if is_perspective {
        let degrees = 2.0 * atan2_f64(height, 1.0).to_degrees();
        spec.parameters.set("fov", degrees.clamp(0.01, 179.0) as f32);
        if let Some(ratio) = ratio.or(width.map(|_| ASPECT)) {
            spec.parameters.set("frame", ratio.clamp(0.0, 1000.0) as f32);
        }
    } else {
        let metres = 2.0 * height * posed.document.settings.unit;
        spec.parameters.set("height", metres.clamp(1e-9, 1e9) as f32);
    }
}
