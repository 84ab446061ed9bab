//! Rays from arrays, and hits as arrays.

use crate::arrays;
use bilux::accel::Ray;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Rays as arrays.
pub(crate) struct Rays {
    pub(crate) origins: Vec<[f32; 3]>,
    pub(crate) directions: Vec<[f32; 3]>,
    pub(crate) count: usize,
    pub(crate) range: [f32; 2],
}

impl Rays {
    pub(crate) fn new(
        origins: &Bound<'_, PyAny>,
        directions: &Bound<'_, PyAny>,
        names: [&str; 2],
        range: [f32; 2],
    ) -> PyResult<Rays> {
        let origins = arrays::rows::<3>(names[0], origins)?;
        let directions = arrays::rows::<3>(names[1], directions)?;
        let count = match (origins.len(), directions.len()) {
            (a, b) if a == b => a,
            (1, n) | (n, 1) => n,
            (a, b) => {
                return Err(PyValueError::new_err(format!(
                    "{}: there are {b} rows for {a} of {}: give as many, or one for all",
                    names[1], names[0]
                )));
            }
        };
        Ok(Rays { origins, directions, count, range })
    }

    pub(crate) fn ray(&self, i: usize) -> Ray {
        let of = |rows: &[[f32; 3]]| if rows.len() == 1 { rows[0] } else { rows[i] };
        let [t_min, t_max] = self.range;
        Ray { t_min, t_max, ..Ray::new(of(&self.origins), of(&self.directions)) }
    }

    /// The rays from `first` on, at most so many.
    pub(crate) fn batch(&self, first: usize, count: usize) -> Vec<Ray> {
        (first..first + count).map(|i| self.ray(i)).collect()
    }
}

/// The hits of some rays, one column for each property.
pub(crate) struct Columns {
    pub(crate) t: Vec<f32>,
    pub(crate) primitive: Vec<i64>,
    pub(crate) u: Vec<f32>,
    pub(crate) v: Vec<f32>,
    pub(crate) point: Vec<[f32; 3]>,
    pub(crate) normal: Vec<[f32; 3]>,
}

impl Columns {
    pub(crate) fn misses(count: usize) -> Columns {
        Columns {
            t: vec![f32::INFINITY; count],
            primitive: vec![-1; count],
            u: vec![0.0; count],
            v: vec![0.0; count],
            point: vec![[f32::NAN; 3]; count],
            normal: vec![[f32::NAN; 3]; count],
        }
    }
}

impl Columns {
    pub(crate) fn into_python(self, py: Python<'_>) -> PyResult<Vec<Bound<'_, PyAny>>> {
        let Columns { t, primitive, u, v, point, normal } = self;
        Ok(vec![
            PyArray1::from_vec(py, t).into_any(),
            PyArray1::from_vec(py, primitive).into_any(),
            PyArray1::from_vec(py, u).into_any(),
            PyArray1::from_vec(py, v).into_any(),
            rows(py, point)?,
            rows(py, normal)?,
        ])
    }
}

/// An array (n, 3).
pub(crate) fn rows(py: Python<'_>, rows: Vec<[f32; 3]>) -> PyResult<Bound<'_, PyAny>> {
    let count = rows.len();
    Ok(PyArray1::from_vec(py, rows.into_flattened()).reshape([count, 3])?.into_any())
}
