//! The light that points receive, and how much of it comes from each patch of the sky, as arrays.

use crate::arrays;
use crate::building::build;
use crate::errors::exception;
use crate::output::Output;
use crate::render::interrupted;
use crate::scene::Scene;
use crate::values;
use crate::watch::{Stopped, Watch, follow};
use bilux::Job;
use bilux::scene::Spec;
use bilux::scene::cameras::{CameraSpec, SensorPoint, SensorPoints};
use bilux::transport::{Estimate, PartOfSky, SkyPatches};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Irradiance and standard error of each point, arrays (n, 4): red, green, blue and luminance; and the samples that each got.
type Measured<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>, u32);

/// Measures what points receive.
#[pyfunction]
pub(crate) fn irradiance<'py>(
    py: Python<'py>,
    scene: &Bound<'py, Scene>,
    points: &Bound<'py, PyAny>,
    normals: &Bound<'py, PyAny>,
    settings: &Bound<'py, PyDict>,
    max_memory: u64,
    callback: Option<&Bound<'py, PyAny>>,
) -> PyResult<Measured<'py>> {
    let sensors = sensors(points, normals)?;
    let found = measured(py, scene, (settings, max_memory, callback), None, |job, watch| {
        job.received(&sensors, watch)
    })?;
    let array = |of: &dyn Fn(&Estimate) -> f64| {
        let flat: Vec<f64> = found.points.iter().flatten().map(of).collect();
        Ok::<_, PyErr>(PyArray1::from_vec(py, flat).reshape([found.points.len(), 4])?.into_any())
    };
    let error = |estimate: &Estimate| match estimate.half_width.is_finite() {
        true => estimate.half_width / found.quantile,
        false => f64::INFINITY,
    };
    Ok((array(&|estimate| estimate.mean)?, array(&error)?, found.samples))
}

/// The coefficients of points and their standard errors, arrays (n, patches) in sr, for rows of patches: sine of the elevation at
/// which each begins, and number of patches. First those of all light, then those of what does not come straight.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "each is an argument of bilux.daylight")]
pub(crate) fn daylight_coefficients<'py>(
    py: Python<'py>,
    scene: &Bound<'py, Scene>,
    points: &Bound<'py, PyAny>,
    normals: &Bound<'py, PyAny>,
    rows: Vec<(f32, usize)>,
    settings: &Bound<'py, PyDict>,
    max_memory: u64,
    callback: Option<&Bound<'py, PyAny>>,
) -> PyResult<[[Bound<'py, PyAny>; 2]; 2]> {
    let (sensors, patches) = (sensors(points, normals)?, SkyPatches::new(rows));
    let work = |job: &Job, watch: &Watch| job.daylight_coefficients(&sensors, &patches, watch);
    let table = measured(py, scene, (settings, max_memory, callback), Some(even_sky()), work)?;
    let array = |parts: &[PartOfSky], of: fn(&PartOfSky) -> f32| {
        let flat = PyArray1::from_iter(py, parts.iter().map(of));
        Ok::<_, PyErr>(flat.reshape([sensors.points().len(), patches.count()])?.into_any())
    };
    let both = |parts: &[PartOfSky]| {
        Ok::<_, PyErr>([array(parts, |part| part.mean)?, array(parts, |part| part.error)?])
    };
    Ok([both(&table.all)?, both(&table.reflected)?])
}

/// The light that points receive straight from a sun in each direction, over what a surface that faces it receives in front of
/// everything: an array (n, directions).
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "each is an argument of bilux.daylight")]
pub(crate) fn sunlight<'py>(
    py: Python<'py>,
    scene: &Bound<'py, Scene>,
    points: &Bound<'py, PyAny>,
    normals: &Bound<'py, PyAny>,
    directions: &Bound<'py, PyAny>,
    settings: &Bound<'py, PyDict>,
    max_memory: u64,
    callback: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let (sensors, directions) = (sensors(points, normals)?, arrays::vectors("directions", directions)?);
    let work = |job: &Job, watch: &Watch| job.sunlight(&sensors, &directions, watch);
    let table = measured(py, scene, (settings, max_memory, callback), Some(even_sky()), work)?;
    Ok(PyArray1::from_vec(py, table).reshape([sensors.points().len(), directions.len()])?.into_any())
}

