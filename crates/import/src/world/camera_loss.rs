//! Losses of cameras in formats that know only plain perspective ones.

use crate::output::writing::Writing;
use bilux_math::transcendental::{atan, tan};
use bilux_scene::{SceneBuilder, Spec, Value};

/// Warns about a camera that is more than a perspective one.
pub fn not_perspective(spec: &Spec, format: &str, writing: &mut Writing) {
    if spec.kind != "perspective" {
        writing.warn(format!(
            "{format} files cannot store cameras of the kind '{}': a perspective one from the same place is written",
            spec.kind
        ));
    }
    let plain = [
        ("principal_x", 0.5),
        ("principal_y", 0.5),
        ("shift_x", 0.0),
        ("shift_y", 0.0),
        ("pixel_aspect", 1.0),
        ("skew", 0.0),
        ("blades", 0.0),
        ("focus_tilt_x", 0.0),
        ("focus_tilt_y", 0.0),
    ];
    for (key, default) in plain {
        if spec.kind == "perspective" && spec.number(key).is_some_and(|value| value != default) {
            writing.warn(format!("{format} files cannot store '{key}' of a camera: left out"));
        }
    }
    let eyes = spec.parameters.find("stereo").map(|(value, _)| value);
    if spec.kind == "perspective" && eyes.is_some_and(|eyes| *eyes != "none".into()) {
        writing
            .warn(format!("{format} files cannot store pairs of eyes: the camera in the middle is written"));
    }
}

/// The vertical field of view in degrees that is nearest to a camera's.
pub fn field_of_view(spec: &Spec) -> f32 {
    let in_pixels = |key: &str, default: f32| spec.number(key).unwrap_or(default);
    let degrees = match spec.kind.as_str() {
        "opencv" | "opencv-fisheye" => {
            2.0 * atan(0.5 * in_pixels("height", 480.0) / in_pixels("fy", 525.0)).to_degrees()
        }
        "perspective" => return spec.number("fov").unwrap_or(40.0),
        _ => spec.number("fov").unwrap_or(90.0),
    };
    degrees.clamp(1.0, 120.0)
}

/// Vertical field of view as in [`field_of_view`], in a picture of this aspect ratio, which shows more where the camera's `frame`
/// would not fit.
pub fn field_of_view_in(spec: &Spec, aspect: f32) -> f32 {
    let vertical = field_of_view(spec);
    let wider = spec.number("frame").map_or(1.0, |frame| frame / aspect);
    if wider <= 1.0 {
        return vertical;
    }
    2.0 * atan(tan(0.5 * vertical.to_radians()) * wider).to_degrees()
}

/// The aspect ratio of the scene's picture, if the scene states its size.
pub fn picture_aspect_ratio(scene: &SceneBuilder) -> Option<f32> {
    let Some((Value::Text(size), _)) = scene.settings.find("size") else { return None };
    let (width, height) = size.split_once('x')?;
    let [width, height]: [f32; 2] = [width.trim().parse().ok()?, height.trim().parse().ok()?];
    Some(width / height).filter(|shape| shape.is_finite() && *shape > 0.0)
}
