//! Renders a scene: what the command line does between reading a scene and writing a picture.

use crate::building::{build_of, check_moment};
use crate::errors::{Error, exception, warn};
use crate::picture::Picture;
use crate::poses::with_other_poses;
use crate::request::Request;
use crate::strategies::{check_strategies, push_strategies};
use crate::watch::{Stopped, Watch, follow};
use bilux::budget::{let_limits_decide, with_default_budget, with_fast_budget};
use bilux::pictures::denoise::preload;
use bilux::scene::{SceneBuilder, Span, Warning};
use bilux::transport::Progress;
use bilux::transport::aovs::{AOVS, Aov, AovEntry};
use bilux::wording::in_python;
use bilux::{Built, Display, ExtraLayers, Job, Outcome, Settings};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Mutex;
use std::time::Instant;

/// A picture that was rendered, before it becomes Python's.
pub(crate) struct Rendered {
    picture: bilux::pictures::Picture,
    shown: Display,
    outcome: Outcome,
    warnings: Vec<Warning>,
    spp: f64,
    asked: Option<u32>,
    seed: u64,
    time: f32,
    integrator: &'static str,
    denoiser: Option<String>,
    build: BuildWork,
}

/// Renders a picture. Runs without the GIL, except for `callback`.
///
/// # Errors
/// If anything is wrong with the scene or its settings; with what the callback raised; `Interrupted` after Ctrl-C.
pub(crate) fn render(
    py: Python<'_>,
    scene: &SceneBuilder,
    built: &Mutex<Built>,
    request: Request,
    callback: Option<&Bound<'_, PyAny>>,
) -> PyResult<Picture> {
    crate::forks::check()?;
    let begun = request.begun;
    let (rendered, stopped) = follow(py, callback, |watch| rendered(scene, built, request, watch));
    if let Stopped::Raised(error) = stopped {
        return Err(error);
    }
    let rendered = rendered.ok_or_else(|| {
        Error::new_err("rendering failed inside Bilux: please report this, with the scene and the call")
    })?;
    let picture = match rendered {
        Ok(Some(rendered)) => Some(to_python(py, &rendered, begun)?),
        Ok(None) => None,
        Err(error) => return Err(exception(error)),
    };
    match (stopped, picture) {
        (Stopped::No, Some(picture)) => Ok(picture),
        (Stopped::Asked, Some(picture)) => Ok(picture),
        (Stopped::Asked, None) => {
            Err(Error::new_err("progress stopped the render before there was a picture"))
        }
        (_, picture) => Err(interrupted(py, picture)?),
    }
}

/// The picture as Python's, with what is known of the render.
pub(crate) fn to_python(py: Python<'_>, rendered: &Rendered, begun: Instant) -> PyResult<Picture> {
    warn(py, &rendered.warnings)?;
    let info = info(py, rendered, begun)?.unbind();
    Picture::of(py, &rendered.picture, rendered.shown, Some(info))
}

/// The exception after Ctrl-C, with the picture so far.
pub(crate) fn interrupted(py: Python<'_>, picture: Option<Picture>) -> PyResult<PyErr> {
    let message = match picture {
        Some(_) => "the render was interrupted; the exception's attribute `picture` is the picture so far",
        None => "the render was interrupted before there was a picture",
    };
    let class = py.import("bilux._errors")?.getattr("Interrupted")?;
    Ok(PyErr::from_value(class.call1((message, picture))?))
}

/// Does the work; `None` if it was stopped before the first sample.
fn rendered(
    scene: &SceneBuilder,
    built: &Mutex<Built>,
    request: Request,
    watch: &Watch,
) -> Result<Option<Rendered>, bilux::Error> {
    let Prepared { job, build } = prepared(scene, built, &request)?;
    if watch.is_cancelled() {
        return Ok(None);
    }
    check_outputs(&job, &request)?;
    let job = with_other_poses(job, scene, built, &request)?;
    let outcome = job.render(watch)?;
    Ok(Some(with_layers(&job, outcome, &request.aovs, build, watch)?))
}

/// A job, and what it took to build it.
pub(crate) struct Prepared {
    pub(crate) job: Job,
    pub(crate) build: BuildWork,
}

/// The seconds and the trees that a job took to build.
#[derive(Clone, Copy)]
pub(crate) struct BuildWork {
    pub(crate) seconds: f64,
    pub(crate) trees: u64,
}

/// Builds the scene, with the limits that apply by default.
pub(crate) fn prepared(
    scene: &SceneBuilder,
    built: &Mutex<Built>,
    request: &Request,
) -> Result<Prepared, bilux::Error> {
    let mut user = request.user.clone();
    let_limits_decide(&mut user);
    if request.fast {
        with_fast_budget(&scene.settings, &mut user);
    }
    if request.crop.is_none() {
        with_default_budget(&scene.settings, &mut user);
    }
    let settings = Settings::of(scene, &user)?;
    let asked = request.of_job(&user, &settings)?;
    let building = Instant::now();
    let (job, trees) = build_of(scene, built, asked)?;
    let seconds = building.elapsed().as_secs_f64();
    check_moment(scene, job.settings().time, request.loaded_at)?;
    Ok(Prepared { job, build: BuildWork { seconds, trees } })
}

