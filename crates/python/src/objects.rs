//! Objects of a scene: what they are called, who sees them, how they are posed, and those of other scenes.

use crate::adding::object;
use crate::arrays;
use crate::ending::without_gil;
use crate::errors::{exception, of_scene};
use crate::scene::Scene;
use bilux::formats::ReadOptions;
use bilux::math::{Motion, Vec3};
use bilux::scene::{Object, SceneError, Span, Visibility};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Copies of the arrays of an object's mesh: positions, triangles, normals, texture coordinates and colours.
#[pyfunction]
pub(crate) fn mesh_of<'py>(
    py: Python<'py>,
    scene: &Bound<'_, Scene>,
    index: usize,
) -> PyResult<[Option<Bound<'py, PyAny>>; 5]> {
    let mesh = object(&scene.get().builder(py), index)?.mesh.clone();
    let floats = |flat: Vec<f32>, width: usize| match flat.is_empty() {
        true => Ok(None),
        false => PyArray1::from_vec(py, flat).call_method1("reshape", ((-1, width as i64),)).map(Some),
    };
    let flat = |of: &[Vec3]| of.iter().flat_map(|v| v.to_array()).collect::<Vec<f32>>();
    let triangles: Vec<i64> = mesh.triangles.iter().flatten().map(|&i| i64::from(i)).collect();
    let triangles = PyArray1::from_vec(py, triangles).reshape([mesh.triangles.len(), 3])?.into_any();
    Ok([
        floats(flat(&mesh.positions), 3)?,
        Some(triangles),
        floats(flat(&mesh.normals), 3)?,
        floats(mesh.uvs.iter().flat_map(|uv| uv.to_array()).collect(), 2)?,
        floats(mesh.vertex_kd.iter().flat_map(|colour| colour.to_array()).collect(), 3)?,
    ])
}

/// An object's category, and the name of who sees it.
#[pyfunction]
pub(crate) fn labels_of(
    py: Python<'_>,
    scene: &Bound<'_, Scene>,
    index: usize,
) -> PyResult<(String, &'static str)> {
    let builder = scene.get().builder(py);
    let object = object(&builder, index)?;
    Ok((object.category.clone(), object.visibility.name()))
}

/// Calls an object something.
#[pyfunction]
pub(crate) fn set_name(py: Python<'_>, scene: &Bound<'_, Scene>, index: usize, name: String) -> PyResult<()> {
    let mut builder = scene.get().builder(py);
    object(&builder, index)?;
    builder.objects[index].name = name;
    Ok(())
}

/// Says what kind of thing an object is.
#[pyfunction]
pub(crate) fn set_category(
    py: Python<'_>,
    scene: &Bound<'_, Scene>,
    index: usize,
    category: String,
) -> PyResult<()> {
    let mut builder = scene.get().builder(py);
    object(&builder, index)?;
    builder.objects[index].category = category;
    Ok(())
}

/// Says who sees an object.
#[pyfunction]
pub(crate) fn set_visibility(
    py: Python<'_>,
    scene: &Bound<'_, Scene>,
    index: usize,
    visibility: &str,
) -> PyResult<()> {
    let names = Visibility::ALL.map(Visibility::name);
    let unknown = || of_scene(SceneError::unknown("visibility", visibility, names, &Span::default()));
    let visibility = Visibility::named(visibility).ok_or_else(unknown)?;
    let mut builder = scene.get().builder(py);
    object(&builder, index)?;
    builder.objects[index].visibility = visibility;
    Ok(())
}

/// Adds the objects of another scene; returns the number of the first, and how many they are.
#[pyfunction]
pub(crate) fn merge(
    scene: &Bound<'_, Scene>,
    other: &Bound<'_, Scene>,
    transform: Option<&Bound<'_, PyAny>>,
    lights: bool,
    cameras: bool,
) -> PyResult<(usize, usize)> {
    let py = scene.py();
    let place =
        match transform.map(|transform| arrays::transforms("transform", transform)).transpose()?.as_deref() {
            None => Motion::REST,
            Some([transform]) => Motion::still(*transform),
            Some(_) => return Err(PyValueError::new_err("transform: give one matrix, an array (4, 4)")),
        };
    // A copy, since the other may be the same one.
    let other = other.get().builder(py).clone();
    let mut builder = scene.get().builder(py);
    let first = builder.add_objects_of(&other, &place);
    if lights {
        builder.add_lights_of(&other);
    }
    if cameras {
        builder.cameras.extend(other.cameras.iter().cloned());
    }
    Ok((first, other.objects.len()))
}

/// Poses the objects of a scene as an animation of its file has them at a time in seconds.
#[pyfunction]
pub(crate) fn pose(
    py: Python<'_>,
    scene: &Bound<'_, Scene>,
    clip: Option<String>,
    time: f32,
) -> PyResult<()> {
    let scene = scene.get();
    let Some(mut origin) = scene.origin(py).clone() else {
        return Err(PyValueError::new_err(
            "clip: this scene has no animation: load a file with one, and pose the scene before you merge it into others",
        ));
    };
    let animation = clip.or_else(|| origin.options.animation.clone());
    origin.options = ReadOptions { time, animation, ..origin.options };
    let posed = without_gil(py, || origin.read()).map_err(exception)?;
    let mut builder = scene.builder(py);
    let is_same = |(now, posed): (&Object, &Object)| now.mesh.triangles.len() == posed.mesh.triangles.len();
    let count = posed.objects.len();
    if count > builder.objects.len() || !builder.objects.iter().zip(&posed.objects).all(is_same) {
        return Err(PyValueError::new_err(
            "clip: the objects of the file are no longer the first ones of the scene: pose it before you remove or add objects",
        ));
    }
    for (object, posed) in builder.objects.iter_mut().zip(posed.objects) {
        (object.mesh, object.motion) = (posed.mesh, posed.motion);
    }
    builder.inventory = posed.inventory;
    drop(builder);
    *scene.origin(py) = Some(origin);
    Ok(())
}
