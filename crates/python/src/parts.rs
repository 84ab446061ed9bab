//! Pictures whose parts are rendered in several processes: one that renders parts, and one that gathers them.

use crate::encoded::Bytes;
use crate::ending::without_gil;
use crate::errors::{Error, exception};
use crate::picture::Picture;
use crate::poses::with_other_poses;
use crate::render::{BuildWork, Prepared, check_outputs, interrupted, prepared, to_python, with_layers};
use crate::request::Request;
use crate::scene::Scene;
use crate::watch::{Stopped, follow};
use bilux::transport::aovs::Aov;
use bilux::transport::{Division, Film, Gathering as Parts, Part, Window};
use bilux::{Job, parts};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// First sample, the one after the last, and the window: x, y, width, height.
type PartNumbers = (u32, u32, u32, u32, u32, u32);

fn part_of((start, end, x, y, width, height): PartNumbers) -> Part {
    Part { samples: start..end, window: Window { x, y, width, height } }
}

/// A film as an array, the rays that it took, and whether it was stopped.
type RenderedPart<'py> = (Bound<'py, PyArray1<u8>>, u64, bool);

fn built(py: Python<'_>, scene: &Bound<'_, Scene>, request: &Request) -> PyResult<Prepared> {
    crate::forks::check()?;
    let own = scene.get();
    let scene = own.builder(py).clone();
    without_gil(py, || prepared(&scene, &own.built, request)).map_err(exception)
}

fn film_of(py: Python<'_>, film: &Bound<'_, PyAny>) -> PyResult<Film> {
    let bytes = Bytes::of(film)?;
    let bytes = bytes.get()?;
    without_gil(py, || Film::from_bytes(bytes)).map_err(exception)
}

/// Renders parts of one picture.
#[pyclass(frozen, module = "bilux._bilux")]
pub(crate) struct PartRenderer(Job);

#[pymethods]
impl PartRenderer {
    #[new]
    #[pyo3(signature = (scene, settings, fast, max_memory, loaded_at))]
    fn new(
        scene: &Bound<'_, Scene>,
        settings: &Bound<'_, PyDict>,
        fast: bool,
        max_memory: u64,
        loaded_at: f32,
    ) -> PyResult<PartRenderer> {
        let request = Request::new(settings, &[], fast, max_memory, loaded_at)?;
        Ok(PartRenderer(built(scene.py(), scene, &request)?.job))
    }

    /// Whether parts may be windows of the picture.
    fn may_crop(&self, py: Python<'_>) -> PyResult<bool> {
        without_gil(py, || parts::may_crop(&self.0)).map_err(exception)
    }

    /// The choice of an integrator that chooses.
    fn choice(&self, py: Python<'_>) -> PyResult<Option<String>> {
        without_gil(py, || self.0.plan().map(|plan| plan.map(|plan| plan.choice.to_string())))
            .map_err(exception)
    }

    /// Renders a part.
    fn render<'py>(&self, py: Python<'py>, part: PartNumbers) -> PyResult<RenderedPart<'py>> {
        let part = part_of(part);
        let (done, stopped) = follow(py, None, |watch| {
            let done = parts::render(&self.0, &part, watch)?;
            Ok::<_, bilux::Error>((done.film.to_bytes(), done.rays, done.cancelled))
        });
        if let Stopped::Raised(error) = stopped {
            return Err(error);
        }
        let (bytes, rays, cancelled) = done.ok_or_else(failed)?.map_err(exception)?;
        Ok((PyArray1::from_vec(py, bytes), rays, cancelled))
    }
}

fn failed() -> PyErr {
    Error::new_err("rendering failed inside Bilux: please report this, with the scene and the call")
}

/// Gathers the parts of one picture.
#[pyclass(frozen, module = "bilux._bilux")]
pub(crate) struct Gathering {
    aovs: Vec<Aov>,
    begun: Instant,
    build: BuildWork,
    state: Mutex<State>,
}

struct State {
    job: Job,
    parts: Option<Parts>,
}

