//! Errors as Python exceptions. The classes are in `bilux/_errors.py`; the texts are those of the Rust errors.

use bilux::formats::FormatError;
use bilux::memory_limit::MemoryLimit;
use bilux::pictures::PictureError;
use bilux::scene::{SceneError, Warning};
use bilux::wording::in_python;
use pyo3::exceptions::{PyFileNotFoundError, PyOSError};
use pyo3::prelude::*;
use std::ffi::CString;
use std::io::{self, ErrorKind};

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
    match (unopened(error), error) {
        (Some(cause), _) if cause.kind() == ErrorKind::NotFound => return PyFileNotFoundError::new_err(text),
        (Some(_), bilux::Error::Picture(_)) => return PyOSError::new_err(text),
        _ => {}
    }
    match error {
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

/// Why a file cannot be opened, if that is what is wrong.
fn unopened(error: &bilux::Error) -> Option<&io::Error> {
    fn of_picture(error: &PictureError) -> Option<&io::Error> {
        match error {
            PictureError::InFile { source, .. } => of_picture(source),
            PictureError::Io { action: "open it", source } => Some(source),
            _ => None,
        }
    }
    match error {
        bilux::Error::Format(FormatError::Io { source, .. }) => Some(source),
        bilux::Error::Picture(error) => of_picture(error),
        _ => None,
    }
}

/// The keyword that allows what the library refused, unless the system does.
fn allowing(error: &bilux::Error) -> String {
    if let (Some(bytes), Some(limit)) = (error.memory_to_allow(), MemoryLimit::of_process())
        && bytes > limit.for_pictures()
    {
        return format!(" ({} is the limit)", limit.source);
    }
    match (error.memory_to_allow(), error) {
        (Some(bytes), _) if bytes.is_multiple_of(1 << 30) => format!(" (max_memory={} << 30)", bytes >> 30),
        (Some(bytes), _) => format!(" (max_memory={} << 20)", bytes.div_ceil(1 << 20)),
        (None, bilux::Error::Format(FormatError::Outside { .. })) => " (allow_outside=True)".to_owned(),
        _ => String::new(),
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
    warn_of_all(py, warnings.iter().map(ToString::to_string))
}

/// Shows oddities of the file of a picture as [`warn`] shows warnings.
///
/// # Errors
/// As [`warn`].
pub(crate) fn warn_of_picture(py: Python<'_>, name: &str, warnings: &[String]) -> PyResult<()> {
    warn_of_all(py, warnings.iter().map(|warning| format!("{name}: {warning}")))
}

fn warn_of_all(py: Python<'_>, all: impl Iterator<Item = String>) -> PyResult<()> {
    let category = py.import("bilux._errors")?.getattr("SceneWarning")?;
    for warning in all {
        let text = in_python(&warning).replace('\0', " ");
        let text = CString::new(text).unwrap_or_default();
        PyErr::warn(py, &category, &text, 2)?;
    }
    Ok(())
}
