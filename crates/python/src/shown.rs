//! Display options of pictures, as calls state them.

use crate::errors::of_picture;
use bilux::Display;
use bilux::pictures::tone_map;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

/// Display options of a picture, with what a call says.
///
/// # Errors
/// If there is no such tone curve, or the exposure is none.
pub(crate) fn with(
    shown: Display,
    exposure: Option<&Bound<'_, PyAny>>,
    curve: Option<&str>,
) -> PyResult<Display> {
    let mut shown = shown;
    if let Some(name) = curve {
        shown.tone_map = tone_map(name).map_err(of_picture)?;
    }
    if let Some(exposure) = exposure {
        let is_auto = exposure.extract::<String>().is_ok_and(|text| text == "auto");
        shown.auto_exposure = is_auto;
        shown.exposure = if is_auto { 0.0 } else { stops(exposure)? };
    }
    Ok(shown)
}

fn stops(exposure: &Bound<'_, PyAny>) -> PyResult<f32> {
    let wrong = |_| PyTypeError::new_err("exposure: this is a number of stops (powers of two), or 'auto'");
    match exposure.extract::<f32>().map_err(wrong)? {
        stops if stops.abs() <= 64.0 => Ok(stops),
        stops => Err(PyValueError::new_err(format!("exposure: {stops} is not from -64 to 64 stops"))),
    }
}
