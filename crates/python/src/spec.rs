//! Materials, lights and cameras as users name them: a row of a table, and values of its parameters.

use crate::cameras::Measuring;
use crate::errors::of_scene;
use crate::values::{self, Spec, Unresolved};
use bilux::math::registry::Entry;
use bilux::scene::cameras::{self, CameraSpec};
use bilux::scene::{Reader, SceneError, Span};
use bilux::tables::{TABLES, values as values_of};
use bilux::wording::in_python;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};

/// The row of a table.
fn entry(table: &str, kind: &str) -> Result<Entry, SceneError> {
    let rows = TABLES.iter().find(|row| row.name == table).map_or_else(Vec::new, |table| (table.rows)());
    let names: Vec<&str> = rows.iter().map(|row| row.name).collect();
    let found = rows.iter().find(|row| row.name == kind).copied();
    let one = table.strip_suffix('s').unwrap_or(table);
    found.ok_or_else(|| SceneError::unknown(one, kind, names, &Span::default()))
}

#[pymethods]
impl Spec {
    /// Checks the names and values of all parameters.
    ///
    /// Raises:
    ///     SceneError: if there is no such row, or a parameter has a wrong name or a value out of range.
    ///     TypeError: if a value is of a type that no parameter has.
    #[new]
    #[pyo3(signature = (table, kind, parameters, name = "", keyframes = Vec::new()))]
    fn new(
        table: &str,
        kind: &str,
        parameters: &Bound<'_, PyDict>,
        name: &str,
        keyframes: Vec<(f32, Bound<'_, PyDict>)>,
    ) -> PyResult<Spec> {
        let entry = entry(table, kind).map_err(of_scene)?;
        check(&entry, name, parameters)?;
        if table != "cameras" && !keyframes.is_empty() {
            return Err(PyTypeError::new_err(format!(
                "keyframes: bilux.{table} do not move, only cameras do"
            )));
        }
        for (_, changes) in &keyframes {
            check(&entry, name, changes)?;
        }
        if table == "cameras" {
            check_camera(kind, name, parameters, &keyframes)?;
        }
        let copy = |(time, changes): &(f32, Bound<'_, PyDict>)| Ok((*time, changes.copy()?.unbind()));
        Ok(Spec {
            table: table.to_owned(),
            kind: kind.to_owned(),
            name: name.to_owned(),
            parameters: parameters.copy()?.unbind(),
            keyframes: keyframes.iter().map(copy).collect::<PyResult<_>>()?,
        })
    }

    /// The parameters that are given, by name; all others have their defaults.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.parameters.bind(py).copy()
    }

    /// Of a camera that moves: times in seconds, rising, each with the parameters that differ there. Between two of them
    /// parameters change evenly. Files have them.
    #[getter]
    fn keyframes<'py>(&self, py: Python<'py>) -> PyResult<Vec<(f32, Bound<'py, PyDict>)>> {
        self.keyframes.iter().map(|(time, changes)| Ok((*time, changes.bind(py).copy()?))).collect()
    }

    /// The same with other values of some parameters, which then no longer change between keyframes.
    ///
    /// Example:
    ///     >>> dark = bilux.materials.diffuse(reflectance=0.5).with_(reflectance=0.1)
    #[pyo3(signature = (**parameters))]
    fn with_(&self, py: Python<'_>, parameters: Option<&Bound<'_, PyDict>>) -> PyResult<Spec> {
        let (all, keyframes) = (self.parameters(py)?, self.keyframes(py)?);
        if let Some(changes) = parameters {
            all.update(changes.as_mapping())?;
            for (key, _) in changes {
                for (_, moving) in
                    keyframes.iter().filter(|(_, moving)| moving.contains(&key).unwrap_or(false))
                {
                    moving.del_item(&key)?;
                }
            }
        }
        Spec::new(&self.table, &self.kind, &all, &self.name, keyframes)
    }

