//! Files of calibrated cameras. The table is [`CALIBRATION_FORMATS`].

mod camera;
mod colmap;
mod document;
mod opencv;
mod rig;
mod transforms;

use crate::bytes::text::{plain, whole_file};
use crate::input::reading::{Reading, Source};
use crate::{FormatError, ReadOptions};
use bilux_scene::Spec;
use std::path::Path;
use std::sync::Arc;

/// All formats of calibrated cameras.
static CALIBRATION_FORMATS: &[CalibrationFormatEntry] =
    &[colmap::BINARY, colmap::TEXT, transforms::FORMAT, opencv::FORMAT];

/// A row of [`CALIBRATION_FORMATS`].
struct CalibrationFormatEntry {
    /// Whether its bytes are no text.
    is_binary: bool,
    /// True if it is the format of a file of this name with these bytes.
    is_of: fn(&str, &[u8]) -> bool,
    /// Reads a file; some have their other half in a second one beside it.
    read: fn(&mut Reading, &Source) -> Result<CalibratedCameras, FormatError>,
}

/// The cameras of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CalibratedCameras {
    /// Specs of the kinds `opencv`, `opencv-fisheye` or `perspective`, with the names that the file has for them or their pictures.
    pub cameras: Vec<Spec>,
    /// Whether the file says where they are.
    pub are_placed: bool,
    /// Whether it only says how they stand to the first of them, which is then at the origin and looks along -z, with y upwards.
    pub are_relative: bool,
    /// Sentences on what the file says and is not used.
    pub warnings: Vec<String>,
}

/// Reads calibrated cameras: OpenCV's YAML or JSON, also as ROS and Kalibr write it; COLMAP's `images.txt` or `images.bin`, with the
/// cameras beside it, or only these; or `transforms.json` as programs for radiance fields write it.
///
/// # Errors
/// When the file is in no such format or broken, has a lens that no camera here has, or takes more memory than allowed.
pub fn read_cameras(path: &Path, options: &ReadOptions) -> Result<CalibratedCameras, FormatError> {
    let mut reading = Reading::new(options, path.parent());
    let bytes = reading.load(path)?;
    let name = Arc::from(path.display().to_string());
    let text = plain(&bytes);
    let source = Source { bytes: &text, name: &name, folder: path.parent() };
    if source.bytes.is_empty() {
        return Err(FormatError::malformed("the file is empty", whole_file(&name)));
    }
    let file = path.file_name().map_or_else(String::new, |file| file.to_string_lossy().to_lowercase());
    let row = CALIBRATION_FORMATS.iter().find(|row| (row.is_of)(&file, &bytes)).ok_or_else(|| {
        let message = "this is no file of calibrated cameras: known are OpenCV's YAML and JSON, COLMAP's images.txt, \
                       cameras.txt and their .bin, and transforms.json";
        FormatError::malformed(message, whole_file(&name))
    })?;
    // Parsed text takes several times the memory of its bytes.
    reading.budget.take_bytes(16 * bytes.len() as u64, &name)?;
    let source = if row.is_binary { Source { bytes: &bytes, ..source } } else { source };
    let read = (row.read)(&mut reading, &source)?;
    match read.warnings.first() {
        Some(first) if options.strict => Err(FormatError::malformed(first.clone(), whole_file(&name))),
        _ if read.cameras.is_empty() => {
            Err(FormatError::malformed("there is no camera in this file", whole_file(&name)))
        }
        _ => Ok(read),
    }
}
