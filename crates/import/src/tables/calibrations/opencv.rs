//! OpenCV's calibrations in YAML or JSON, and those of ROS (`camera_info`) and Kalibr, which say the same in other words.

use super::camera::{Lens, Model};
use super::document::{document, find, matrix, numbers, plain};
use super::rig::Rig;
use super::{CalibratedCameras, CalibrationFormatEntry};
use crate::FormatError;
use crate::bytes::text::whole_file;
use crate::input::reading::{Reading, Source};
use serde_json::{Map, Value};

pub(super) const FORMAT: CalibrationFormatEntry = CalibrationFormatEntry {
    is_binary: false,
    is_of: |file, bytes| {
        let begins = |with: &[u8]| bytes.trim_ascii_start().starts_with(with);
        file.ends_with(".yaml")
            || file.ends_with(".yml")
            || begins(b"%YAML")
            || begins(b"---")
            || begins(b"{")
    },
    read,
};

/// Names of the same things in programs and tutorials; letters' case, underlines and hyphens do not count.
const MATRIX: &[&str] = &["cameramatrix", "intrinsicmatrix", "intrinsics", "k", "mtx", "m"];
const COEFFICIENTS: &[&str] =
    &["distortioncoefficients", "distortioncoeffs", "distcoeffs", "distcoeff", "distortion", "dist", "d"];
const MODEL: &[&str] = &["distortionmodel", "model", "fisheyemodel"];
const WIDTH: &[&str] = &["imagewidth", "width", "w"];
const HEIGHT: &[&str] = &["imageheight", "height", "h"];
const SIZE: &[&str] = &["imagesize", "resolution", "size", "imgsize"];

fn read(_: &mut Reading, source: &Source) -> Result<CalibratedCameras, FormatError> {
    let at = whole_file(source.name);
    let tree = document(source)?;
    let Value::Object(all) = tree else {
        return Err(FormatError::malformed("this is no list of names and values", at));
    };
    let mut read = CalibratedCameras::default();
    // Each camera in a map of its own, as in Kalibr's files; or all in one, those of stereo pairs by numbers.
    let own = all.iter().filter_map(|(name, value)| Some((name.as_str(), value.as_object()?)));
    let own: Vec<_> = own.filter(|(_, map)| find(map, MATRIX, "").is_some()).collect();
    let (parts, is_one) = if own.is_empty() { (vec![("", &all)], true) } else { (own, false) };
    let mut rig = Rig::default();
    for (name, map) in parts {
        for number in ["", "1", "2", "3", "4"] {
            let Some(matrix) = find(map, MATRIX, number) else { continue };
            let size = if is_one { &all } else { map };
            let lens = lens(map, matrix, number, size).map_err(|message| {
                let which = if name.is_empty() { String::new() } else { format!("{name}: ") };
                FormatError::malformed(format!("{which}{message}"), at.clone())
            })?;
            let named =
                map.iter().find(|(key, _)| plain(key) == "cameraname").and_then(|(_, name)| name.as_str());
            let name = match (name, number, named) {
                ("", "", named) => named.unwrap_or_default(),
                ("", number, _) => number,
                (name, ..) => name,
            };
            read.cameras.push(lens.spec(name, None, &at)?);
            rig.add(map, number).map_err(|message| FormatError::malformed(message, at.clone()))?;
        }
    }
    rig.place(&mut read, &at)?;
    if read.cameras.is_empty() {
        let message = "there is no camera matrix: write it as camera_matrix, with 3 rows and 3 columns";
        return Err(FormatError::malformed(message, at));
    }
    Ok(read)
}

fn lens(map: &Map<String, Value>, k: &Value, number: &str, all: &Map<String, Value>) -> Result<Lens, String> {
    let k = matrix(k, "the camera matrix")?;
    let (focal, centre, skew) = match k[..] {
        [fx, skew, cx, below, fy, cy, left, middle, one] => {
            if [below, left, middle].iter().any(|x| *x != 0.0) || one == 0.0 {
                return Err(
                    "the camera matrix must be upper triangular: transpose it if it is not".to_owned()
                );
            }
            ([fx / one, fy / one], [cx / one, cy / one], skew / one)
        }
        // Kalibr's.
        [fx, fy, cx, cy] => ([fx, fy], [cx, cy], 0.0),
        _ => return Err(format!("the camera matrix has {} numbers, but 3 rows of 3", k.len())),
    };
    let coefficients = match find(map, COEFFICIENTS, number) {
        Some(value) => matrix(value, "the distortion")?,
        None => Vec::new(),
    };
    let model = find(map, MODEL, number).or_else(|| find(map, MODEL, ""));
    let model = match model.map(|value| value.as_str().map_or_else(|| value.to_string(), plain)) {
        None => Model::OpenCv,
        Some(name) => match name.as_str() {
            "plumbbob" | "rationalpolynomial" | "radtan" | "radialtangential" | "brownconrady"
            | "pinhole" | "opencv" | "thinprism" | "none" | "0" | "false" => Model::OpenCv,
            "equidistant" | "fisheye" | "equi" | "kannalabrandt" | "opencvfisheye" | "1" | "true" => {
                Model::Fisheye
            }
            other => {
                return Err(format!(
                    "the distortion model '{other}' is not supported: use plumb_bob or equidistant"
                ));
            }
        },
    };
    if model == Model::Fisheye && !matches!(coefficients.len(), 0 | 4) {
        return Err(format!("a fisheye lens has 4 coefficients, not {}", coefficients.len()));
    }
    if model == Model::OpenCv && !matches!(coefficients.len(), 0 | 4 | 5 | 8 | 12 | 14) {
        return Err(format!(
            "the distortion has {} numbers, but OpenCV has 4, 5, 8, 12 or 14",
            coefficients.len()
        ));
    }
    Ok(Lens {
        model,
        size: size(map).or_else(|| size(all)).ok_or(NO_SIZE)?,
        focal,
        centre,
        skew,
        coefficients,
    })
}

const NO_SIZE: &str = "the size of the pictures is missing: add image_width and image_height";

fn size(map: &Map<String, Value>) -> Option<[u32; 2]> {
    let side = |names| find(map, names, "").and_then(Value::as_u64);
    if let Some((width, height)) = side(WIDTH).zip(side(HEIGHT)) {
        return Some([u32::try_from(width).ok()?, u32::try_from(height).ok()?]);
    }
    let both = numbers(find(map, SIZE, "")?)?;
    let [width, height] = both[..] else { return None };
    Some([width as u32, height as u32])
}
