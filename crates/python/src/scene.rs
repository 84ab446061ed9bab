//! Scenes: read from files, generated, or built from arrays.

use crate::adding::{self, Adding, mesh, object, of_table};
use crate::arrays;
use crate::building::check_moment;
use crate::encoded::{Encoded, decoded};
use crate::ending::without_gil;
use crate::errors::{exception, warn};
use crate::loading::{Origin, glass_named, loaded, scheme_named};
use crate::memory::within_limits;
use crate::picture::Picture;
use crate::progressive::Progressive;
use crate::render::render;
use crate::request::Request;
use crate::source::Source;
use crate::surroundings::surround;
use crate::values::{self, Resolve, Spec, Unresolved};
use bilux::formats::ReadOptions;
use bilux::math::Transform;
use bilux::scene::{Object, Parameters, SceneBuilder};
use bilux::wording::in_python;
use bilux::{Built, Settings};
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use pyo3::types::{PyDict, PyString, PyType};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The native part of `bilux.Scene`.
#[pyclass(frozen, subclass, module = "bilux._bilux", name = "Scene")]
#[derive(Default)]
pub(crate) struct Scene {
    builder: Mutex<SceneBuilder>,
    /// Parts that renders have built. Locked only without the GIL, and while a render builds.
    pub(crate) built: Mutex<Built>,
    /// The file that it was read from; nothing knows it after pickling.
    origin: Mutex<Option<Origin>>,
}

#[pymethods]
impl Scene {
    #[new]
    fn new() -> Scene {
        Scene::default()
    }

