//! Pictures from all around a model.

use crate::ending::without_gil;
use crate::errors::exception;
use crate::picture::Picture;
use crate::render::render;
use crate::request::Request;
use crate::scene::Scene;
use bilux::scene::SceneBuilder;
use bilux::{JobRequest, Series};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Instant;

/// The pictures of a full turn, one after the other.
#[pyclass(frozen, module = "bilux._bilux")]
pub(crate) struct Turntable {
    scene: Py<Scene>,
    /// The scene as it was in the beginning: what others change from then on is not in these pictures.
    builder: SceneBuilder,
    request: Request,
    callback: Option<Py<PyAny>>,
    count: u32,
    next: AtomicU32,
}

#[pymethods]
impl Turntable {
    #[new]
    #[pyo3(signature = (scene, settings, aov, fast, max_memory, loaded_at, callback, count))]
    #[expect(clippy::too_many_arguments, reason = "each is a keyword of Scene.turntable")]
    fn new(
        py: Python<'_>,
        scene: Py<Scene>,
        settings: &Bound<'_, PyDict>,
        aov: Vec<String>,
        fast: bool,
        max_memory: u64,
        loaded_at: f32,
        callback: Option<Py<PyAny>>,
        count: u32,
    ) -> PyResult<Turntable> {
        crate::forks::check()?;
        let mut request = Request::new(settings, &aov, fast, max_memory, loaded_at)?;
        let builder = scene.get().builder(py).clone();
        let asked = JobRequest::from(&request.user).max_memory(request.max_memory);
        let series = without_gil(py, || Series::turntable(&builder, &asked, count));
        request.series = series.map_err(exception)?;
        request.origin = scene.get().origin(py).clone();
        Ok(Turntable { scene, builder, request, callback, count, next: AtomicU32::new(0) })
    }

    fn __iter__(slf: PyRef<'_, Self>) -> PyRef<'_, Self> {
        slf
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<Option<Picture>> {
        let index = self.next.load(Ordering::Relaxed);
        if index >= self.count {
            return Ok(None);
        }
        let series = self.request.series.turned(index, self.count);
        let request = Request { series, begun: Instant::now(), ..self.request.clone() };
        let callback = self.callback.as_ref().map(|callback| callback.bind(py));
        let picture = render(py, &self.builder, &self.scene.get().built, request, callback)?;
        // The picture of an interrupted call is the next one again.
        self.next.store(index + 1, Ordering::Relaxed);
        Ok(Some(picture))
    }
}
