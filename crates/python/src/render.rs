//! Renders a scene: what the command line does between reading a scene and writing a picture.

use crate::errors::{Error, exception, of_scene, warn};
use crate::loading::Origin;
use crate::memory;
use crate::picture::Picture;
use crate::strategies::{check_strategies, push_strategies};
use crate::values;
use crate::watch::{Stopped, Watch, follow};
use bilux::budget::{let_limits_decide, with_default_budget, with_fast_budget};
use bilux::pictures::denoise::preload;
use bilux::scene::{Object, Parameters, SceneBuilder, SceneError, Span, Warning};
use bilux::transport::aovs::{AOVS, Aov, AovEntry};
use bilux::transport::{Progress, Window};
use bilux::wording::in_python;
use bilux::{Built, Denoised, Display, ExtraLayers, Job, JobRequest, Outcome, Series, Settings};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// What a call asks for.
#[derive(Clone)]
pub(crate) struct Request {
    /// Settings that take precedence over those of the scene.
    pub(crate) user: Parameters,
    /// The layers.
    pub(crate) aovs: Vec<Aov>,
    /// The window, if not all of the picture.
    pub(crate) crop: Option<[u32; 4]>,
    /// Whether to render the cleanest picture that about a second allows.
    pub(crate) fast: bool,
    /// The maximum number of bytes of memory.
    pub(crate) max_memory: u64,
    /// The time in seconds for which the scene's file was read.
    pub(crate) loaded_at: f32,
    /// When the call began.
    pub(crate) begun: Instant,
    /// What the picture has in common with others.
    pub(crate) series: Series,
    /// Where the scene came from, for the layer of motion of meshes that move by themselves.
    pub(crate) origin: Option<Origin>,
}

impl Request {
    /// A picture with settings, layers of these names and, in the end, `fast`, `max_memory` and `loaded_at`.
    ///
    /// # Errors
    /// If a setting or a layer makes no sense.
    pub(crate) fn new(
        settings: &Bound<'_, PyDict>,
        layers: &[String],
        fast: bool,
        max_memory: u64,
        loaded_at: f32,
    ) -> PyResult<Request> {
        let (begun, series) = (Instant::now(), Series::default());
        let user = values::keywords(settings)?;
        let aovs = aovs(layers).map_err(of_scene)?;
        let max_memory = memory::within_limits(max_memory);
        Ok(Request { user, aovs, crop: None, fast, max_memory, loaded_at, begun, series, origin: None })
    }

    /// What is asked of the job, with the limits that apply.
    fn of_job(&self, user: &Parameters, settings: &Settings) -> Result<JobRequest, bilux::Error> {
        let asked = JobRequest::from(user)
            .in_series(self.series.clone())
            .max_memory(self.max_memory)
            .begun_at(self.begun)
            .layers(&self.aovs);
        Ok(match self.crop {
            Some(crop) => asked.crop(window(settings, crop)?).denoised(Denoised::IfAsked),
            None => asked.denoised(Denoised::ForDisplay),
        })
    }
}

/// A picture that was rendered, before it becomes Python's.
pub(crate) struct Rendered {
    picture: bilux::pictures::Picture,
    shown: Display,
    outcome: Outcome,
    warnings: Vec<Warning>,
    spp: f64,
    asked: Option<u32>,
    seed: u64,
    integrator: &'static str,
    denoiser: Option<String>,
    build: BuildWork,
}

/// The AOVs of these names.
///
/// # Errors
/// If there is no such AOV.
fn aovs(names: &[String]) -> Result<Vec<Aov>, SceneError> {
    let find = |name: &String| {
        let found = AOVS.iter().find(|row| row.entry.name == name || row.aov.layer() == Some(name));
        found.map(|row| row.aov).ok_or_else(|| {
            SceneError::unknown("layer", name, AOVS.iter().map(|row| row.entry.name), &Span::default())
        })
    };
    names.iter().map(find).collect()
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
    let job = with_next_pose(job, scene, built, &request)?;
    let outcome = job.render(watch)?;
    Ok(Some(with_layers(&job, outcome, &request.aovs, build, watch)?))
}