#[pymethods]
impl Gathering {
    #[new]
    #[pyo3(signature = (scene, settings, aov, fast, max_memory, loaded_at))]
    fn new(
        scene: &Bound<'_, Scene>,
        settings: &Bound<'_, PyDict>,
        aov: Vec<String>,
        fast: bool,
        max_memory: u64,
        loaded_at: f32,
    ) -> PyResult<Gathering> {
        let request = Request::new(settings, &aov, fast, max_memory, loaded_at)?;
        let py = scene.py();
        let Prepared { job, build } = built(py, scene, &request)?;
        let (own, builder) = (scene.get(), scene.get().builder(py).clone());
        let request = Request { origin: own.origin(py).clone(), ..request };
        let checked = without_gil(py, || {
            check_outputs(&job, &request)?;
            // What denoises it is looked for now, so that it is missed before anything is rendered.
            job.denoiser()?;
            with_other_poses(job, &builder, &own.built, &request)
        });
        let job = checked.map_err(exception)?;
        let Request { aovs, begun, .. } = request;
        Ok(Gathering { aovs, begun, build, state: Mutex::new(State { job, parts: None }) })
    }

    /// Identifies scene and settings.
    #[getter]
    fn fingerprint(&self) -> String {
        self.lock().job.fingerprint().to_owned()
    }

    /// Begins to give out parts.
    fn begin(&self, workers: u32, threads: u32, may_crop: bool) -> PyResult<()> {
        let State { job, parts } = &mut *self.lock();
        *parts = Some(parts::gathering(job, Division { workers, threads, may_crop }).map_err(exception)?);
        Ok(())
    }

    /// The next part to render; None if there is nothing more to give out.
    fn next_part(&self) -> Option<PartNumbers> {
        let Part { samples, window } = self.lock().parts.as_mut()?.next_part()?;
        Some((samples.start, samples.end, window.x, window.y, window.width, window.height))
    }

    /// Adds a part, and the rays that it took.
    fn add(&self, py: Python<'_>, part: PartNumbers, film: &Bound<'_, PyAny>, rays: u64) -> PyResult<()> {
        let film = film_of(py, film)?;
        without_gil(py, || match &mut self.lock().parts {
            Some(parts) => parts.add(&part_of(part), film, rays),
            None => Ok(()),
        })
        .map_err(exception)
    }

    /// Whether there is nothing to wait for.
    #[getter]
    fn done(&self) -> bool {
        self.lock().parts.as_ref().is_none_or(Parts::is_done)
    }

    /// The probable number of samples of all pixels.
    #[getter]
    fn expected(&self) -> u64 {
        let State { job, parts } = &*self.lock();
        let settings = job.settings();
        let spp = parts.as_ref().map_or(0, Parts::expected);
        u64::from(spp) * u64::from(settings.width) * u64::from(settings.height)
    }

    /// The picture so far, without its layers; None if there is nothing yet.
    fn preview(&self, py: Python<'_>) -> PyResult<Option<Picture>> {
        let made = without_gil(py, || {
            let State { job, parts } = &*self.lock();
            let Some(parts) = parts else { return Ok(None) };
            let film = parts.so_far()?;
            if film.coverage().pieces().is_empty() {
                return Ok(None);
            }
            Ok::<_, bilux::Error>(Some((film.to_picture()?, job.display()?)))
        });
        let Some((picture, shown)) = made.map_err(exception)? else { return Ok(None) };
        let info = PyDict::new(py);
        info.set_item("complete", false)?;
        Picture::of(py, &picture, shown, Some(info.unbind())).map(Some)
    }

    /// The picture with its layers, of all parts so far.
    fn picture(&self, py: Python<'_>) -> PyResult<Picture> {
        let parts = self.lock().parts.take();
        let parts = parts.ok_or_else(|| Error::new_err("the picture was taken before"))?;
        let (rendered, stopped) = follow(py, None, |watch| {
            let job = &self.lock().job;
            let outcome = parts::gathered(job, parts, watch)?;
            with_layers(job, outcome, &self.aovs, self.build, watch)
        });
        let picture = to_python(py, &rendered.ok_or_else(failed)?.map_err(exception)?, self.begun)?;
        match stopped {
            Stopped::Raised(error) => Err(error),
            Stopped::Interrupted => Err(interrupted(py, Some(picture))?),
            _ => Ok(picture),
        }
    }
}

impl Gathering {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