/// A light that shines from everywhere.
fn even_sky() -> Spec {
    Spec::new("sky", "environment").with("radiance", 1.0f32)
}

/// The number of the patch in each direction.
#[pyfunction]
pub(crate) fn patch_numbers<'py>(
    py: Python<'py>,
    rows: Vec<(f32, usize)>,
    directions: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let patches = SkyPatches::new(rows);
    let directions = arrays::vectors("directions", directions)?;
    let mut numbers = Output::column(py, directions.len())?;
    for (number, direction) in numbers.numbers().iter_mut().zip(&directions) {
        *number = patches.number(*direction) as i64;
    }
    Ok(numbers.into_python())
}

fn sensors(points: &Bound<'_, PyAny>, normals: &Bound<'_, PyAny>) -> PyResult<SensorPoints> {
    let (points, normals) = (arrays::vectors("points", points)?, arrays::vectors("normals", normals)?);
    if points.is_empty() {
        return Err(PyValueError::new_err("points: there are none to measure at"));
    }
    if normals.len() != points.len() {
        return Err(PyValueError::new_err(format!(
            "normals: there are {} rows for {} points: give one for each point, or one for all",
            normals.len(),
            points.len()
        )));
    }
    let sensor = |(i, (p, normal)): (usize, (bilux::math::Vec3, bilux::math::Vec3))| {
        let normal = normal.try_normalize().ok_or_else(|| {
            PyValueError::new_err(format!("normals: row {i} has no direction: a normal must not be zero"))
        })?;
        Ok(SensorPoint { p, normal })
    };
    let sensors: PyResult<Vec<SensorPoint>> =
        points.into_iter().zip(normals).enumerate().map(sensor).collect();
    Ok(SensorPoints::new(sensors?))
}

/// Builds the scene, with this light in place of its own if there is one, and does the work, without the GIL.
fn measured<T: Send>(
    py: Python<'_>,
    scene: &Bound<'_, Scene>,
    (settings, max_memory, callback): (&Bound<'_, PyDict>, u64, Option<&Bound<'_, PyAny>>),
    only: Option<Spec>,
    work: impl Fn(&Job, &Watch) -> Result<Option<T>, bilux::Error> + Sync,
) -> PyResult<T> {
    crate::forks::check()?;
    let user = values::keywords(settings)?;
    let mut builder = scene.get().builder(py).clone();
    if let Some(light) = only {
        builder.lights = vec![light];
    }
    if builder.objects.is_empty() {
        // Lights alone are no picture, but a camera that measures needs no surface to see, and neither do points.
        let spec = Spec::new("points", "irradiance");
        builder.cameras.push(CameraSpec { spec, keyframes: Vec::new() });
    }
    let built = &scene.get().built;
    let (found, stopped) = follow(py, callback, |watch| {
        let (job, _) = build(&builder, built, &user, max_memory)?;
        if job.completed_scene().lights.len() > builder.lights.len() {
            let message =
                "the scene has no light of its own, so there is nothing to measure: add one of bilux.lights";
            return Err(bilux::Error::Settings(message.to_owned()));
        }
        work(&job, watch)
    });
    match stopped {
        Stopped::No | Stopped::Asked => {}
        Stopped::Raised(error) => return Err(error),
        Stopped::Interrupted => return Err(interrupted(py, None)?),
    }
    let failed = || crate::errors::Error::new_err("measuring failed inside Bilux: please report this");
    found.ok_or_else(failed)?.map_err(exception)?.ok_or_else(|| {
        crate::errors::Error::new_err("progress stopped the measurement before there was a result")
    })
}
