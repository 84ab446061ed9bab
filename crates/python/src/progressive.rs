//! Ever better pictures of one scene.

use crate::building::build;
use crate::ending::without_gil;
use crate::errors::{Error, exception, warn};
use crate::picture::Picture;
use crate::render::interrupted;
use crate::watch::{Stopped, follow};
use bilux::scene::{Parameters, SceneBuilder};
use bilux::{Budget, Built, Display, Outcome};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Mutex;

/// Pictures of the same scene with 1, 2, 4, … samples per pixel: each has all samples of those before it.
#[pyclass(frozen, module = "bilux._bilux")]
pub(crate) struct Progressive {
    picture: Mutex<bilux::Progressive>,
    shown: Display,
    callback: Option<Py<PyAny>>,
}

impl Progressive {
    pub(crate) fn new(
        py: Python<'_>,
        scene: &SceneBuilder,
        built: &Mutex<Built>,
        user: &Parameters,
        max_memory: u64,
        callback: Option<Py<PyAny>>,
    ) -> PyResult<Progressive> {
        crate::forks::check()?;
        let (job, _) = without_gil(py, || build(scene, built, user, max_memory)).map_err(exception)?;
        warn(py, job.warnings())?;
        let shown = job.display().map_err(exception)?;
        Ok(Progressive { picture: Mutex::new(bilux::Progressive::new(job)), shown, callback })
    }

    fn picture(&self, py: Python<'_>, outcome: &Outcome, spp: u32) -> PyResult<Picture> {
        let info = PyDict::new(py);
        info.set_item("spp", spp)?;
        let picture = outcome.picture().map_err(exception)?;
        Picture::of(py, &picture, self.shown, Some(info.unbind()))
    }
}

#[pymethods]
impl Progressive {
    fn __iter__(slf: PyRef<'_, Self>) -> PyRef<'_, Self> {
        slf
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<Option<Picture>> {
        crate::forks::check()?;
        let busy = |_| Error::new_err("another thread is rendering the next picture of this sequence");
        let mut guard = self.picture.try_lock().map_err(busy)?;
        let so_far = &mut *guard;
        let done = so_far.samples();
        if so_far.is_done() {
            return Ok(None);
        }
        // As many again.
        let budget = Budget::Samples(done.max(1));
        let callback = self.callback.as_ref().map(|callback| callback.bind(py));
        let (stepped, stopped) = follow(py, callback, |watch| so_far.step(budget, watch));
        match stopped {
            Stopped::No => {}
            Stopped::Asked => return Ok(None),
            Stopped::Raised(error) => return Err(error),
            Stopped::Interrupted => {
                let last = so_far.outcome().map(|outcome| self.picture(py, outcome, done));
                return Err(interrupted(py, last.transpose()?)?);
            }
        }
        let failed = || Error::new_err("rendering failed inside Bilux: please report this");
        let samples = stepped.ok_or_else(failed)?.map_err(exception)?;
        so_far.outcome().map(|outcome| self.picture(py, outcome, samples)).transpose()
    }
}
