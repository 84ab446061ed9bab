//! Projections of points by cameras, and the rays of pixels, as arrays.

use crate::arrays::{self, numbers, shape_of};
use crate::errors::of_scene;
use crate::hits::rows;
use crate::values::{Spec, Unresolved};
use bilux::math::{DVec2, DVec3};
use bilux::scene::Camera;
use bilux::scene::cameras::build;
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use std::sync::Arc;

/// A camera as it is in pictures of one size.
pub(crate) struct Measuring {
    camera: Arc<dyn Camera>,
    size: DVec2,
    /// The moment in seconds.
    time: f32,
}

impl Measuring {
    /// The camera at a moment in pictures of this size; by default that of the pictures which it was calibrated with.
    ///
    /// # Errors
    /// `TypeError` if it is no camera; `ValueError` if nothing says the size, or a parameter is wrong.
    pub(crate) fn new(py: Python<'_>, spec: &Spec, size: Option<[u32; 2]>, time: f32) -> PyResult<Measuring> {
        if spec.table != "cameras" {
            return Err(PyTypeError::new_err(format!(
                "only cameras see points and have rays: this is one of bilux.{}",
                spec.table
            )));
        }
        let camera = spec.camera(py, &mut Unresolved)?;
        let Some([width, height]) = size.or_else(|| camera.calibrated_size()) else {
            let message =
                "size: give the width and height of the pictures in pixels, such as size=(640, 480)";
            return Err(PyValueError::new_err(message));
        };
        if width == 0 || height == 0 {
            return Err(PyValueError::new_err(format!("size: a picture of {width}x{height} has no pixels")));
        }
        let camera = build(&camera, width as f32 / height as f32).map_err(of_scene)?;
        Ok(Measuring { camera, size: DVec2::new(f64::from(width), f64::from(height)), time })
    }

    /// Oddities of the camera's pictures.
    pub(crate) fn oddities(&self) -> Vec<String> {
        self.camera.warnings()
    }

    /// The pixel of each point, an array (n, 2); NaN where no ray sees it.
    pub(crate) fn project<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let points = arrays::points("points", points)?;
        let points = points.rows();
        let pixel = |i: usize| {
            let seen = self.camera.project_f64(DVec3::from(points.row(i)), self.time);
            seen.map_or([f64::NAN; 2], |film| (film * self.size - 0.5).to_array())
        };
        let pixels: Vec<[f64; 2]> = (0..points.len()).map(pixel).collect();
        let count = pixels.len();
        Ok(PyArray1::from_vec(py, pixels.into_flattened()).reshape([count, 2])?.into_any())
    }

    /// Origins and unit directions of the rays of pixels, two arrays (n, 3); NaN where the camera sees nothing.
    pub(crate) fn rays<'py>(
        &self,
        py: Python<'py>,
        pixels: &Bound<'py, PyAny>,
    ) -> PyResult<[Bound<'py, PyAny>; 2]> {
        let array = numbers("pixels", pixels)?;
        if array.ndim() != 2 || array.shape()[1] != 2 {
            let shape = shape_of(&array);
            return Err(PyValueError::new_err(format!(
                "pixels: its shape is {shape}, but must be (n, 2), the column and the row of each"
            )));
        }
        let array = array.call_method1("astype", ("float64", "C", "unsafe", false, false))?;
        let array = array.extract::<PyReadonlyArrayDyn<'_, f64>>()?;
        let view = array.as_array();
        let pixels = view.as_slice().unwrap_or_default().as_chunks::<2>().0;
        let ray = |pixel: &[f64; 2]| {
            let ray = self.camera.ray_f64((DVec2::from(*pixel) + 0.5) / self.size, self.time);
            ray.map_or([[f64::NAN; 3]; 2], |ends| ends.map(|v| v.to_array()))
        };
        let (origins, directions) = pixels.iter().map(ray).map(|[o, d]| (o, d)).unzip();
        Ok([rows(py, origins)?, rows(py, directions)?])
    }
}