/// Checks that the job can make all that is asked for, and begins to load what denoises it.
pub(crate) fn check_outputs(job: &Job, request: &Request) -> Result<(), bilux::Error> {
    ExtraLayers::check(job, &request.aovs)?;
    if request.aovs.contains(&Aov::Strategies) {
        check_strategies(job)?;
    }
    let settings = job.settings();
    if settings.stop.is_any() && request.crop.is_none() && settings.denoise != "off" {
        preload(settings.threads);
    }
    Ok(())
}

/// The picture with its layers.
pub(crate) fn with_layers(
    job: &Job,
    outcome: Outcome,
    aovs: &[Aov],
    build: BuildWork,
    progress: &dyn Progress,
) -> Result<Rendered, bilux::Error> {
    let denoiser = job.denoiser()?.filter(|_| !outcome.rendered.cancelled);
    let mut picture = match denoiser {
        Some(chosen) => outcome.denoised(chosen)?,
        None => outcome.picture()?,
    };
    outcome.push_layers(&mut picture, aovs)?;
    if denoiser.is_some() {
        picture.push_rgb("noisy", &outcome.picture()?.to_rgb().unwrap_or_default())?;
    }
    if let Some(interval) = &outcome.rendered.interval {
        picture.push_rgb("interval", &interval.to_picture()?.to_rgb().unwrap_or_default())?;
    }
    let missing = push_made_later(job, &outcome, aovs, &mut picture, progress)?;
    job.describe(&mut picture, &outcome, denoiser.map(|chosen| chosen.name));
    let settings = job.settings();
    Ok(Rendered {
        picture,
        shown: job.display()?,
        warnings: job.warnings().iter().cloned().chain(missing).collect(),
        spp: outcome.samples_per_pixel(),
        asked: job.asked_samples(),
        seed: settings.seed,
        time: settings.time,
        integrator: settings.integrator.entry.name,
        denoiser: denoiser.map(|chosen| chosen.denoiser.describe()),
        build,
        outcome,
    })
}

/// Adds the layers that are made once the picture is there. If the render was stopped, a warning names those that are missing.
fn push_made_later(
    job: &Job,
    outcome: &Outcome,
    aovs: &[Aov],
    picture: &mut bilux::pictures::Picture,
    progress: &dyn Progress,
) -> Result<Option<Warning>, bilux::Error> {
    let mut missing: Vec<&AovEntry> = Vec::new();
    match ExtraLayers::of(job, outcome, aovs, progress)? {
        Some(extra) => extra.push(picture)?,
        None => missing.extend(AOVS.iter().filter(|row| aovs.contains(&row.aov) && row.aov.is_extra())),
    }
    if aovs.contains(&Aov::Strategies) {
        let found = if outcome.rendered.cancelled { None } else { job.strategies(outcome, progress)? };
        match &found {
            Some(found) => push_strategies(found, picture)?,
            None => missing.push(Aov::Strategies.row()),
        }
    }
    let names: Vec<&str> = missing.iter().map(|row| row.entry.name).collect();
    let message = format!("the render was stopped, so these layers are missing: {}", names.join(", "));
    Ok((!names.is_empty()).then(|| Warning { message, at: Span::default() }))
}

/// Contents of the picture's `info`.
fn info<'py>(py: Python<'py>, rendered: &Rendered, begun: Instant) -> PyResult<Bound<'py, PyDict>> {
    let info = PyDict::new(py);
    let outcome = &rendered.outcome;
    match rendered.outcome.rendered.cancelled {
        true => info.set_item("spp", rendered.spp)?,
        false => info.set_item("spp", rendered.spp as u64)?,
    }
    info.set_item("spp_asked", rendered.asked)?;
    info.set_item("noise", outcome.rendered.reached.and_then(|reached| reached.noise))?;
    info.set_item("seconds", begun.elapsed().as_secs_f64())?;
    info.set_item("build_seconds", rendered.build.seconds)?;
    info.set_item("trees_built", rendered.build.trees)?;
    info.set_item("complete", !outcome.rendered.cancelled)?;
    info.set_item("integrator", rendered.integrator)?;
    info.set_item("choice", outcome.rendered.choice.as_ref().map(ToString::to_string))?;
    info.set_item("denoiser", rendered.denoiser.as_deref())?;
    info.set_item("seed", rendered.seed)?;
    info.set_item("time", rendered.time)?;
    info.set_item("rays", outcome.rendered.counters.rays)?;
    let warnings: Vec<String> =
        rendered.warnings.iter().map(|warning| in_python(&warning.to_string())).collect();
    info.set_item("warnings", warnings)?;
    Ok(info)
}
