//! Ever better pictures of one scene.

use crate::errors::{Error, exception, warn};
use crate::picture::Picture;
use crate::render::{interrupted, shown};
use crate::shown::Shown;
use crate::watch::{Stopped, follow};
use bilux::scene::{Parameters, SceneBuilder};
use bilux::{Job, Outcome};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Mutex;

/// Pictures of the same scene with 1, 2, 4, … samples per pixel: each has all samples of those before it.
#[pyclass(frozen, module = "bilux._bilux")]
pub(crate) struct Progressive {
    state: Mutex<State>,
    shown: Shown,
    callback: Option<Py<PyAny>>,
}

struct State {
    job: Job,
    /// How many samples per pixel there will be.
    all: u32,
    /// All samples so far.
    so_far: Option<Outcome>,
    done: u32,
}

impl Progressive {
    pub(crate) fn new(
        py: Python<'_>,
        scene: &SceneBuilder,
        user: &Parameters,
        max_memory: u64,
        callback: Option<Py<PyAny>>,
    ) -> PyResult<Progressive> {
        crate::forks::check()?;
        let job = py.detach(|| Job::within(scene, user, max_memory)).map_err(exception)?;
        warn(py, job.warnings())?;
        let shown = shown(&job).map_err(exception)?;
        let all = job.samples_per_pixel();
        Ok(Progressive { state: Mutex::new(State { job, all, so_far: None, done: 0 }), shown, callback })
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
        let mut state = self.state.try_lock().map_err(busy)?;
        let State { job, all, so_far, done } = &mut *state;
        if done == all {
            return Ok(None);
        }
        let end = (2 * *done).clamp(1, *all);
        job.samples(*done..end);
        let (rendered, stopped) =
            follow(py, self.callback.as_ref().map(|callback| callback.bind(py)), |watch| job.render(watch));
        match stopped {
            Stopped::No => {}
            Stopped::Asked => return Ok(None),
            Stopped::Raised(error) => return Err(error),
            Stopped::Interrupted => {
                let last = so_far.as_ref().map(|outcome| self.picture(py, outcome, *done));
                return Err(interrupted(py, last.transpose()?)?);
            }
        }
        let more =
            rendered.ok_or_else(|| Error::new_err("rendering failed inside Bilux: please report this"))?;
        let mut more = more.map_err(exception)?;
        if let Some(before) = so_far.take() {
            let samples = std::mem::replace(&mut more.film, before.film);
            more.film.merge(&samples).map_err(exception)?;
        }
        *done = end;
        let picture = self.picture(py, &more, end)?;
        *so_far = Some(more);
        Ok(Some(picture))
    }
}
