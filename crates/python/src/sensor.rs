//! Pictures of photons.

use crate::ending::without_gil;
use crate::errors::exception;
use crate::values::{self, Unresolved};
use bilux::Display;
use bilux::math::transcendental::log2;
use bilux::pictures::Picture;
use bilux::scene::Parameters;
use bilux::sensing::Sensing;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A sensor's picture of light, its display options, if they are not those of the light, and its info; see `Picture.sensor`.
pub(crate) fn sensed(
    py: Python<'_>,
    light: &Picture,
    parameters: Option<&Bound<'_, PyDict>>,
) -> PyResult<(Picture, Option<Display>, Py<PyDict>)> {
    crate::forks::check()?;
    let mut given = match parameters {
        Some(parameters) => values::parameters(parameters, &mut Unresolved)?,
        None => Parameters::default(),
    };
    for (key, _, at) in &mut given.0 {
        at.file = key.as_str().into();
    }
    let sensing = Sensing::new(&given).map_err(exception)?;
    let sensed = without_gil(py, || sensing.sensed(light)).map_err(exception)?;
    let sensor = &sensing.sensor;
    let info = PyDict::new(py);
    info.set_item("gain", sensor.system_gain())?;
    info.set_item("iso", sensor.iso_speed())?;
    info.set_item("saturating_luminance", sensor.saturating_luminance())?;
    info.set_item("saturated", sensed.saturated)?;
    // Notebooks show the largest number as white.
    let exposure = -log2(sensor.largest_number() as f32);
    let shown = sensing.is_raw.then(|| Display { exposure, ..Display::default() });
    Ok((sensed.picture, shown, info.unbind()))
}
