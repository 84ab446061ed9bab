//! Insight into a picture: one sample, event by event, and what each strategy finds.

use crate::building::build;
use crate::ending::without_gil;
use crate::errors::exception;
use crate::picture::Picture;
use crate::render::interrupted;
use crate::scene::Scene;
use crate::strategies::check_strategies;
use crate::values;
use crate::watch::{Stopped, follow};
use bilux::strategies::Light;
use bilux::transport::Strategies;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A sample: as text; the depth and the description of each event; the radiance; origin, direction and time of the camera ray;
/// the pixels to which its light path contributes; and the rays that were traced.
type Replayed = (String, Vec<(u32, String)>, [f32; 3], [f32; 3], [f32; 3], f32, usize, u64);

/// Takes one sample of a picture again.
#[pyfunction]
pub(crate) fn replay(
    py: Python<'_>,
    scene: &Bound<'_, Scene>,
    place: [u32; 3],
    settings: &Bound<'_, PyDict>,
    max_memory: u64,
) -> PyResult<Replayed> {
    crate::forks::check()?;
    let user = values::keywords(settings)?;
    let builder = scene.get().builder(py).clone();
    let (built, [x, y, sample]) = (&scene.get().built, place);
    let replay = without_gil(py, || build(&builder, built, &user, max_memory)?.0.replay(x, y, sample));
    let replay = replay.map_err(exception)?;
    let events = replay.events.iter().map(|event| (event.depth, event.what.clone())).collect();
    let (ray, radiance) = (replay.ray, replay.radiance.to_array());
    let text = replay.to_string();
    Ok((text, events, radiance, ray.origin, ray.direction, ray.time, replay.splats, replay.rays))
}

/// A strategy: its name, the vertices that it takes from the light and from the camera, whether it merges them, and what
/// it finds with its weight and without.
type StrategyPictures = (String, u32, u32, bool, Picture, Picture);

/// Renders a picture for each of the integrator's strategies; `None` if the callback stopped it.
#[pyfunction]
pub(crate) fn strategies(
    py: Python<'_>,
    scene: &Bound<'_, Scene>,
    settings: &Bound<'_, PyDict>,
    max_memory: u64,
    callback: Option<&Bound<'_, PyAny>>,
) -> PyResult<Option<Vec<StrategyPictures>>> {
    crate::forks::check()?;
    let user = values::keywords(settings)?;
    let builder = scene.get().builder(py).clone();
    let built = &scene.get().built;
    let made = without_gil(py, || {
        let (job, _) = build(&builder, built, &user, max_memory)?;
        check_strategies(&job).map(|()| job)
    });
    let job = made.map_err(exception)?;
    let shown = job.display().map_err(exception)?;
    let (found, stopped) = follow(py, callback, |watch| job.strategies_of(None, watch));
    match stopped {
        Stopped::No => {}
        Stopped::Asked => return Ok(None),
        Stopped::Raised(error) => return Err(error),
        Stopped::Interrupted => return Err(interrupted(py, None)?),
    }
    let failed = || crate::errors::Error::new_err("rendering failed inside Bilux: please report this");
    let Some(found) = found.ok_or_else(failed)?.map_err(exception)? else { return Ok(None) };
    let picture = |found: &Strategies, index: usize, light: Light| {
        let linear = bilux::strategies::picture(found, &found.pictures[index], light).map_err(exception)?;
        Picture::of(py, &linear, shown, None)
    };
    let one = |index: usize| {
        let strategy = found.pictures[index].strategy;
        let [weighted, unweighted] = Light::BOTH.map(|light| picture(&found, index, light));
        Ok((strategy.to_string(), strategy.s, strategy.t(), strategy.merges, weighted?, unweighted?))
    };
    (0..found.pictures.len()).map(one).collect::<PyResult<_>>().map(Some)
}
