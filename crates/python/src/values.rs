//! Python's values as parameters of a scene, and back. A material may be a value, and has values itself; a grid
//! may be one, and may be computed from some.

use crate::texture::Texture;
use bilux::scene::cameras::CameraSpec;
use bilux::scene::{Parameters, SceneBuilder, Value};
use numpy::{PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString};
use std::sync::Arc;

/// A material, a light or a camera: the name of a row of a table, and parameters.
///
/// Make one with `bilux.materials`, `bilux.lights` or `bilux.cameras`. It never changes; `with_` makes another one.
///
/// Example:
///     >>> red = bilux.materials.diffuse(reflectance=(0.8, 0.1, 0.1))
///     >>> red.kind, red.parameters["reflectance"]
///     ('diffuse', (0.8, 0.1, 0.1))
#[pyclass(frozen, module = "bilux")]
pub(crate) struct Spec {
    /// Its table: "materials", "lights" or "cameras".
    #[pyo3(get)]
    pub(crate) table: String,
    /// The name of its row, such as "dielectric".
    #[pyo3(get)]
    pub(crate) kind: String,
    /// The name in the scene; may be empty.
    #[pyo3(get)]
    pub(crate) name: String,
    pub(crate) parameters: Py<PyDict>,
    /// Of a camera that moves: times in seconds, rising, each with the parameters that differ.
    pub(crate) keyframes: Vec<(f32, Py<PyDict>)>,
}

/// Numbers in space, such as the density of smoke, for any parameter of a material that takes a grid.
///
/// Args:
///     values: an array (depth, height, width), none of them negative: values[z, y, x]. They are kept as 16-bit floats.
///     bounds: two opposite corners, (x, y, z) each, of the box in the object that the voxels fill, in metres. If it is not given,
///         voxels are cubes, begin at the origin, and the longest side is 1.
///     name: a name for messages and written files.
///
/// Example:
///     >>> z, y, x = np.mgrid[-1:1:32j, -1:1:32j, -1:1:32j]
///     >>> ball = bilux.Grid(np.maximum(0, 1 - (x**2 + y**2 + z**2)), bounds=((-1, -1, -1), (1, 1, 1)))
///     >>> smoke = bilux.materials.interface(scattering=4, density=ball)
#[pyclass(frozen, module = "bilux")]
pub(crate) struct Grid(pub(crate) Arc<bilux::scene::media::Grid>);

/// A measured luminous intensity distribution, for the light `luminaire`.
///
/// Args:
///     azimuths: angles C of the measured half planes in degrees, ascending, such as 0 to 360; one stands for all.
///     polar_angles: angles γ in degrees from the lamp's axis, which points downwards unless it is turned; ascending within 0 to 180.
///     candela: an array (azimuths, polar_angles), none of them negative. Between these angles the intensity is bilinear, and
///         outside of them it is 0.
///     name: a name for messages and written files.
///
/// Example:
///     >>> cosine = np.cos(np.radians(np.linspace(0, 90, 91))).clip(0)
///     >>> lamp = bilux.IntensityDistribution([0], np.linspace(0, 90, 91), [1000 * cosine])
///     >>> round(lamp.lumens)
///     3142
///     >>> light = bilux.lights.luminaire(distribution=lamp, position=(0, 2.5, 0))
#[pyclass(frozen, module = "bilux")]
pub(crate) struct IntensityDistribution(pub(crate) Arc<bilux::scene::IntensityDistribution>);

/// Resolver of the textures and materials that values name.
pub(crate) trait Resolve {
    /// The index of a texture.
    fn texture(&mut self, texture: &Texture) -> usize;
    /// The index of a material.
    fn material(&mut self, material: &Bound<'_, Spec>) -> PyResult<usize>;
}

/// Resolves everything to index 0, for checking kinds of values.
pub(crate) struct Unresolved;

impl Resolve for Unresolved {
    fn texture(&mut self, _: &Texture) -> usize {
        0
    }
    fn material(&mut self, _: &Bound<'_, Spec>) -> PyResult<usize> {
        Ok(0)
    }
}

impl Spec {
    /// The spec of a scene.
    pub(crate) fn of(
        py: Python<'_>,
        table: &str,
        spec: &bilux::scene::Spec,
        scene: &SceneBuilder,
    ) -> PyResult<Spec> {
        Ok(Spec {
            table: table.to_owned(),
            kind: spec.kind.clone(),
            name: spec.name.clone(),
            parameters: dictionary(py, &spec.parameters, scene)?.unbind(),
            keyframes: Vec::new(),
        })
    }

    /// The camera of a scene.
    pub(crate) fn of_camera(py: Python<'_>, camera: &CameraSpec, scene: &SceneBuilder) -> PyResult<Spec> {
        let key = |(time, changes): &(f32, Parameters)| Ok((*time, dictionary(py, changes, scene)?.unbind()));
        let keyframes: PyResult<Vec<_>> = camera.keyframes.iter().map(key).collect();
        Ok(Spec { keyframes: keyframes?, ..Spec::of(py, "cameras", &camera.spec, scene)? })
    }

    /// The spec for a scene, with textures and materials as indices.
    pub(crate) fn resolved(&self, py: Python<'_>, resolve: &mut dyn Resolve) -> PyResult<bilux::scene::Spec> {
        let mut spec = bilux::scene::Spec::new(&self.name, &self.kind);
        spec.parameters = parameters(self.parameters.bind(py), resolve)?;
        Ok(spec)
    }

