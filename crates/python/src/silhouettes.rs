//! `Scene.amodal`: what a camera would see of objects if nothing hid them.

use crate::building::build;
use crate::ending::without_gil;
use crate::errors::{Error, exception};
use crate::render::interrupted;
use crate::scene::Scene;
use crate::values;
use crate::watch::{Stopped, follow};
use bilux::transport::labels::Mask;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Runs of pixels, the number of pixels, and column, row, width and height of the box around them.
type MaskParts<'py> = (Bound<'py, PyArray1<u32>>, u64, Option<[i64; 4]>);

/// The masks of each group of objects: all of it, and what is visible; and the size of the picture. Nothing if it was stopped.
#[pyfunction]
pub(crate) fn silhouettes<'py>(
    py: Python<'py>,
    scene: &Bound<'_, Scene>,
    groups: Vec<Vec<usize>>,
    margin: u32,
    settings: &Bound<'_, PyDict>,
    max_memory: u64,
) -> PyResult<(Vec<[MaskParts<'py>; 2]>, [u32; 2])> {
    crate::forks::check()?;
    let user = values::keywords(settings)?;
    let builder = scene.get().builder(py).clone();
    let built = &scene.get().built;
    let made = without_gil(py, || build(&builder, built, &user, max_memory));
    let (job, _) = made.map_err(exception)?;
    let (found, stopped) = follow(py, None, |watch| job.silhouettes(&groups, margin, watch));
    match stopped {
        Stopped::No | Stopped::Asked => {}
        Stopped::Raised(error) => return Err(error),
        Stopped::Interrupted => return Err(interrupted(py, None)?),
    }
    let failed = || Error::new_err("this failed inside Bilux: please report it, with the scene and the call");
    let found = found.ok_or_else(failed)?.map_err(exception)?.unwrap_or_default();
    let parts = |mask: Mask| (PyArray1::from_vec(py, mask.runs), mask.pixels, mask.bounds);
    let masks = found.into_iter().map(|one| [one.whole, one.visible].map(parts)).collect();
    Ok((masks, [job.settings().width, job.settings().height]))
}
