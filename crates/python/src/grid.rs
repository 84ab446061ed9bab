//! Grids of numbers in space, from arrays, files and formulas.

use crate::arrays;
use crate::encoded::{Encoded, decoded as decoded_scene};
use crate::ending::without_gil;
use crate::errors::{exception, warn};
use crate::memory;
use crate::source::Source;
use crate::values::{Grid, Unresolved, parameters as parameters_of};
use bilux::formats::ReadOptions;
use bilux::math::{Transform, Vec3};
use bilux::scene::media::ComputedDensity;
use bilux::scene::{SceneBuilder, Span, Spec, Value, Warning};
use numpy::PyUntypedArrayMethods;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::sync::Arc;

#[pymethods]
impl Grid {
    #[new]
    #[pyo3(signature = (values, *, bounds = None, name = ""))]
    fn new(values: &Bound<'_, PyAny>, bounds: Option<([f32; 3], [f32; 3])>, name: &str) -> PyResult<Grid> {
        let array = arrays::numbers("values", values)?;
        let &[depth, height, width] = array.shape() else {
            let shape = arrays::shape_of(&array);
            let message = format!("values: its shape is {shape}, but must be (depth, height, width)");
            return Err(PyValueError::new_err(message));
        };
        let size = [width, height, depth];
        let place = place(bounds.unwrap_or_else(|| cubes(size)), size).ok_or_else(|| {
            PyValueError::new_err("bounds: the corners of a box are finite, and differ in x, y and z")
        })?;
        let grid = bilux::scene::media::Grid::dense(name, size, &place, &arrays::floats(&array)?);
        let grid = grid.map_err(|why| PyValueError::new_err(format!("values: {why}")))?;
        Ok(Grid(Arc::new(grid)))
    }

    /// Reads a grid from a file of OpenVDB, NanoVDB, numpy (.npy) or Mitsuba (.vol), in the place that the file says.
    ///
    /// Args:
    ///     file: a path, bytes, or a file open for reading bytes.
    ///     name: which of its grids; by default 'density', or else the first that can be one.
    ///
    /// Raises:
    ///     FormatError: If the file is in no such format or broken, or has no such grid.
    ///
    /// Example:
    ///     >>> smoke = bilux.materials.interface(scattering=20, density=bilux.Grid.read("smoke.vdb"))  # doctest: +SKIP
    #[staticmethod]
    #[pyo3(signature = (file, *, name = ""))]
    fn read(file: &Bound<'_, PyAny>, name: &str) -> PyResult<Grid> {
        let py = file.py();
        let options = ReadOptions::default();
        let max_memory = memory::within_limits(options.max_memory);
        let options = ReadOptions { max_memory, ..options };
        let source = Source::of("file", file, max_memory)?.opened(py, max_memory)?;
        let (bytes, shown) = (source.bytes(), source.name());
        let read = without_gil(py, || bilux::formats::read_grid(bytes, &shown, name, &options));
        let found = read.map_err(exception)?;
        let at = || Span { file: shown.as_str().into(), line: 0, column: 0 };
        let warnings = found.warnings.into_iter().map(|message| Warning { message, at: at() });
        warn(py, &warnings.collect::<Vec<_>>())?;
        let grid = found.grid.map_err(PyValueError::new_err)?;
        Ok(Grid(Arc::new(grid)))
    }

    /// A density that is a formula, evaluated at its voxels.
    ///
    /// Args:
    ///     kind: its name, such as 'cloud', 'noise' or 'height'; `bilux.densities()` lists them.
    ///     parameters: its parameters, as in scene files.
    ///
    /// Example:
    ///     >>> haze = bilux.Grid.computed("height", falloff=5, to=(20, 30, 20))
    ///     >>> fog = bilux.materials.interface(scattering=0.1, density=haze)
    #[staticmethod]
    #[pyo3(signature = (kind, /, **parameters))]
    fn computed(py: Python<'_>, kind: &str, parameters: Option<&Bound<'_, PyDict>>) -> PyResult<Grid> {
        let mut spec = Spec::new("", kind);
        if let Some(keywords) = parameters {
            spec.parameters = parameters_of(keywords, &mut Unresolved)?;
        }
        let density = ComputedDensity::new(spec).map_err(exception)?;
        let max_memory = memory::within_limits(ReadOptions::default().max_memory);
        if density.bytes() > max_memory {
            let [x, y, z] = density.size();
            let message =
                format!("{x} x {y} x {z} voxels need {} bytes, and there are {max_memory}", density.bytes());
            return Err(PyValueError::new_err(message));
        }
        let grid = without_gil(py, || density.grid()).map_err(exception)?;
        Ok(Grid(Arc::new(grid)))
    }

    /// Its voxels along z, y and x.
    #[getter]
    fn shape(&self) -> (usize, usize, usize) {
        let [width, height, depth] = self.0.size();
        (depth, height, width)
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        self.0.name()
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Grid>().is_ok_and(|other| Arc::ptr_eq(&self.0, &other.get().0))
    }

    fn __hash__(&self) -> usize {
        Arc::as_ptr(&self.0) as usize
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let (py, mut alone) = (slf.py(), SceneBuilder::default());
        alone.materials.push(Spec::new("", "interface").with("density", slf.get().0.clone()));
        let encoded = Encoded::of(py, &alone)?;
        let restore = slf.get_type().getattr("_restored")?;
        (restore, (encoded.document(py), encoded.blobs(py)?)).into_pyobject(py)
    }

    #[staticmethod]
    fn _restored(document: &Bound<'_, PyAny>, blobs: &Bound<'_, PyDict>) -> PyResult<Grid> {
        let scene = decoded_scene(document, blobs)?;
        match scene.materials.first().and_then(|spec| spec.parameters.find("density")) {
            Some((Value::Grid(grid), _)) => Ok(Grid(grid.clone())),
            _ => Err(PyValueError::new_err("this is no pickle of a grid")),
        }
    }

    fn __repr__(&self) -> String {
        let [x, y, z] = self.0.size();
        format!("<bilux.Grid '{}', {x} x {y} x {z} voxels>", self.0.name())
    }
}

/// From voxels to the box between two corners.
fn place((a, b): ([f32; 3], [f32; 3]), size: [usize; 3]) -> Option<Transform> {
    let (min, max) = (Vec3::from(a).min(b.into()), Vec3::from(a).max(b.into()));
    let voxel = (max - min) / Vec3::from(size.map(|n| n.max(1) as f32));
    Some(Transform::scale(voxel)?.then(&Transform::translate(min)?))
}

/// The box of voxels that are cubes: from the origin, its longest side 1.
fn cubes(size: [usize; 3]) -> ([f32; 3], [f32; 3]) {
    let longest = size.into_iter().max().unwrap_or(1).max(1) as f32;
    ([0.0; 3], size.map(|side| side.max(1) as f32 / longest))
}