    /// Of a camera: the pixels at which it sees points of the world.
    ///
    /// Pixels have their centres at whole numbers, as the indices of arrays and as in OpenCV.
    ///
    /// Args:
    ///     points: an array (n, 3), in metres.
    ///     size: width and height of the picture in pixels; by default that of the pictures which it was calibrated with.
    ///     time: of a camera that moves, the moment in seconds.
    ///
    /// Returns:
    ///     An array (n, 2) of float64, column and row of each; NaN where the camera does not see the point. Pixels beside the
    ///     picture are right too.
    ///
    /// Raises:
    ///     TypeError: if it is no camera.
    ///     ValueError: if nothing says the size, or the points have another shape.
    ///
    /// Example:
    ///     >>> camera = bilux.cameras.perspective(position=(0, 0, 4), look_at=(0, 0, 0))
    ///     >>> camera.project([[0, 0, 0]], size=(640, 480))
    ///     array([[319.5, 239.5]])
    #[pyo3(signature = (points, *, size = None, time = 0.0))]
    fn project<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
        size: Option<[u32; 2]>,
        time: f32,
    ) -> PyResult<Bound<'py, PyAny>> {
        Measuring::new(py, self, size, time)?.project(py, points)
    }

    /// Of a camera: the rays of pixels, through the middle of the lens.
    ///
    /// Args:
    ///     pixels: an array (n, 2), column and row of each; centres are at whole numbers.
    ///     size: width and height of the picture in pixels; by default that of the pictures which it was calibrated with.
    ///     time: of a camera that moves, the moment in seconds.
    ///
    /// Returns:
    ///     Origins and unit directions, two arrays (n, 3) of float64; NaN where the camera sees nothing.
    ///
    /// Raises:
    ///     TypeError: if it is no camera.
    ///     ValueError: if nothing says the size, or the pixels have another shape.
    ///
    /// Example:
    ///     >>> camera = bilux.cameras.perspective(position=(0, 0, 4), look_at=(0, 0, 0))
    ///     >>> origins, directions = camera.rays([[319.5, 239.5]], size=(640, 480))
    ///     >>> origins, directions
    ///     (array([[0., 0., 4.]]), array([[ 0.,  0., -1.]]))
    #[pyo3(signature = (pixels, *, size = None, time = 0.0))]
    fn rays<'py>(
        &self,
        py: Python<'py>,
        pixels: &Bound<'py, PyAny>,
        size: Option<[u32; 2]>,
        time: f32,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let [origins, directions] = Measuring::new(py, self, size, time)?.rays(py, pixels)?;
        Ok((origins, directions))
    }

    /// What is odd about the pictures of a calibrated camera.
    fn _oddities(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        Ok(Measuring::new(py, self, None, 0.0)?.oddities())
    }

    fn __eq__(&self, py: Python<'_>, other: &Bound<'_, PyAny>) -> PyResult<bool> {
        let Ok(other) = other.cast::<Spec>() else { return Ok(false) };
        let other = other.get();
        let same = (&self.table, &self.kind, &self.name) == (&other.table, &other.kind, &other.name);
        let (own, others) = (self.keyframes(py)?, other.keyframes(py)?);
        Ok(same
            && self.parameters.bind(py).eq(other.parameters.bind(py))?
            && PyList::new(py, own)?.eq(others)?)
    }

    fn __hash__(&self) -> u64 {
        use std::hash::{DefaultHasher, Hash, Hasher};
        let mut hasher = DefaultHasher::new();
        (&self.table, &self.kind, &self.name).hash(&mut hasher);
        hasher.finish()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let (py, spec) = (slf.py(), slf.get());
        let arguments = (&spec.table, &spec.kind, spec.parameters(py)?, &spec.name, spec.keyframes(py)?);
        (slf.get_type(), arguments).into_pyobject(py)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let mut words = Vec::new();
        if !self.name.is_empty() {
            words.push(format!("name='{}'", self.name));
        }
        for (key, value) in self.parameters.bind(py) {
            words.push(format!("{key}={}", value.repr()?));
        }
        if !self.keyframes.is_empty() {
            words.push(format!("keyframes={}", PyList::new(py, self.keyframes(py)?)?.repr()?));
        }
        Ok(format!("bilux.{}.{}({})", self.table, self.kind, words.join(", ")))
    }
}

/// Checks the names and values of parameters.
fn check(entry: &Entry, name: &str, parameters: &Bound<'_, PyDict>) -> PyResult<()> {
    let mut spec = bilux::scene::Spec::new(name, entry.name);
    spec.parameters = values::parameters(parameters, &mut Unresolved)?;
    Reader::new(&spec, entry).map(drop).map_err(of_scene)
}

/// Checks what only all parameters of a camera together say, such as that it does not look along its own up direction.
fn check_camera(
    kind: &str,
    name: &str,
    parameters: &Bound<'_, PyDict>,
    keyframes: &[(f32, Bound<'_, PyDict>)],
) -> PyResult<()> {
    let mut spec = bilux::scene::Spec::new(name, kind);
    spec.parameters = values::parameters(parameters, &mut Unresolved)?;
    let mut camera = CameraSpec::new(spec);
    for (time, changes) in keyframes {
        camera.keyframes.push((*time, values::parameters(changes, &mut Unresolved)?));
    }
    cameras::build(&camera, 1.0).map(drop).map_err(of_scene)
}

/// The rows of a table, as dictionaries with `name`, `summary`, `source` and `parameters`.
#[pyfunction]
pub(crate) fn rows<'py>(py: Python<'py>, table: &str) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let names = TABLES.iter().map(|table| table.name);
    let found = TABLES.iter().find(|row| row.name == table);
    let found =
        found.ok_or_else(|| of_scene(SceneError::unknown("table", table, names, &Span::default())))?;
    let of_row = |row: &Entry| {
        let dictionary = as_dictionary(py, row)?;
        (found.details)(row.name)
            .into_iter()
            .try_for_each(|(heading, words)| dictionary.set_item(heading, words))?;
        Ok(dictionary)
    };
    (found.rows)().iter().map(of_row).collect()
}

fn as_dictionary<'py>(py: Python<'py>, row: &Entry) -> PyResult<Bound<'py, PyDict>> {
    let dictionary = PyDict::new(py);
    dictionary.set_item("name", row.name)?;
    dictionary.set_item("summary", in_python(row.summary))?;
    dictionary.set_item("source", row.source)?;
    let parameters =
        row.parameters.iter().map(|p| (p.name, in_python(p.summary), values_of(p.kind), p.unit, p.default));
    dictionary.set_item("parameters", parameters.collect::<Vec<_>>())?;
    Ok(dictionary)
}
