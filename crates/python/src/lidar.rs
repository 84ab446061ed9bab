//! Laser scans of scenes.

use crate::arrays;
use crate::ending::without_gil;
use crate::errors::exception;
use crate::scene::Scene;
use crate::values::{self, Unresolved};
use bilux::lidar::{scanned, scanner};
use bilux::transport::lidar::{Pulse, Return};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::PoisonError;

/// Columns of returns: pulse, number, count, range, intensity, object.
type Columns<'py> = (
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<i64>>,
);

/// What a laser scanner measures, by pulse; see `Scene.lidar`. There are as many directions as origins, and as many times.
#[pyfunction]
pub(crate) fn scan<'py>(
    py: Python<'py>,
    scene: &Bound<'py, Scene>,
    origins: &Bound<'py, PyAny>,
    directions: &Bound<'py, PyAny>,
    times: PyReadonlyArray1<'py, f64>,
    parameters: &Bound<'py, PyDict>,
) -> PyResult<Columns<'py>> {
    crate::forks::check()?;
    let mut given = values::parameters(parameters, &mut Unresolved)?;
    for (key, _, at) in &mut given.0 {
        at.file = key.as_str().into();
    }
    let scanner = scanner(&given).map_err(exception)?;
    let origins = arrays::vectors("pose", origins)?;
    let directions = arrays::vectors("directions", directions)?;
    let times = times.as_slice()?;
    if let Some(row) = times.iter().position(|time| !(*time as f32).is_finite()) {
        return Err(PyValueError::new_err(format!("times: row {row} is {}, which is no time", times[row])));
    }
    let mut pulses = Vec::with_capacity(directions.len());
    for (row, ((&origin, direction), &time)) in origins.iter().zip(&directions).zip(times).enumerate() {
        let direction = direction.try_normalize().ok_or_else(|| {
            PyValueError::new_err(format!("directions: row {row} has no length: give a direction"))
        })?;
        pulses.push(Pulse { origin, direction, time: time as f32 });
    }
    let builder = scene.get().builder(py).clone();
    let built = &scene.get().built;
    let found = without_gil(py, || {
        let mut built = built.lock().unwrap_or_else(PoisonError::into_inner);
        scanned(&builder, &pulses, &scanner, &mut built)
    });
    let found = found.map_err(exception)?;
    let integers = |of: &dyn Fn(&Return) -> i64| PyArray1::from_iter(py, found.iter().map(of));
    let floats = |of: &dyn Fn(&Return) -> f64| PyArray1::from_iter(py, found.iter().map(of));
    Ok((
        integers(&|one| one.pulse as i64),
        integers(&|one| i64::from(one.number)),
        integers(&|one| i64::from(one.count)),
        floats(&|one| one.range),
        floats(&|one| one.intensity),
        integers(&|one| i64::from(one.object)),
    ))
}
