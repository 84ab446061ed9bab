//! Pictures and calibrated cameras from files, and how much pictures differ.

use crate::ending::without_gil;
use crate::errors::{exception, of_picture, warn, warn_of_picture};
use crate::memory;
use crate::picture::Picture;
use crate::source::Source;
use crate::values::Spec;
use bilux::Display;
use bilux::formats::ReadOptions;
use bilux::scene::{SceneBuilder, Span, Warning};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Reads a picture file.
///
/// Args:
///     file: a PNG, EXR, HDR, PFM, PPM, JPEG, WebP, TIFF, BMP, TGA or KTX2: a path, bytes, or a file that is open in binary
///         mode.
///     format: the format (`bilux.picture_formats`), where neither its bytes nor its name says it.
///
/// Returns:
///     the picture in linear light, with all layers of an EXR. What is odd about the file is a `SceneWarning`.
///
/// Raises:
///     FileNotFoundError: if there is no such file.
///     PictureError: if it is no picture.
///
/// Example:
///     >>> bilux.Picture(np.ones((2, 3, 3))).save("white.png")
///     >>> bilux.read_picture("white.png").pixels.shape
///     (2, 3, 3)
#[pyfunction]
#[pyo3(signature = (file, *, format = None))]
pub(crate) fn read_picture(
    py: Python<'_>,
    file: &Bound<'_, PyAny>,
    format: Option<&str>,
) -> PyResult<Picture> {
    let limits = memory::for_picture_files();
    let mut source = Source::of("file", file, limits.max_bytes)?;
    if format.is_some() {
        source = source.opened(py, limits.max_bytes)?;
    }
    let extension = format.map(str::to_owned).or_else(|| source.extension());
    let picture = without_gil(py, || match &source {
        Source::Path(path) => bilux::pictures::read_crop(path, &limits),
        Source::Bytes { bytes, .. } => {
            bilux::pictures::formats::read_crop_bytes(bytes, extension.as_deref(), &limits)
        }
    });
    let picture = picture.map(bilux::pictures::Picture::into_linear).map_err(of_picture)?;
    warn_of_picture(py, &source.name(), &picture.warnings)?;
    Picture::of(py, &picture, Display::default(), None)
}

/// Reads calibrated cameras.
///
/// Args:
///     path: the file: OpenCV's YAML or JSON, also as ROS and Kalibr write it; COLMAP's images.txt or images.bin with the cameras
///         beside it, or these alone; or transforms.json as programs for radiance fields write it.
///
/// Returns:
///     the cameras, `bilux.cameras.opencv`, `opencv_fisheye` or `perspective`, with the names that they or their pictures have in the
///     file. They stand where the file says; where it does not, set `position`, `look_at` and `up`. What the file does not say is a
///     `SceneWarning`.
///
/// Raises:
///     FileNotFoundError: if there is no such file.
///     FormatError: if it is in no such format, broken, or has a lens that is not known.
///
/// Example:
///     >>> scene.cameras = bilux.read_cameras("sparse/0/images.txt")  # doctest: +SKIP
#[pyfunction]
pub(crate) fn read_cameras(py: Python<'_>, path: PathBuf) -> PyResult<Vec<Spec>> {
    let options = ReadOptions::default();
    let options = ReadOptions { max_memory: memory::within_limits(options.max_memory), ..options };
    let read = without_gil(py, || bilux::formats::read_cameras(&path, &options)).map_err(exception)?;
    let at = Span { file: path.display().to_string().into(), line: 0, column: 0 };
    let warnings = read.warnings.into_iter().map(|message| Warning { message, at: at.clone() });
    warn(py, &warnings.collect::<Vec<_>>())?;
    let scene = SceneBuilder::default();
    read.cameras.iter().map(|camera| Spec::of(py, "cameras", camera, &scene)).collect()
}

/// Measures how much a picture differs from a reference.
///
/// Args:
///     picture: a Picture, or an array as Picture takes it.
///     reference: the same for what it should look like.
///
/// Returns:
///     the value of each metric by its name (`bilux.metrics`): "rmse", "relmse" and "max" of the light, "psnr", "ssim"
///     and "flip" of what a display shows. Equal pictures have an infinite "psnr".
///
/// Raises:
///     PictureError: if their sizes differ, or one has no colours.
///
/// Example:
///     >>> black, grey = np.zeros((8, 8, 3)), np.full((8, 8, 3), 0.5)
///     >>> bilux.compare(grey, black)["rmse"]
///     0.5
#[pyfunction]
pub(crate) fn compare<'py>(
    py: Python<'py>,
    picture: &Bound<'py, PyAny>,
    reference: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    crate::forks::check()?;
    let (picture, reference) = (any_picture(picture)?, any_picture(reference)?);
    let report = without_gil(py, || bilux::pictures::compare(&picture, &reference)).map_err(of_picture)?;
    let values = PyDict::new(py);
    for (name, value) in report.values {
        values.set_item(name, value)?;
    }
    Ok(values)
}

fn any_picture(argument: &Bound<'_, PyAny>) -> PyResult<bilux::pictures::Picture> {
    let py = argument.py();
    match argument.cast::<Picture>() {
        Ok(picture) => picture.get().to_rust(py),
        Err(_) => Picture::new(py, argument, None, None)?.to_rust(py),
    }
}