/// The job with the next pose of meshes that move by themselves, if the layer of motion is wanted.
pub(crate) fn with_next_pose(
    job: Job,
    scene: &SceneBuilder,
    built: &Mutex<Built>,
    request: &Request,
) -> Result<Job, bilux::Error> {
    if !scene.inventory.moves() || !request.aovs.contains(&Aov::Motion) {
        return Ok(job);
    }
    let (time, series) = (job.settings().time + 1.0 / job.settings().fps, request.series.clone());
    let later = request.origin.as_ref().map(|origin| origin.read_at(time)).transpose()?;
    let same_shape = |(now, later): (&Object, &Object)| now.mesh.triangles == later.mesh.triangles;
    let later = later.filter(|later| {
        later.objects.len() == scene.objects.len() && scene.objects.iter().zip(&later.objects).all(same_shape)
    });
    let Some(later) = later else {
        return Err(bilux::Error::Settings(
            "aov: the motion of meshes that move by themselves takes the file again, at the next frame: render the \
             scene as bilux.load returned it, without other objects, and not from a pickle"
                .to_owned(),
        ));
    };
    let mut next = scene.clone();
    for (object, later) in next.objects.iter_mut().zip(later.objects) {
        object.mesh = later.mesh;
    }
    let request = JobRequest::from(&request.user).max_memory(request.max_memory);
    let (next, _) = build_of(&next, built, request.in_series(series))?;
    Ok(job.moving_to(&next))
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
    let time = job.settings().time;
    if scene.inventory.moves() && time != request.loaded_at {
        return Err(bilux::Error::Settings(format!(
            "time: the meshes of this file move, and it was read for {} s: read it again with bilux.load(…, \
             time={time})",
            request.loaded_at
        )));
    }
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
            None => missing.extend(AOVS.iter().filter(|row| row.aov == Aov::Strategies)),
        }
    }
    let names: Vec<&str> = missing.iter().map(|row| row.entry.name).collect();
    let message = format!("the render was stopped, so these layers are missing: {}", names.join(", "));
    Ok((!names.is_empty()).then(|| Warning { message, at: Span::default() }))
}

/// The job, with what earlier renders of the scene have built, and the number of trees that were missing.
pub(crate) fn build(
    scene: &SceneBuilder,
    built: &Mutex<Built>,
    user: &Parameters,
    max_memory: u64,
) -> Result<(Job, u64), bilux::Error> {
    build_of(scene, built, JobRequest::from(user).max_memory(memory::within_limits(max_memory)))
}

/// As [`build`], with more that is asked for.
fn build_of(
    scene: &SceneBuilder,
    built: &Mutex<Built>,
    asked: JobRequest,
) -> Result<(Job, u64), bilux::Error> {
    let mut built = built.lock().unwrap_or_else(PoisonError::into_inner);
    let before = built.tree_work().trees;
    let job = Job::with_built(scene, asked, &mut built)?;
    Ok((job, built.tree_work().trees - before))
}

/// The window of the picture that `crop` asks for.
fn window(settings: &Settings, [x, y, width, height]: [u32; 4]) -> Result<Window, bilux::Error> {
    let fits =
        |at: u32, side: u32, most: u32| side > 0 && at.checked_add(side).is_some_and(|end| end <= most);
    if fits(x, width, settings.width) && fits(y, height, settings.height) {
        return Ok(Window { x, y, width, height });
    }
    Err(bilux::Error::Settings(format!(
        "crop: the window {x}, {y}, {width}, {height} (x, y, width, height) must contain pixels and lie within the \
         picture, which is {}x{}",
        settings.width, settings.height
    )))
}

/// What the picture's `info` says.
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
    info.set_item("rays", outcome.rendered.counters.rays)?;
    let warnings: Vec<String> =
        rendered.warnings.iter().map(|warning| in_python(&warning.to_string())).collect();
    info.set_item("warnings", warnings)?;
    Ok(info)
}