    /// The camera for a scene, with its keyframes.
    pub(crate) fn camera(&self, py: Python<'_>, resolve: &mut dyn Resolve) -> PyResult<CameraSpec> {
        let mut camera = CameraSpec::new(self.resolved(py, resolve)?);
        for (time, changes) in &self.keyframes {
            camera.keyframes.push((*time, parameters(changes.bind(py), resolve)?));
        }
        Ok(camera)
    }
}

/// Keyword arguments as parameters; those that are `None` are left out.
pub(crate) fn parameters(keywords: &Bound<'_, PyDict>, resolve: &mut dyn Resolve) -> PyResult<Parameters> {
    let mut parameters = Parameters::default();
    for (key, argument) in keywords {
        let key: String = key.extract()?;
        if !argument.is_none() {
            parameters.set(&key, value(&key, &argument, resolve)?);
        }
    }
    Ok(parameters)
}

/// Keyword arguments as settings of a render. Each is its own place, which messages name.
pub(crate) fn keywords(settings: &Bound<'_, PyDict>) -> PyResult<Parameters> {
    let mut parameters = parameters(settings, &mut Unresolved)?;
    for (key, _, at) in &mut parameters.0 {
        at.file = key.as_str().into();
    }
    crate::memory::set_threads(&mut parameters);
    Ok(parameters)
}

/// An argument as a value.
pub(crate) fn value(name: &str, argument: &Bound<'_, PyAny>, resolve: &mut dyn Resolve) -> PyResult<Value> {
    if let Ok(texture) = argument.cast::<Texture>() {
        return Ok(Value::Texture(resolve.texture(texture.get())));
    }
    if let Ok(grid) = argument.cast::<Grid>() {
        return Ok(Value::Grid(grid.get().0.clone()));
    }
    if let Ok(distribution) = argument.cast::<IntensityDistribution>() {
        return Ok(Value::Distribution(distribution.get().0.clone()));
    }
    if let Ok(material) = argument.cast::<Spec>() {
        return Ok(Value::Material(resolve.material(material)?));
    }
    if argument.is_instance_of::<PyBool>() {
        return Ok(Value::Bool(argument.extract()?));
    }
    if argument.is_instance_of::<PyInt>() {
        let wrong = |_| PyValueError::new_err(format!("{name}: {argument} is too large a number"));
        return Ok(Value::Integer(argument.extract().map_err(wrong)?));
    }
    if argument.is_instance_of::<PyFloat>() {
        return Ok(Value::Number(argument.extract()?));
    }
    if argument.is_instance_of::<PyString>() {
        return Ok(Value::Text(argument.extract()?));
    }
    if let Ok(path) = argument.call_method0("__fspath__") {
        return Ok(Value::Text(path.extract()?));
    }
    // Arrays and numpy's own numbers.
    let is_array = argument.cast::<PyUntypedArray>().is_ok_and(|array| array.ndim() > 0);
    if !is_array && argument.hasattr("item")? {
        return value(name, &argument.call_method0("item")?, resolve);
    }
    if is_array || argument.hasattr("__len__")? && !argument.is_instance_of::<PyDict>() {
        let items: PyResult<Vec<Value>> =
            argument.try_iter()?.map(|item| value(name, &item?, resolve)).collect();
        return Ok(Value::List(items?));
    }
    Err(PyTypeError::new_err(format!(
        "{name}: a {} is no value of a parameter: give a number, a text, True or False, a sequence of numbers, a \
         Texture or a material",
        argument.get_type().name()?
    )))
}

/// A scene's parameters as a dictionary.
pub(crate) fn dictionary<'py>(
    py: Python<'py>,
    parameters: &Parameters,
    scene: &SceneBuilder,
) -> PyResult<Bound<'py, PyDict>> {
    let dictionary = PyDict::new(py);
    for (key, value, _) in &parameters.0 {
        dictionary.set_item(key, object(py, value, scene)?)?;
    }
    Ok(dictionary)
}

fn object<'py>(py: Python<'py>, value: &Value, scene: &SceneBuilder) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::Bool(yes) => PyBool::new(py, *yes).to_owned().into_any(),
        Value::Integer(i) => i.into_pyobject(py)?.into_any(),
        Value::Number(x) => x.into_pyobject(py)?.into_any(),
        Value::Text(text) => PyString::new(py, text).into_any(),
        Value::List(list) => {
            let items: PyResult<Vec<_>> = list.iter().map(|value| object(py, value, scene)).collect();
            PyList::new(py, items?)?.into_any()
        }
        Value::Texture(index) => match scene.textures.get(*index) {
            Some(texture) => Bound::new(py, Texture::of(texture.clone()))?.into_any(),
            None => py.None().into_bound(py),
        },
        Value::Grid(grid) => Bound::new(py, Grid(grid.clone()))?.into_any(),
        Value::Distribution(distribution) => {
            Bound::new(py, IntensityDistribution(distribution.clone()))?.into_any()
        }
        Value::Material(index) => match scene.materials.get(*index) {
            Some(spec) => Bound::new(py, Spec::of(py, "materials", spec, scene)?)?.into_any(),
            None => py.None().into_bound(py),
        },
    })
}