    #[classmethod]
    #[pyo3(signature = (file, *, format, folder, time, animation, variant, subdivide, definitions, glass, light_radius, max_memory, allow_outside, strict))]
    #[expect(clippy::too_many_arguments, reason = "each is a keyword of bilux.load")]
    fn _load<'py>(
        class: &Bound<'py, PyType>,
        file: &Bound<'py, PyAny>,
        format: Option<String>,
        folder: Option<PathBuf>,
        time: f32,
        animation: Option<String>,
        variant: Option<String>,
        subdivide: Option<&str>,
        definitions: Vec<(String, String)>,
        glass: &str,
        light_radius: f32,
        max_memory: u64,
        allow_outside: bool,
        strict: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let max_memory = within_limits(max_memory);
        let options = ReadOptions {
            max_memory,
            allow_outside,
            working_folder: Some(PathBuf::new()),
            strict,
            time,
            animation,
            variant,
            subdivide: subdivide.map(scheme_named).transpose()?,
            definitions,
            glass: glass_named(glass)?,
            light_radius,
            ..ReadOptions::default()
        };
        crate::forks::check()?;
        let (py, source) = (class.py(), Source::of("file", file, max_memory)?);
        let origin = Origin { source, format, folder, options };
        let made = with_builder(class, loaded(py, &origin)?)?;
        let scene = made.cast::<Scene>()?.get();
        // Bytes are kept only where they are needed again.
        *scene.origin(py) = scene.builder(py).inventory.moves().then_some(origin);
        Ok(made)
    }

    #[classmethod]
    #[pyo3(signature = (kind, parameters))]
    fn _generate<'py>(
        class: &Bound<'py, PyType>,
        kind: &str,
        parameters: &Bound<'_, PyDict>,
    ) -> PyResult<Bound<'py, PyAny>> {
        crate::forks::check()?;
        let mut spec = bilux::scene::Spec::new("", kind);
        spec.parameters = values::parameters(parameters, &mut Unresolved)?;
        with_builder(class, without_gil(class.py(), || bilux::generate(&spec)).map_err(exception)?)
    }

    #[pyo3(signature = (vertices, triangles, normals, uvs, colors, material, transforms, name))]
    #[expect(clippy::too_many_arguments, reason = "each is a keyword of Scene.add_mesh")]
    fn _add(
        &self,
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        triangles: &Bound<'_, PyAny>,
        normals: Option<&Bound<'_, PyAny>>,
        uvs: Option<&Bound<'_, PyAny>>,
        colors: Option<&Bound<'_, PyAny>>,
        material: Option<&Bound<'_, Spec>>,
        transforms: Option<&Bound<'_, PyAny>>,
        name: &str,
    ) -> PyResult<(usize, usize)> {
        let mesh = mesh(vertices, triangles, [normals, uvs, colors], name)?;
        let several = transforms.is_some();
        let transforms = match transforms {
            Some(transforms) => arrays::transforms("transforms", transforms)?,
            None => vec![Transform::IDENTITY],
        };
        let mut builder = self.builder(py);
        let material = match material {
            Some(material) => Adding(&mut builder).material(material)?,
            None => {
                let plain = bilux::scene::Spec::new("", "diffuse");
                let known = builder.materials.iter().position(|known| *known == plain);
                known.unwrap_or_else(|| builder.add_material(plain))
            }
        };
        let mesh = Arc::new(mesh);
        let first = builder.objects.len();
        builder.objects.extend(transforms.iter().map(|&transform| {
            let object = Object::new(name, mesh.clone(), material).placed(transform);
            Object { instanced: several && transforms.len() > 1, ..object }
        }));
        Ok((first, transforms.len()))
    }

    /// The number of objects.
    fn __len__(&self, py: Python<'_>) -> usize {
        self.builder(py).objects.len()
    }

    /// The time of a render that is asked for one, or for none, of a scene that was read for this time.
    fn _moment(&self, py: Python<'_>, time: Option<f32>, loaded_at: f32) -> PyResult<f32> {
        let mut asked = Parameters::default();
        if let Some(time) = time {
            asked.set("time", time);
        }
        let builder = self.builder(py);
        let time = Settings::of(&builder, &asked).map_err(exception)?.time;
        check_moment(&builder, time, loaded_at).map_err(exception)
    }

    fn _object<'py>(
        &self,
        py: Python<'py>,
        index: usize,
        time: f32,
    ) -> PyResult<(String, Spec, Bound<'py, PyAny>, usize, usize)> {
        let builder = self.builder(py);
        let object = object(&builder, index)?;
        let material = Spec::of(py, "materials", &builder.materials[object.material], &builder)?;
        let matrix = object.motion.at(time).matrix().transpose().to_cols_array();
        let matrix = matrix.iter().copied().map(f64::from).collect();
        let matrix = PyArray1::from_vec(py, matrix).call_method1("reshape", ((4, 4),))?;
        let (vertices, triangles) = (object.mesh.positions.len(), object.mesh.triangles.len());
        let name = if object.name.is_empty() { &object.mesh.name } else { &object.name };
        Ok((name.clone(), material, matrix, vertices, triangles))
    }

    fn _set_transform(&self, py: Python<'_>, index: usize, transform: &Bound<'_, PyAny>) -> PyResult<()> {
        let transforms = arrays::transforms("transform", transform)?;
        let [transform] = transforms[..] else {
            return Err(PyValueError::new_err("transform: one object takes one matrix, an array (4, 4)"));
        };
        let mut builder = self.builder(py);
        object(&builder, index)?;
        builder.objects[index] = builder.objects[index].clone().placed(transform);
        Ok(())
    }

    fn _set_material(&self, py: Python<'_>, index: usize, material: &Bound<'_, Spec>) -> PyResult<()> {
        let mut builder = self.builder(py);
        object(&builder, index)?;
        let material = Adding(&mut builder).material(material)?;
        builder.objects[index].material = material;
        Ok(())
    }

    fn _remove(&self, py: Python<'_>, index: usize) -> PyResult<()> {
        let mut builder = self.builder(py);
        object(&builder, index)?;
        builder.objects.remove(index);
        Ok(())
    }

    fn _add_light(&self, py: Python<'_>, light: &Bound<'_, Spec>) -> PyResult<usize> {
        let mut builder = self.builder(py);
        let light = of_table(light, "lights")?.resolved(py, &mut Adding(&mut builder))?;
        builder.add_light(light);
        Ok(builder.lights.len() - 1)
    }

    fn _add_camera(&self, py: Python<'_>, camera: &Bound<'_, Spec>) -> PyResult<usize> {
        let mut builder = self.builder(py);
        let camera = of_table(camera, "cameras")?.camera(py, &mut Adding(&mut builder))?;
        builder.cameras.push(camera);
        Ok(builder.cameras.len() - 1)
    }

    /// The materials, in the order of the scene. Assign a list of as many to replace them.
    #[getter]
    fn materials(&self, py: Python<'_>) -> PyResult<Vec<Spec>> {
        let builder = self.builder(py);
        builder.materials.iter().map(|spec| Spec::of(py, "materials", spec, &builder)).collect()
    }

    #[setter]
    fn set_materials(&self, py: Python<'_>, materials: Vec<Bound<'_, Spec>>) -> PyResult<()> {
        let mut builder = self.builder(py);
        if materials.len() != builder.materials.len() {
            return Err(PyValueError::new_err(format!(
                "materials: there are {}, but the scene has {}: give one for each",
                materials.len(),
                builder.materials.len()
            )));
        }
        let resolved = adding::resolved(&materials, "materials", &mut builder);
        for (slot, spec) in builder.materials.iter_mut().zip(resolved?) {
            *slot = spec;
        }
        Ok(())
    }

    /// The lights. Assign a list to replace them.
    #[getter]
    fn lights(&self, py: Python<'_>) -> PyResult<Vec<Spec>> {
        let builder = self.builder(py);
        builder.lights.iter().map(|spec| Spec::of(py, "lights", spec, &builder)).collect()
    }

    #[setter]
    fn set_lights(&self, py: Python<'_>, lights: Vec<Bound<'_, Spec>>) -> PyResult<()> {
        let mut builder = self.builder(py);
        builder.lights = adding::resolved(&lights, "lights", &mut builder)?;
        Ok(())
    }

    /// The cameras; the first is the default. Assign a list to replace them.
    #[getter]
    fn cameras(&self, py: Python<'_>) -> PyResult<Vec<Spec>> {
        let builder = self.builder(py);
        builder.cameras.iter().map(|camera| Spec::of_camera(py, camera, &builder)).collect()
    }

    #[setter]
    fn set_cameras(&self, py: Python<'_>, cameras: Vec<Bound<'_, Spec>>) -> PyResult<()> {
        let mut builder = self.builder(py);
        let camera =
            |camera: &Bound<'_, Spec>| of_table(camera, "cameras")?.camera(py, &mut Adding(&mut builder));
        let cameras = cameras.iter().map(camera).collect::<PyResult<_>>()?;
        builder.cameras = cameras;
        Ok(())
    }

    /// The corners of the bounding box of all objects, without lights: a list of two triples, or None if there are none.
    #[getter]
    fn bounds(&self, py: Python<'_>) -> Option<[(f32, f32, f32); 2]> {
        let builder = self.builder(py);
        let bounds = builder.bounds(0.0);
        (!builder.objects.is_empty()).then(|| [bounds.min.into(), bounds.max.into()])
    }

    /// What was odd about the file.
    #[getter]
    fn warnings(&self, py: Python<'_>) -> Vec<String> {
        self.builder(py).warnings.iter().map(|warning| in_python(&warning.to_string())).collect()
    }

    /// What is worth knowing about the file though nothing is wrong with it.
    #[getter]
    fn notes(&self, py: Python<'_>) -> Vec<String> {
        self.builder(py).notes.iter().map(|note| in_python(&note.to_string())).collect()
    }

    /// Lights the scene with a picture in longitude and latitude, or a layer of one, in place of what it may have around it;
    /// also with "sky", daylight, or with "studio", the studio in place of all of its lights. "none" turns the studio's lights
    /// off for a glTF file with lights of its own.
    #[pyo3(signature = (path, layer = None))]
    fn surround(&self, py: Python<'_>, path: PathBuf, layer: Option<String>) -> PyResult<()> {
        let new = surround(&mut self.builder(py), &path, layer)?;
        warn(py, &new)
    }

    /// Writes the scene to a file; the extension says in which format. Returns what the format cannot hold.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<Vec<String>> {
        let scene = self.builder(py).clone();
        let lost = without_gil(py, || bilux::formats::write(&path, &scene, &Default::default()));
        Ok(lost.map_err(exception)?.iter().map(ToString::to_string).collect())
    }

    #[pyo3(signature = (settings, aov, crop, others, fast, max_memory, loaded_at, callback))]
    #[expect(clippy::too_many_arguments, reason = "each is a keyword of Scene.render")]
    fn _render(
        &self,
        py: Python<'_>,
        settings: &Bound<'_, PyDict>,
        aov: Vec<String>,
        crop: Option<[u32; 4]>,
        others: [Option<Bound<'_, Scene>>; 2],
        fast: bool,
        max_memory: u64,
        loaded_at: f32,
        callback: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Picture> {
        let request = Request::new(settings, &aov, fast, max_memory, loaded_at)?;
        // What others change from now on is not in this picture.
        let scene = self.builder(py).clone();
        let origin = self.origin(py).clone();
        let others = others.map(|other| Some(other?.get().builder(py).clone()));
        render(py, &scene, &self.built, Request { crop, origin, others, ..request }, callback)
    }

    fn _progressive(
        &self,
        py: Python<'_>,
        settings: &Bound<'_, PyDict>,
        max_memory: u64,
        callback: Option<Py<PyAny>>,
    ) -> PyResult<Progressive> {
        let user = values::keywords(settings)?;
        let scene = self.builder(py).clone();
        Progressive::new(py, &scene, &self.built, &user, max_memory, callback)
    }

    /// The scene as bytes.
    fn _encoded(&self, py: Python<'_>) -> PyResult<Encoded> {
        let scene = self.builder(py).clone();
        Encoded::of(py, &scene)
    }

    #[classmethod]
    fn _decoded<'py>(
        class: &Bound<'py, PyType>,
        document: &Bound<'_, PyAny>,
        blobs: &Bound<'_, PyDict>,
    ) -> PyResult<Bound<'py, PyAny>> {
        with_builder(class, decoded(document, blobs)?)
    }

    fn _copy_to(&self, py: Python<'_>, other: &Bound<'_, Scene>) {
        let copy = self.builder(py).clone();
        *other.get().builder(other.py()) = copy;
        *other.get().origin(py) = self.origin(py).clone();
        // Meshes are shared, and so are the trees over them.
        let (own, other) = (&self.built, &other.get().built);
        without_gil(py, || {
            let copy = own.lock().unwrap_or_else(PoisonError::into_inner).clone();
            *other.lock().unwrap_or_else(PoisonError::into_inner) = copy;
        });
    }

    fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
        let builder = slf.get().builder(slf.py());
        let name: Bound<'_, PyString> = slf.get_type().name()?;
        let triangles: usize = builder.objects.iter().map(|object| object.mesh.triangles.len()).sum();
        Ok(format!(
            "<bilux.{name} of {} objects, {triangles} triangles, {} materials, {} lights, {} cameras>",
            builder.objects.len(),
            builder.materials.len(),
            builder.lights.len(),
            builder.cameras.len()
        ))
    }
}

impl Scene {
    /// The scene under construction. Other threads run while this one waits for it.
    pub(crate) fn builder(&self, py: Python<'_>) -> MutexGuard<'_, SceneBuilder> {
        self.builder.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner)
    }

    /// The file that it was read from, if that is known and may be needed again.
    pub(crate) fn origin(&self, py: Python<'_>) -> MutexGuard<'_, Option<Origin>> {
        self.origin.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner)
    }
}

/// An instance of the class with this scene in it.
fn with_builder<'py>(class: &Bound<'py, PyType>, scene: SceneBuilder) -> PyResult<Bound<'py, PyAny>> {
    let instance = class.call0()?;
    *instance.cast::<Scene>()?.get().builder(class.py()) = scene;
    Ok(instance)
}
