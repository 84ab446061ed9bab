//! Pictures in intervals of the length of paths.

use crate::building::build;
use crate::ending::without_gil;
use crate::errors::{Error, exception};
use crate::render::interrupted;
use crate::scene::Scene;
use crate::values;
use crate::watch::{Stopped, follow};
use bilux::math::Rgb;
use bilux::transport::LengthBins;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The light of each interval, (height, width, intervals, 3), and the rest, (height, width, 3); see `Scene.transient`. `None` if the callback
/// stopped it.
#[pyfunction]
pub(crate) fn transient<'py>(
    py: Python<'py>,
    scene: &Bound<'py, Scene>,
    settings: &Bound<'py, PyDict>,
    max_memory: u64,
    bins: (f64, f64, u32),
    callback: Option<&Bound<'py, PyAny>>,
) -> PyResult<Option<[Bound<'py, PyAny>; 2]>> {
    crate::forks::check()?;
    let (begin, width, count) = bins;
    let user = values::keywords(settings)?;
    let builder = scene.get().builder(py).clone();
    let built = &scene.get().built;
    let (job, _) = without_gil(py, || build(&builder, built, &user, max_memory)).map_err(exception)?;
    let bins = LengthBins { begin, width, count };
    let (found, stopped) = follow(py, callback, |watch| job.transient(bins, None, watch));
    match stopped {
        Stopped::No => {}
        Stopped::Asked => return Ok(None),
        Stopped::Raised(error) => return Err(error),
        Stopped::Interrupted => return Err(interrupted(py, None)?),
    }
    let failed = || Error::new_err("rendering failed inside Bilux: please report this");
    let Some(found) = found.ok_or_else(failed)?.map_err(exception)? else { return Ok(None) };
    let (rows, columns) = (found.window.height as usize, found.window.width as usize);
    let flat = |light: Vec<Rgb>| {
        let numbers: Vec<f32> = light.into_iter().flat_map(Rgb::to_array).collect();
        PyArray1::from_vec(py, numbers)
    };
    let light = flat(found.light).call_method1("reshape", ((rows, columns, count as usize, 3),))?;
    let rest = flat(found.rest).call_method1("reshape", ((rows, columns, 3),))?;
    Ok(Some([light, rest]))
}
