//! Motion of objects, from arrays.

use crate::arrays;
use crate::scene::Scene;
use bilux::math::glam::DMat4;
use bilux::math::{Motion, MotionKey, Transform};
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;

/// Largest distance of a matrix from translation, rotation and scale, relative to its largest number.
const TOLERANCE: f64 = 1e-4;

/// Moves an object through the transforms at these times.
#[pyfunction]
pub(crate) fn set_keyframes(
    py: Python<'_>,
    scene: &Bound<'_, Scene>,
    object: usize,
    times: &Bound<'_, PyAny>,
    transforms: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let times: Vec<f32> = times.call_method0("tolist")?.extract()?;
    let transforms = arrays::transforms("transforms", transforms)?;
    if times.is_empty() {
        return Err(PyValueError::new_err("times: there is none: give at least one keyframe"));
    }
    if times.len() != transforms.len() {
        let (times, matrices) = (times.len(), transforms.len());
        let message = format!("transforms: there are {matrices} for {times} times: give one for each time");
        return Err(PyValueError::new_err(message));
    }
    let keys = times.iter().zip(&transforms).enumerate().map(|(i, (time, transform))| {
        key(*time, transform).ok_or_else(|| {
            PyValueError::new_err(format!(
                "transforms: matrix {i} shears: keyframes consist of a scale along the mesh's axes, then a rotation, \
                 then a translation"
            ))
        })
    });
    let motion = Motion::from_keys(keys.collect::<PyResult<_>>()?).ok_or_else(|| {
        PyValueError::new_err(
            "times: they must be finite and increase from one keyframe to the next, and no transform may mirror where \
             another does not",
        )
    })?;
    let mut builder = scene.get().builder(py);
    let missing = || PyIndexError::new_err(format!("there is no object {object}"));
    builder.objects.get_mut(object).ok_or_else(missing)?.motion = motion;
    Ok(())
}

/// A matrix as scale, rotation and translation; `None` if it is none of these.
fn key(time_seconds: f32, transform: &Transform) -> Option<MotionKey> {
    let matrix = transform.matrix().as_dmat4();
    let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
    let composed = DMat4::from_scale_rotation_translation(scale, rotation, translation);
    let largest = matrix.to_cols_array().into_iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    composed.abs_diff_eq(matrix, TOLERANCE * largest).then(|| MotionKey {
        time_seconds,
        translation: translation.as_vec3(),
        rotation: rotation.as_quat(),
        scale: scale.as_vec3(),
    })
}
