//! Requests of calls, in the terms of the library.

use crate::errors::of_scene;
use crate::loading::Origin;
use crate::memory;
use crate::values;
use bilux::scene::{Parameters, SceneBuilder, SceneError, Span};
use bilux::transport::Window;
use bilux::transport::aovs::{AOVS, Aov};
use bilux::{Denoised, JobRequest, Series, Settings};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::time::Instant;

/// Request of a call.
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
    /// Parts that the picture has in common with others.
    pub(crate) series: Series,
    /// Origin of the scene, for the layers of motion of meshes that move by themselves.
    pub(crate) origin: Option<Origin>,
    /// The scene in the next frame and in the previous one, if they were given.
    pub(crate) others: [Option<SceneBuilder>; 2],
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
        let (crop, origin, others) = (None, None, [None, None]);
        Ok(Request { user, aovs, crop, fast, max_memory, loaded_at, begun, series, origin, others })
    }

    /// Request for the job, with the limits that apply.
    pub(crate) fn of_job(&self, user: &Parameters, settings: &Settings) -> Result<JobRequest, bilux::Error> {
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

/// The AOVs of these names.
///
/// # Errors
/// If there is no such AOV.
fn aovs(names: &[String]) -> Result<Vec<Aov>, SceneError> {
    let find = |name: &String| {
        let found = AOVS.iter().find(|row| row.entry.name == name || row.layer == Some(name));
        found.map(|row| row.aov).ok_or_else(|| {
            SceneError::unknown("layer", name, AOVS.iter().map(|row| row.entry.name), &Span::default())
        })
    };
    names.iter().map(find).collect()
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
