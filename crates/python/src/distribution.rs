//! Measured luminous intensity distributions, from arrays and from files of lamps.

use crate::arrays;
use crate::encoded::{Encoded, decoded as decoded_scene};
use crate::ending::without_gil;
use crate::errors::{exception, warn};
use crate::memory;
use crate::source::Source;
use crate::values::IntensityDistribution;
use bilux::formats::ReadOptions;
use bilux::scene::{
    Goniometer, IntensityDistribution as Distribution, SceneBuilder, Span, Spec, Value, Warning,
};
use numpy::PyUntypedArrayMethods;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::sync::Arc;

#[pymethods]
impl IntensityDistribution {
    #[new]
    #[pyo3(signature = (azimuths, polar_angles, candela, *, name = ""))]
    fn new(
        azimuths: Vec<f64>,
        polar_angles: Vec<f64>,
        candela: &Bound<'_, PyAny>,
        name: &str,
    ) -> PyResult<IntensityDistribution> {
        let array = arrays::numbers("candela", candela)?;
        if array.shape() != [azimuths.len(), polar_angles.len()] {
            return Err(PyValueError::new_err(format!(
                "candela: its shape is {}, but must be (azimuths, polar_angles): ({}, {})",
                arrays::shape_of(&array),
                azimuths.len(),
                polar_angles.len()
            )));
        }
        let candela = arrays::floats(&array)?;
        let made = Distribution::new(name, Goniometer::C, azimuths, polar_angles, candela);
        Ok(IntensityDistribution(Arc::new(made.map_err(PyValueError::new_err)?)))
    }

    /// Reads the distribution of a lamp from a file of IES LM-63 or EULUMDAT.
    ///
    /// Args:
    ///     file: a path, bytes, or a file open for reading bytes.
    ///
    /// Raises:
    ///     FormatError: If the file is in no such format, or broken.
    ///
    /// Example:
    ///     >>> lamp = bilux.IntensityDistribution.read("lamp.ies")  # doctest: +SKIP
    #[staticmethod]
    fn read(file: &Bound<'_, PyAny>) -> PyResult<IntensityDistribution> {
        let py = file.py();
        let options = ReadOptions::default();
        let max_memory = memory::within_limits(options.max_memory);
        let options = ReadOptions { max_memory, ..options };
        let source = Source::of("file", file, max_memory)?.opened(py, max_memory)?;
        let (bytes, shown) = (source.bytes(), source.name());
        let read = without_gil(py, || bilux::formats::read_distribution(bytes, &shown, &options));
        let (distribution, warnings) = read.map_err(exception)?;
        let at = || Span { file: shown.as_str().into(), line: 0, column: 0 };
        let warnings = warnings.into_iter().map(|message| Warning { message, at: at() });
        warn(py, &warnings.collect::<Vec<_>>())?;
        Ok(IntensityDistribution(Arc::new(distribution)))
    }

    /// The luminous flux in lumen: the integral of the intensity over all directions.
    #[getter]
    fn lumens(&self) -> f64 {
        self.0.lumens()
    }

    /// The intensity in candela at a polar angle and an azimuth, in degrees.
    ///
    /// Example:
    ///     >>> lamp = bilux.IntensityDistribution([0], [0, 90], [[100, 0]])
    ///     >>> lamp.at(45, 0)
    ///     50.0
    fn at(&self, polar_angle: f64, azimuth: f64) -> f64 {
        self.0.at(polar_angle, azimuth)
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        self.0.name()
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<IntensityDistribution>().is_ok_and(|other| Arc::ptr_eq(&self.0, &other.get().0))
    }

    fn __hash__(&self) -> usize {
        Arc::as_ptr(&self.0) as usize
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let (py, mut alone) = (slf.py(), SceneBuilder::default());
        alone.lights.push(Spec::new("", "luminaire").with("distribution", slf.get().0.clone()));
        let encoded = Encoded::of(py, &alone)?;
        let restore = slf.get_type().getattr("_restored")?;
        (restore, (encoded.document(py), encoded.blobs(py)?)).into_pyobject(py)
    }

    #[staticmethod]
    fn _restored(document: &Bound<'_, PyAny>, blobs: &Bound<'_, PyDict>) -> PyResult<IntensityDistribution> {
        let scene = decoded_scene(document, blobs)?;
        match scene.lights.first().and_then(|spec| spec.parameters.find("distribution")) {
            Some((Value::Distribution(distribution), _)) => Ok(IntensityDistribution(distribution.clone())),
            _ => Err(PyValueError::new_err("this is no pickle of an intensity distribution")),
        }
    }

    fn __repr__(&self) -> String {
        format!("<bilux.IntensityDistribution '{}', {:.0} lm>", self.0.name(), self.0.lumens())
    }
}
