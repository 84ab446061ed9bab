//! `transforms.json`: the cameras of a capture, as programs for radiance fields write it.
//!
//! The lens is that of all frames, or each frame has its own; a frame's matrix is its place in the world, with OpenGL's axes.

use super::camera::{Lens, Model, Pose};
use super::document::{document, numbers};
use super::{CalibratedCameras, CalibrationFormatEntry};
use crate::FormatError;
use crate::bytes::text::whole_file;
use crate::input::reading::{Reading, Source};
use bilux_math::{DMat3, DVec3};
use bilux_scene::{Span, Spec, Value as SpecValue};
use serde_json::Value;

pub(super) const FORMAT: CalibrationFormatEntry = CalibrationFormatEntry {
    is_binary: false,
    is_of: |_, bytes| {
        bytes.trim_ascii_start().starts_with(b"{") && bytes.windows(18).any(|w| w == b"\"transform_matrix\"")
    },
    read,
};

fn read(_: &mut Reading, source: &Source) -> Result<CalibratedCameras, FormatError> {
    let tree = document(source)?;
    let at = whole_file(source.name);
    let mut read = CalibratedCameras { are_placed: true, ..CalibratedCameras::default() };
    let Some(frames) = tree.get("frames").and_then(Value::as_array) else {
        return Err(FormatError::malformed("the list of frames is missing: frames", at));
    };
    for (i, frame) in frames.iter().enumerate() {
        let wrong = |message: String| FormatError::malformed(format!("frame {i}: {message}"), at.clone());
        let of = |key: &str| frame.get(key).or_else(|| tree.get(key));
        let matrix = frame.get("transform_matrix").and_then(numbers).filter(|m| m.len() >= 12);
        let m = matrix
            .ok_or_else(|| wrong("transform_matrix is no matrix of 4 rows and 4 columns".to_owned()))?;
        let axes = DMat3::from_cols_array(&[m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10]]);
        let pose = Pose::of_camera_to_world(axes, DVec3::new(m[3], m[7], m[11]), &at);
        let pose = pose.map_err(|error| in_frame(i, error))?;
        let name = frame.get("file_path").and_then(Value::as_str).unwrap_or_default();
        let name = name.strip_prefix("./").unwrap_or(name);
        let spec = match lens(&of).map_err(wrong)? {
            Some(lens) => lens.spec(name, Some(&pose), &at).map_err(|error| in_frame(i, error))?,
            None => without_size(&of, name, &pose, &at).map_err(wrong)?,
        };
        read.cameras.push(spec);
    }
    if read.cameras.iter().any(|spec| spec.kind == "perspective") {
        let message = "the file does not say the size of its pictures (w and h): they are taken for squares";
        read.warnings.push(message.to_owned());
    }
    Ok(read)
}

fn in_frame(frame: usize, error: FormatError) -> FormatError {
    match error {
        FormatError::Malformed { message, at } => {
            FormatError::malformed(format!("frame {frame}: {message}"), at)
        }
        error => error,
    }
}

/// The lens; `None` if the file does not say the size of its pictures.
fn lens<'v>(of: &impl Fn(&str) -> Option<&'v Value>) -> Result<Option<Lens>, String> {
    let number = |key: &str| of(key).and_then(Value::as_f64);
    let (Some(width), Some(height)) = (number("w"), number("h")) else { return Ok(None) };
    let by_angle = |angle: &str, side: f64| {
        let half = number(angle)? * 0.5;
        Some(0.5 * side / bilux_math::transcendental::tan_f64(half))
    };
    let fx = number("fl_x").or_else(|| by_angle("camera_angle_x", width));
    let fx = fx.ok_or("the focal length is missing: fl_x or camera_angle_x")?;
    let fy = number("fl_y").or_else(|| by_angle("camera_angle_y", height)).unwrap_or(fx);
    let centre = [number("cx").unwrap_or(0.5 * width), number("cy").unwrap_or(0.5 * height)];
    let model = of("camera_model").and_then(Value::as_str).unwrap_or("OPENCV");
    let is_fisheye = model == "OPENCV_FISHEYE" || of("is_fisheye").and_then(Value::as_bool) == Some(true);
    let (model, order) = match model {
        _ if is_fisheye => (Model::Fisheye, &["k1", "k2", "k3", "k4"][..]),
        "OPENCV" | "PINHOLE" | "SIMPLE_PINHOLE" | "SIMPLE_RADIAL" | "RADIAL" | "FULL_OPENCV" => {
            (Model::OpenCv, &["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"][..])
        }
        other => {
            return Err(format!("the camera model {other} is not supported: use OPENCV or OPENCV_FISHEYE"));
        }
    };
    let coefficients = order.iter().map(|key| number(key).unwrap_or(0.0)).collect();
    let size = [width as u32, height as u32];
    Ok(Some(Lens { model, size, focal: [fx, fy], centre, skew: 0.0, coefficients }.counted_from_corner()))
}

/// A camera of square pictures of any size.
fn without_size<'v>(
    of: &impl Fn(&str) -> Option<&'v Value>,
    name: &str,
    pose: &Pose,
    at: &Span,
) -> Result<Spec, String> {
    let angle = of("camera_angle_x").and_then(Value::as_f64);
    let angle =
        angle.ok_or("the size of the pictures is missing: w and h, or camera_angle_x of square ones")?;
    let mut spec = Spec { span: at.clone(), ..Spec::new(name, "perspective") };
    spec.parameters.set("fov", SpecValue::Number(angle.to_degrees()));
    pose.place(&mut spec);
    Ok(spec)
}
