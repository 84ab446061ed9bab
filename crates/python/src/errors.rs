//! Errors as Python exceptions. The classes are in `bilux/_errors.py`; the texts are those of the Rust errors.

use bilux::formats::FormatError;
use bilux::pictures::PictureError;
use bilux::scene::{SceneError, Warning};
use bilux::wording::in_python;
use pyo3::exceptions::{PyFileNotFoundError, PyOSError};
use pyo3::prelude::*;
use std::ffi::CString;
use std::io::ErrorKind;
use std::path::Path;

/// The exception classes.
mod classes {
    pyo3::import_exception!(bilux._errors, Error);
    pyo3::import_exception!(bilux._errors, FormatError);
    pyo3::import_exception!(bilux._errors, PictureError);
    pyo3::import_exception!(bilux._errors, RenderError);
    pyo3::import_exception!(bilux._errors, SceneError);
}

pub(crate) use classes::Error;

/// Any error as the exception of its kind.
pub(crate) fn exception(error: impl Into<bilux::Error>) -> PyErr {
    let error = error.into();
    let text = error.to_string();
    of_text(&error, text)
}

/// The exception of an error's kind, with this text and the keyword that allows what was refused.
pub(crate) fn of_text(error: &bilux::Error, text: String) -> PyErr {
    let text = in_python(&text) + &allowing(error);
    match error {
        bilux::Error::Format(FormatError::Io { source, .. }) if source.kind() == ErrorKind::NotFound => {
            PyFileNotFoundError::new_err(text)
        }
        bilux::Error::Format(FormatError::Scene(_))
        | bilux::Error::Scene(_)
        | bilux::Error::Settings(_)
        | bilux::Error::Encoding(_) => classes::SceneError::new_err(text),
        bilux::Error::Format(_) => classes::FormatError::new_err(text),
        bilux::Error::Picture(_) => classes::PictureError::new_err(text),
        bilux::Error::Render(_) | bilux::Error::Film(_) | bilux::Error::TooLarge { .. } => {
            classes::RenderError::new_err(text)
        }
        _ => Error::new_err(text),
    }
}

/// The keyword that allows what the library refused.
fn allowing(error: &bilux::Error) -> String {
    match (error.memory_to_allow(), error) {
        (Some(bytes), _) if bytes.is_multiple_of(1 << 30) => format!(" (max_memory={} << 30)", bytes >> 30),
        (Some(bytes), _) => format!(" (max_memory={} << 20)", bytes.div_ceil(1 << 20)),
        (None, bilux::Error::Format(FormatError::Outside { .. })) => " (allow_outside=True)".to_owned(),
        _ => String::new(),
    }
}

/// The exception for a file that cannot be opened.
pub(crate) fn unopened(path: &Path, error: &std::io::Error) -> PyErr {
    let text = format!("{}: cannot open it: {}", path.display(), bilux::pictures::reason(error));
    match error.kind() {
        ErrorKind::NotFound => PyFileNotFoundError::new_err(text),
        _ => PyOSError::new_err(text),
    }
}

/// A picture's error as its exception.
pub(crate) fn of_picture(error: PictureError) -> PyErr {
    exception(error)
}

/// A scene's error as its exception.
pub(crate) fn of_scene(error: SceneError) -> PyErr {
    exception(error)
}

/// Shows warnings as Python does: as lines on standard error, or as errors, as the user's filters say.
///
/// # Errors
/// If the user's filters turn warnings into errors.
pub(crate) fn warn(py: Python<'_>, warnings: &[Warning]) -> PyResult<()> {
    let category = py.import("bilux._errors")?.getattr("SceneWarning")?;
    for warning in warnings {
        let text = in_python(&warning.to_string()).replace('\0', " ");
        let text = CString::new(text).unwrap_or_default();
        PyErr::warn(py, &category, &text, 2)?;
    }
    Ok(())
}
